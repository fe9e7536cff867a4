// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/oracle/body_truth.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/seams/limbs.h"
#include "core/volume_io/volume_io.h"

namespace limber::oracle {

namespace {

using Json = nlohmann::json;

Json read_truth(const Path& folder) {
  const Path path = folder / "truth.json";
  const Json truth = Json::parse(read_file(path), nullptr, false);
  if (truth.is_object()) return truth;
  throw Error("this is no truth of a body", path.string(), "give a body of make_hard.py");
}

// A volume with one number for each voxel of a body, read from a file.
class Numbers {
 public:
  Numbers(const Path& path, const LabelVolume& volume) : file_(read_volume(path)) {
    if (file_.volume.grid.size != volume.grid.size)
      throw Error("the truth is of another grid than the volume", path.string(), "make the body anew");
    for (const Tissue& tissue : file_.tissues.tissues) value_[tissue.label] = static_cast<int>(tissue.file_value);
  }
  int at(const glm::ivec3& v) const {
    const Label label = file_.volume.at(v);
    return label == 0 ? 0 : value_.at(label);
  }

 private:
  VolumeFile file_;
  std::map<Label, int> value_;
};

// Returns the rig bone for each number of a true bone.
std::map<int, int> rig_bones(const Path& folder, const Armature& armature) {
  std::map<int, int> bone_of;
  const Json truth = read_truth(folder);
  for (const auto& [number, bone] : truth.at("bones_in_truth_nrrd").items()) {
    const std::string wanted = bone.at("rig").at(0);
    const auto found =
        std::find_if(armature.bones.begin(), armature.bones.end(), [&](const Bone& b) { return b.name == wanted; });
    if (found == armature.bones.end())
      throw Error("the rig lacks a bone that the truth names", wanted, "give the rig that lies beside the volume");
    bone_of[std::stoi(number)] = static_cast<int>(found - armature.bones.begin());
  }
  return bone_of;
}

// Calls body(voxel) for every voxel of tissue.
template <class Body>
void for_each_voxel(const LabelVolume& volume, const Body& body) {
  const glm::ivec3 size = volume.grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (volume.at({x, y, z}) != 0) body(glm::ivec3(x, y, z));
}

// Finds the part of the body that each voxel belongs to. The file gives some voxels of a bone to an adjacent part,
// which would connect two parts, so all voxels of a bone are given to the part that its rig bone belongs to.
class PartsOfBody {
 public:
  PartsOfBody(const Path& folder, const Json& truth, const LabelVolume& volume)
      : bone_(folder / "truth.nrrd", volume),
        part_(folder / "parts.nrrd", volume) {
    std::map<int, std::map<int, std::int64_t>> voxels;  // number of voxels, by true bone and part
    for_each_voxel(volume, [&](const glm::ivec3& v) { ++voxels[bone_.at(v)][part_.at(v)]; });
    for (const auto& [number, bone] : truth.at("bones_in_truth_nrrd").items()) {
      const int part = part_of(truth, bone.at("rig").at(0), voxels[std::stoi(number)]);
      if (part != 0) part_of_bone_[std::stoi(number)] = part;
    }
  }
  int at(const glm::ivec3& v) const {
    const auto bone = part_of_bone_.find(bone_.at(v));
    return bone == part_of_bone_.end() ? part_.at(v) : bone->second;
  }

 private:
  // Returns the part with most voxels of the true bone among the parts that may follow the rig bone; 0 if there is
  // none.
  static int part_of(const Json& truth, const std::string& rig_bone, std::map<int, std::int64_t>& voxels) {
    int best = 0;
    for (const auto& [number, part] : truth.at("parts_in_parts_nrrd").items()) {
      const Json& bones = part.at("rig");
      if (std::find(bones.begin(), bones.end(), rig_bone) == bones.end()) continue;
      const int candidate = std::stoi(number);
      if (best == 0 || voxels[candidate] > voxels[best]) best = candidate;
    }
    return best;
  }

