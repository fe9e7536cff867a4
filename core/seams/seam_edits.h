// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits seams by hand. The user moves a knife along a stroke, and the blade of the knife sweeps a thin sheet. Voxel
// faces between soft voxels on the two sides of the sheet are cut. A ball-shaped eraser joins all cut faces inside the
// ball.
#pragma once

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

// Returns the tissue labels that seams may separate by hand: all labels except bone.
LabelSet soft_labels(const TissueTable& tissues);

// A position of the knife during a stroke. Its blade is the line segment from `from` to `to`, world, mm.
struct Blade {
  glm::dvec3 from{0}, to{0};
};

// Cuts the faces between soft voxels whose centres lie on opposite sides of the sheet that the blade sweeps from
// `first` to `second`. Returns the number of faces that were not cut before.
std::int64_t cut_between(Seams& seams, const LabelVolume& volume, const LabelSet& soft, const Blade& first,
                         const Blade& second);

// Joins all cut faces whose middle lies within a ball. Returns the number of these faces.
//   centre, radius  world, mm
std::int64_t join_within(Seams& seams, const Grid& grid, const glm::dvec3& centre, double radius);

}  // namespace limber
