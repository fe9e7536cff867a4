// SPDX-License-Identifier: AGPL-3.0-or-later
// A body whose arm hangs beside the trunk and is grown together with it, without skin between them, as in a coarse scan
// of a body with its arms at its sides. It is known for each voxel whether it belongs to the arm.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/seams/find_seams.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber::test {

struct GluedArm {
  static constexpr Label kSkin = 1, kFlesh = 2, kSpine = 3, kHumerus = 4, kUlna = 5, kArmFlesh = 6;
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  std::vector<bool> is_arm;  // for each voxel of the grid: true if it belongs to the arm

  // Makes the body in voxels of 4 mm.
  //   gap    smallest distance of air between arm and trunk, mm; negative: they are grown together
  //   names  true: the arm's flesh has a label and a name of its own
  explicit GluedArm(double gap, bool names = false) {
    const glm::ivec3 size(64, 36, 112);
    volume.grid.size = size;
    volume.grid.spacing = glm::dvec3(4);
    volume.grid.origin = glm::dvec3(-80, -70, -20);
    volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
    is_arm.assign(volume.grid.voxel_count(), false);
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x) put(v, gap, names);
    cover_with_skin();
    tissues.tissues = {tissue(kSkin, "skin", TissueKind::Skin),
                       tissue(kFlesh, names ? "Muscle, trunk" : "muscle", TissueKind::Muscle),
                       tissue(kSpine, "thoracic vertebrae", TissueKind::Bone),
                       tissue(kHumerus, "left humerus", TissueKind::Bone),
                       tissue(kUlna, "left ulna", TissueKind::Bone),
                       tissue(kArmFlesh, "Muscle, arms", TissueKind::Muscle)};
    const double x = arm_axis(gap);
    rig.bones = {{"Spine", -1, {0, 0, 0}, {0, 0, 380}},
                 {"LeftUpperArm", 0, {x, 0, 380}, {x, 0, 200}},
                 {"LeftForearm", 1, {x, 0, 200}, {x, 0, 40}}};
  }

  static double arm_axis(double gap) { return kTrunk + gap + kArm; }
  static constexpr double kTrunk = 60, kArm = 28;  // half widths of trunk and arm, mm
  static constexpr double kShoulder = 340;  // height of the shoulder, mm; above it, arm and trunk are truly connected

  // Calls `body` with a voxel and an axis for each pair of tissue voxels, the voxel and the next along the axis, of
  // which only one belongs to the arm.
  template <class Body>
  void for_each_glued_face(const Body& body) const {
    const glm::ivec3 size = volume.grid.size;
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x)
          for (int axis = 0; axis < 3; ++axis) {
            glm::ivec3 w = v;
            if (++w[axis] >= size[axis] || !volume.at(v) || !volume.at(w)) continue;
            if (is_arm[volume.grid.index(v)] != is_arm[volume.grid.index(w)]) body(v, axis);
          }
  }

  Seams seams() const {
    const TissueVoxels tissue(volume);
    return find_seams(volume, tissue, tissues, rig, split_bones(volume, tissue, tissues, rig));
  }

 private:
  static Tissue tissue(Label label, const char* name, TissueKind kind) {
    Tissue t;
    t.label = label;
    t.file_value = label;
    t.name = name;
    t.kind = kind;
    t.priority = is_bone(kind) ? 2 : kind == TissueKind::Skin ? 0 : 1;
    return t;
  }

  void put(const glm::ivec3& v, double gap, bool names) {
    const glm::dvec3 p = world_from_voxel(volume.grid) * glm::dvec3(v);
    const double x = arm_axis(gap);
    const bool at_shoulder = p.z > kShoulder && p.z < 400 && p.x > 0 && p.x < x && std::abs(p.y) < 24;
    const double trunk = std::hypot(p.x / kTrunk, p.y / 44), arm = std::hypot(p.x - x, p.y) / kArm;
    const bool in_trunk = p.z > 0 && p.z < 400 && trunk <= 1, in_arm = p.z > 20 && p.z < 400 && arm <= 1;
    if (!in_trunk && !in_arm && !at_shoulder) return;
    const bool of_arm = in_arm && (!in_trunk || arm < trunk);
    const std::int64_t at = volume.grid.index(v);
    is_arm[at] = of_arm;
    Label label = of_arm && names ? kArmFlesh : kFlesh;
    if (std::hypot(p.x, p.y) < 14 && p.z > 10 && p.z < 390) label = kSpine;
    if (std::hypot(p.x - x, p.y) < 10 && p.z > 204 && p.z < 388) label = kHumerus;
    if (std::hypot(p.x - x, p.y) < 9 && p.z > 40 && p.z < 196) label = kUlna;
    volume.voxels[at] = label;
  }

  void cover_with_skin() {
    const LabelVolume bare = volume;
    const glm::ivec3 size = volume.grid.size;
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x)
          for (int k = 0; k < 6 && bare.at(v); ++k) {
            glm::ivec3 w = v;
            w[k / 2] += k % 2 ? 1 : -1;
            if (bare.at_or_air(w) == 0) volume.at(v) = kSkin;
          }
  }
};

}  // namespace limber::test
