// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/core/autorig/fit_bodies.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/bones/anatomical_name.h"

namespace limber::test {

namespace {

double ramp(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Returns the shift that takes a position of the standing body to its position in a body of the given build, mm.
glm::dvec3 shift_of(const glm::dvec3& p, const Build& build, const StandingLandmarks& at) {
  const double wide = std::min(ramp(at.hip - 320, at.hip - 30, p.z), 1 - ramp(at.hip + 120, at.hip + 330, p.z));
  const double arm = p.z < at.shoulder ? ramp(at.arm_from, at.arm_to, std::abs(p.x)) : 0;
  glm::dvec3 shift(0);
  shift.x = build.wider_pelvis * wide * std::clamp(p.x, -at.widest, at.widest);
  shift.z = build.shorter_limbs * glm::mix(std::max(0.0, at.hip - p.z), std::max(0.0, at.shoulder - p.z), arm);
  return shift + build.larger_head * ramp(at.neck - 40, at.neck + 60, p.z) * (p - at.head);
}

// Returns the position of the standing body that shift_of() takes to `after`, by repeated substitution.
//   guess  position from which the search begins
glm::dvec3 place_before(const glm::dvec3& after, const glm::dvec3& guess, const Build& build,
                        const StandingLandmarks& at) {
  // The search ends when the position changes by less than this, mm.
  constexpr double kNear = 1e-3;
  glm::dvec3 p = guess;
  for (int k = 0; k < 25; ++k) {
    const glm::dvec3 next = after - shift_of(p, build, at);
    const bool is_near = glm::distance(p, next) < kNear;
    p = next;
    if (is_near) break;
  }
  return p;
}

std::string other_side(const std::string& name) {
  std::string result;
  for (size_t i = 0; i < name.size();) {
    const auto is = [&](const char* word) { return name.compare(i, std::string(word).size(), word) == 0; };
    if (is("Left")) result += "Right", i += 4;
    else if (is("Right")) result += "Left", i += 5;
    else if (is("left")) result += "right", i += 4;
    else if (is("right")) result += "left", i += 5;
    else result += name[i++];
  }
  return result;
}

FitBody relabelled(const FitBody& body, const std::map<std::string, TissueKind>& kinds,
                   const std::vector<std::string>& name_of) {
  FitBody result = body;
  result.tissues = {};
  std::map<std::string, Label> labels;
  for (const auto& [name, kind] : kinds) {
    const Label label = static_cast<Label>(labels.size() + 1);
    labels[name] = label;
    Tissue tissue{.label = label, .file_value = double(label), .name = name, .kind = kind};
    apply_kind_defaults(tissue);
    result.tissues.tissues.push_back(tissue);
  }
  std::vector<Label> to(65536, 0);
  for (size_t label = 1; label < to.size(); ++label)
    if (label < name_of.size() && !name_of[label].empty()) to[label] = labels.at(name_of[label]);
  for (Label& voxel : result.volume.voxels) voxel = to[voxel];
  return result;
}

}  // namespace

FitBody rebuilt(const FitBody& body, const Build& build, const StandingLandmarks& at) {
  FitBody result = body;
  const Grid& from = body.volume.grid;
  constexpr double kRoom = 70;  // free room around the body on all sides, mm
  const glm::dvec3 room = glm::ceil(kRoom / from.spacing);
  Grid grid = from;
  grid.size += 2 * glm::ivec3(room);
  grid.origin = world_from_voxel(from) * -room;
  result.volume = {grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  const AffineTransform to_world = world_from_voxel(grid), to_voxel = voxel_from_world(from);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y) {
      glm::dvec3 moved_by(0);  // the shift of the previous voxel, mm, with which the search at the next voxel begins
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::dvec3 after = to_world * glm::dvec3(x, y, z);
        const glm::dvec3 before = place_before(after, after - moved_by, build, at);
        moved_by = after - before;
        result.volume.at({x, y, z}) = body.volume.at_or_air(glm::ivec3(glm::floor(to_voxel * before + 0.5)));
      }
    }
  for (Bone& bone : result.truth.bones)
    bone.head += shift_of(bone.head, build, at), bone.tail += shift_of(bone.tail, build, at);
  return build.size == 1 ? result : moved(result, glm::dmat3(1), build.size, glm::dvec3(0));
}

FitBody mirrored(const FitBody& body) {
  FitBody result = body;
  const glm::dvec3 across(-1, 1, 1);
  Grid& grid = result.volume.grid;
  const glm::ivec3 size = grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) result.volume.at({x, y, z}) = body.volume.at({size.x - 1 - x, y, z});
  // Mirroring moves the origin to the voxel that was last along x. The grids here lie along the world axes.
  grid.origin = world_from_voxel(grid) * glm::dvec3(size.x - 1, 0, 0) * across;
  for (Tissue& tissue : result.tissues.tissues) tissue.name = other_side(tissue.name);
  for (Bone& bone : result.truth.bones) bone.head *= across, bone.tail *= across, bone.name = other_side(bone.name);
  return result;
}

