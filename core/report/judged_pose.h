// SPDX-License-Identifier: AGPL-3.0-or-later
// The inputs from which a posed volume is judged: the volume at rest, the posed volume, the displacement between them,
// the rig, and the motions of the rig's bones in the pose. They contain neither weights nor the bones into which this
// program splits bone tissue, so that errors in these are found and not repeated.
#pragma once

#include <string>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/report/displacement_view.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct JudgedPose {
  const LabelVolume& rest;
  const LabelVolume& posed;            // has the same labels as `rest`
  const TissueTable& tissues;          // the tissues of both volumes
  DisplacementView displacement{};     // displacement of each posed voxel; empty: unknown
  const Armature* armature = nullptr;  // the rig; nullptr: none
  std::vector<RigidTransform> asked;   // #bones: motions from rest to the pose that the user requested
  // #bones: motions that were used. They differ from `asked` if the rig's joints were fitted or a solve ended early.
  std::vector<RigidTransform> applied;

  // posed_place() returns the position of a posed voxel, rest_place() the position of its tissue at rest; world, mm.
  // rest_place() needs `displacement`.
  glm::dvec3 posed_place(const glm::ivec3& voxel) const { return world_from_voxel(posed.grid) * glm::dvec3(voxel); }
  glm::dvec3 rest_place(const glm::ivec3& voxel) const {
    return posed_place(voxel) - glm::dvec3(displacement.at(posed.grid, voxel));
  }
  bool knows_field() const { return !displacement.empty(); }
};

// The position at which a fault of the posed volume is worst.
struct WorstPlace {
  std::int64_t voxels = 0;  // number of voxels of the fault's largest connected component
  glm::dvec3 place{0};      // position of a voxel in the middle of the component, world, mm
  std::string near;         // name of the nearest posed rig bone; empty without a rig
};

// Returns the name of the rig bone that is nearest to a position in the posed body. Empty without a rig.
std::string nearest_posed_bone(const JudgedPose& pose, const glm::dvec3& place);

}  // namespace limber
