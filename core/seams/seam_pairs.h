// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists for the user the parts of the body between which seams lie, such as "left hand" and "left thigh", 1204 faces.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_parts.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct SeamPair {
  std::string first, second;  // parts of the body, or names of bones that are not recognized
  std::int64_t faces = 0;
  glm::dvec3 middle{0};  // middle of the face nearest to the faces' mean position, world, mm
};

// Returns for each bone its part of the body, as in "left hand", or its own name when that is not recognized.
std::vector<std::string> body_parts_of(const Armature& armature);

// Returns the pairs of body parts that seams separate, those with most faces first. Each of a face's two voxels belongs
// to the bone nearest to it through tissue, on a path that crosses no seam.
//   parts  bone parts of the same volume and armature
std::vector<SeamPair> seam_pairs(const Seams& seams, const LabelVolume& volume, const TissueVoxels& tissue,
                                 const Armature& armature, const BoneParts& parts, Progress& progress = no_progress());

}  // namespace limber