FitBody moved(const FitBody& body, const glm::dmat3& turn, double scale, const glm::dvec3& shift) {
  FitBody result = body;
  Grid& grid = result.volume.grid;
  grid.direction = turn * grid.direction;
  grid.spacing *= scale;
  grid.origin = scale * (turn * grid.origin) + shift;
  for (Bone& bone : result.truth.bones)
    bone.head = scale * (turn * bone.head) + shift, bone.tail = scale * (turn * bone.tail) + shift;
  return result;
}

FitBody cropped(const FitBody& body, const std::function<bool(const glm::dvec3&)>& keep) {
  FitBody result = body;
  const Grid& from = body.volume.grid;
  const AffineTransform to_world = world_from_voxel(from);
  glm::ivec3 low = from.size, high(-1);
  for (int z = 0; z < from.size.z; ++z)
    for (int y = 0; y < from.size.y; ++y)
      for (int x = 0; x < from.size.x; ++x) {
        Label& voxel = result.volume.at({x, y, z});
        if (voxel && !keep(to_world * glm::dvec3(x, y, z))) voxel = 0;
        if (voxel) low = glm::min(low, glm::ivec3(x, y, z)), high = glm::max(high, glm::ivec3(x, y, z));
      }
  Grid grid = from;
  grid.size = high - low + 1;
  grid.origin = to_world * glm::dvec3(low);
  LabelVolume small{grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) small.at({x, y, z}) = result.volume.at(low + glm::ivec3(x, y, z));
  result.volume = std::move(small);
  return result;
}

FitBody sampled(const FitBody& body, const glm::ivec3& every) {
  FitBody result = body;
  Grid grid = body.volume.grid;
  grid.size /= every;
  grid.spacing *= glm::dvec3(every);
  result.volume = {grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) result.volume.at({x, y, z}) = body.volume.at(glm::ivec3(x, y, z) * every);
  return result;
}

FitBody without_labels(const FitBody& body) {
  FitBody result = body;
  for (Label& voxel : result.volume.voxels) voxel = voxel != 0;
  result.tissues = {};
  return result;
}

FitBody with_one_bone_label(const FitBody& body) {
  std::vector<std::string> name_of(65536);
  for (const Tissue& tissue : body.tissues.tissues) name_of[tissue.label] = is_bone(tissue.kind) ? "bone" : "flesh";
  return relabelled(body, {{"bone", TissueKind::Bone}, {"flesh", TissueKind::Muscle}}, name_of);
}

