// SPDX-License-Identifier: AGPL-3.0-or-later
// What a posed volume is judged by: the volume at rest, the posed one and the displacement between them, the rig and
// where its bones were asked to go. None of it is the program's own idea of the body: neither weights nor bone parts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct JudgedPose {
  const LabelVolume& rest;
  const LabelVolume& posed;                   // with the labels of `rest`
  const TissueTable& tissues;                 // of both
  std::span<const glm::vec3> displacement{};  // #posed voxels, posed - rest, mm; empty where nobody knows it
  const Armature* armature = nullptr;         // nullptr where there is no rig
  std::vector<RigidTransform> asked;          // #bones, posed from rest, as the pose was asked for
  std::vector<RigidTransform> applied;  // #bones, where joints were fitted or a solve ended early; else as `asked`

  // World, mm: where the posed voxel lies, and where its tissue lay at rest. The latter needs `displacement`.
  glm::dvec3 posed_place(const glm::ivec3& voxel) const { return world_from_voxel(posed.grid) * glm::dvec3(voxel); }
  glm::dvec3 rest_place(const glm::ivec3& voxel) const {
    return posed_place(voxel) - glm::dvec3(displacement[posed.grid.index(voxel)]);
  }
  bool knows_field() const { return !displacement.empty(); }
};

// Where something is worst.
struct WorstPlace {
  std::int64_t voxels = 0;  // of the largest connected piece of it
  glm::dvec3 place{0};      // a voxel in the middle of that piece, world, mm
  std::string near;         // the posed rig bone that lies nearest; empty without a rig
};

// Of the bones as the pose has them. Empty without a rig.
std::string nearest_posed_bone(const JudgedPose& pose, const glm::dvec3& place);

}  // namespace limber
