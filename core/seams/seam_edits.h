// SPDX-License-Identifier: AGPL-3.0-or-later
// Seams changed by hand. A knife that goes along a stroke cuts the faces that it passes between soft voxels, so that a
// stroke makes a thin sheet and not a heap of single voxels; a ball joins all faces within it.
#pragma once

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

// A byte per label, not 0 for tissue that a seam may part: all but bone.
LabelSet soft_labels(const TissueTable& tissues);

// Where the knife is at one end of a step of the stroke: its blade goes from `from` to `to`; world, mm.
struct Blade {
  glm::dvec3 from{0}, to{0};
};

// Cuts the faces between soft voxels whose centres lie on both sides of the sheet between two blades.
//   returns  the faces that were not cut before
std::int64_t cut_between(Seams& seams, const LabelVolume& volume, const LabelSet& soft, const Blade& first,
                         const Blade& second);

// Joins the faces whose middle lies within a ball.
//   centre, radius  world, mm     returns  the faces that were cut before
std::int64_t join_within(Seams& seams, const Grid& grid, const glm::dvec3& centre, double radius);

}  // namespace limber