FitBody with_regional_labels(const FitBody& body) {
  static const std::map<BoneRegion, std::string> kNames = {
      {BoneRegion::Head, "Cranium, cortical"},
      {BoneRegion::Neck, "Cervical spine, cortical"},
      {BoneRegion::Thorax, "Thoracic spine, cortical"},
      {BoneRegion::Lumbar, "Lumbar spine, cortical"},
      {BoneRegion::Spine, "Thoracic spine, cortical"},
      {BoneRegion::Pelvis, "Pelvis, cortical"},
      {BoneRegion::Shoulder, "Scapulae, cortical"},
      {BoneRegion::UpperArm, "Humeri, cortical"},
      {BoneRegion::Forearm, "Ulnae and radii, cortical"},
      {BoneRegion::Hand, "Wrists and hand bones, cortical"},
      {BoneRegion::Finger, "Wrists and hand bones, cortical"},
      {BoneRegion::Thigh, "Femora, cortical"},
      {BoneRegion::Shank, "Tibiae, fibulae and patellae, cortical"},
      {BoneRegion::Foot, "Ankles and foot bones, cortical"},
      {BoneRegion::Toes, "Ankles and foot bones, cortical"}};
  std::vector<std::string> name_of(65536);
  std::map<std::string, TissueKind> kinds{{"Residual tissue", TissueKind::Muscle}};
  for (const Tissue& tissue : body.tissues.tissues) {
    const AnatomicalName name = anatomical_name(tissue.name);
    const bool named = is_bone(tissue.kind) && !name.regions.empty();
    name_of[tissue.label] = named ? kNames.at(*name.regions.begin()) : "Residual tissue";
    if (named) kinds[name_of[tissue.label]] = TissueKind::CorticalBone;
  }
  return relabelled(body, kinds, name_of);
}

FitBody animal(const std::string& name, const Armature& rig, const std::vector<double>& radii, double voxel) {
  // Radius of a bone as a share of the flesh's radius, and the gap at each of its ends as a share of its length.
  constexpr double kBoneRadius = 0.28, kGap = 0.05;
  constexpr Label kFlesh = 1, kBone = 2;
  glm::dvec3 low(1e9), high(-1e9);
  for (size_t b = 0; b < radii.size(); ++b)
    for (const glm::dvec3& p : {rig.bones[b].head, rig.bones[b].tail})
      low = glm::min(low, p - radii[b]), high = glm::max(high, p + radii[b]);
  FitBody body{.name = name, .volume = {}, .tissues = {}, .truth = rig};
  Grid& grid = body.volume.grid;
  grid.spacing = glm::dvec3(voxel);
  grid.size = glm::ivec3(glm::ceil((high - low) / voxel)) + 5;
  grid.origin = low - 2 * voxel;
  body.volume.voxels.assign(grid.voxel_count(), 0);
  for (size_t b = 0; b < radii.size(); ++b) {
    const Bone& bone = rig.bones[b];
    Bone inner = bone;
    inner.head = glm::mix(bone.head, bone.tail, kGap), inner.tail = glm::mix(bone.tail, bone.head, kGap);
    const double inner_radius = std::max(kBoneRadius * radii[b], 0.7 * voxel), reach = std::max(radii[b], inner_radius);
    const glm::ivec3 from((glm::min(bone.head, bone.tail) - reach - grid.origin) / voxel),
        to = glm::min(grid.size - 1, glm::ivec3((glm::max(bone.head, bone.tail) + reach - grid.origin) / voxel) + 1);
    for (int z = std::max(0, from.z); z <= to.z; ++z)
      for (int y = std::max(0, from.y); y <= to.y; ++y)
        for (int x = std::max(0, from.x); x <= to.x; ++x) {
          const glm::dvec3 p = grid.origin + voxel * glm::dvec3(x, y, z);
          Label& here = body.volume.at({x, y, z});
          if (here == kBone) continue;
          if (distance_to_bone(bone, p) < radii[b]) here = kFlesh;
          if (distance_to_bone(inner, p) < inner_radius) here = kBone;
        }
  }
  for (const auto& [label, kind, text] :
       {std::tuple(kFlesh, TissueKind::Muscle, "flesh"), std::tuple(kBone, TissueKind::Bone, "bone")}) {
    Tissue tissue{.label = label, .file_value = double(label), .name = text, .kind = kind};
    apply_kind_defaults(tissue);
    body.tissues.tissues.push_back(tissue);
  }
  return body;
}

}  // namespace limber::test