  Numbers bone_, part_;
  std::map<int, int> part_of_bone_;
};

// Finds the parts of the body that are limbs of the rig, and tells where these limbs are free: not grown together with
// the rest of the body.
class FreeLimbs {
 public:
  FreeLimbs(const Json& truth, const Armature* armature) : armature_(armature) {
    if (!armature) return;
    for (const Limb& limb : limbs_of(*armature))
      for (const auto& [number, part] : truth.at("parts_in_parts_nrrd").items())
        if (is_within(limb, part.at("rig").get<std::set<std::string>>())) limb_of_part_[std::stoi(number)] = limb;
  }
  // Returns true if a part of the body is a limb that is free at a point (world, mm).
  bool has(int part, const glm::dvec3& point) const {
    const auto limb = limb_of_part_.find(part);
    return limb != limb_of_part_.end() && is_free(limb->second, *armature_, point);
  }

 private:
  bool is_within(const Limb& limb, const std::set<std::string>& bones) const {
    for (std::size_t b = 0; b < limb.has_bone.size(); ++b)
      if (limb.has_bone[b] && !bones.contains(armature_->bones[b].name)) return false;
    return true;
  }

  const Armature* armature_;
  std::map<int, Limb> limb_of_part_;
};

}  // namespace

BoneParts true_bones(const Path& folder, const LabelVolume& volume, const TissueVoxels& tissue,
                     const TissueTable& tissues, const Armature& armature) {
  const std::map<int, int> bone_of = rig_bones(folder, armature);
  const Numbers truth(folder / "truth.nrrd", volume);
  std::vector<std::uint8_t> is_bone_label(65536, 0);
  for (const Tissue& t : tissues.tissues) is_bone_label[t.label] = is_bone(t.kind);

  std::vector<int> bone(tissue.size(), -1);
  std::vector<BoneParts::Part> by_bone(armature.bones.size(), {0, 0, glm::dvec3(0)});
  const AffineTransform world = world_from_voxel(volume.grid);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (!is_bone_label[volume.at(v)]) return;
    const auto found = bone_of.find(truth.at(v));
    if (found == bone_of.end()) {
      const std::string where = std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
      throw Error("a voxel of bone has no true bone", where, "give the tissue table that lies beside the volume");
    }
    bone[place] = found->second;
    BoneParts::Part& part = by_bone[found->second];
    ++part.voxel_count;
    part.centre += world * glm::dvec3(v);
  });

  BoneParts parts;
  std::vector<std::uint16_t> number(armature.bones.size(), 0);
  for (std::size_t b = 0; b < by_bone.size(); ++b) {
    if (by_bone[b].voxel_count == 0) continue;
    const auto count = by_bone[b].voxel_count;
    parts.parts.push_back({static_cast<int>(b), count, by_bone[b].centre / static_cast<double>(count)});
    number[b] = static_cast<std::uint16_t>(parts.parts.size());
  }
  parts.part_of.assign(tissue.size(), 0);
  for (std::int64_t i = 0; i < tissue.size(); ++i)
    if (bone[i] >= 0) parts.part_of[i] = number[bone[i]];
  return parts;
}

Seams true_seams(const Path& folder, const LabelVolume& volume, const Armature* free_limbs) {
  Seams seams(volume.grid.size);
  std::set<std::pair<int, int>> glued;
  const Json truth = read_truth(folder);
  for (const Json& pair : truth.at("glue_in_glue_nrrd")) {
    const int one = pair.at("parts").at(0), other = pair.at("parts").at(1);
    glued.insert({std::min(one, other), std::max(one, other)});
  }
  if (glued.empty()) return seams;
  const Numbers glue(folder / "glue.nrrd", volume);
  const PartsOfBody parts(folder, truth, volume);
  const FreeLimbs free(truth, free_limbs);
  const AffineTransform world = world_from_voxel(volume.grid);
  for_each_voxel(volume, [&](const glm::ivec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 w = v;
      ++w[axis];
      if (volume.at_or_air(w) == 0) continue;
      const int one = parts.at(v), other = parts.at(w);
      if (!glued.contains({std::min(one, other), std::max(one, other)})) continue;
      const glm::dvec3 centre = world * (0.5 * (glm::dvec3(v) + glm::dvec3(w)));
      if ((glue.at(v) != 0 && glue.at(w) != 0) || free.has(one, centre) || free.has(other, centre)) seams.cut(v, axis);
    }
  });
  return seams;
}

}  // namespace limber::oracle
