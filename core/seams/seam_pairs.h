// SPDX-License-Identifier: AGPL-3.0-or-later
// Between which parts of the body seams lie, for a user to read: "left hand" and "left thigh", 1204 faces.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_parts.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct SeamPair {
  std::string first, second;  // parts of the body where the rig's names mean some, else names of bones
  std::int64_t faces = 0;
  glm::dvec3 middle{0};  // world, mm: the face nearest to their mean
};

// A bone's part of the body, "left hand"; its own name where that means nothing known.
std::vector<std::string> body_parts_of(const Armature& armature);

// By most faces. Each side of a face belongs to the bone nearest to it through tissue, which the way does not leave
// across a seam.
//   parts  of the same volume and armature
std::vector<SeamPair> seam_pairs(const Seams& seams, const LabelVolume& volume, const TissueVoxels& tissue,
                                 const Armature& armature, const BoneParts& parts, Progress& progress = no_progress());

}  // namespace limber
