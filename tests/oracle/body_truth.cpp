// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/oracle/body_truth.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/volume/volume_io.h"

namespace limber::oracle {

namespace {

using Json = nlohmann::json;

Json read_truth(const Path& folder) {
  const Path path = folder / "truth.json";
  const Json truth = Json::parse(read_file(path), nullptr, false);
  if (truth.is_object()) return truth;
  throw Error("this is no truth of a body", path.string(), "give a body of make_hard.py");
}

// Numbers on the voxels of a body.
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

// By the number of a true bone, its rig bone.
std::map<int, int> rig_bones(const Path& folder, const Armature& armature) {
  std::map<int, int> bone_of;
  const Json truth = read_truth(folder);
  for (const auto& [number, bone] : truth.at("bones_in_truth_nrrd").items()) {
    const std::string wanted = bone.at("rig").at(0);
    const auto found = std::find_if(armature.bones.begin(), armature.bones.end(),
                                    [&](const Bone& b) { return b.name == wanted; });
    if (found == armature.bones.end())
      throw Error("the rig lacks a bone that the truth names", wanted, "give the rig that lies beside the volume");
    bone_of[std::stoi(number)] = static_cast<int>(found - armature.bones.begin());
  }
  return bone_of;
}

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

Seams true_seams(const Path& folder, const LabelVolume& volume) {
  Seams seams(volume.grid.size);
  std::set<std::pair<int, int>> glued;
  const Json truth = read_truth(folder);
  for (const Json& pair : truth.at("glue_in_glue_nrrd")) {
    const int one = pair.at("parts").at(0), other = pair.at("parts").at(1);
    glued.insert({std::min(one, other), std::max(one, other)});
  }
  if (glued.empty()) return seams;
  const Numbers part(folder / "parts.nrrd", volume), glue(folder / "glue.nrrd", volume);
  const auto cut_faces_of = [&](const glm::ivec3& v) {
    if (volume.at(v) == 0 || glue.at(v) == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 w = v;
      ++w[axis];
      if (volume.at_or_air(w) == 0 || glue.at(w) == 0) continue;
      const int one = part.at(v), other = part.at(w);
      if (glued.contains({std::min(one, other), std::max(one, other)})) seams.cut(v, axis);
    }
  };
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x) cut_faces_of({x, y, z});
  return seams;
}

}  // namespace limber::oracle
