// SPDX-License-Identifier: AGPL-3.0-or-later
// Making a volume ready: orientation, mirroring, merging labels, re-gridding, dropping specks, cropping, padding,
// statistics. Nothing here is resampled except by regrid().
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// The volume at another spacing (mm). The new grid has the old one's axes and lowest corner and covers all of it.
//   share    Each voxel takes the label with the largest share of its box, by exact overlap with the old voxels' boxes.
//            Of equal shares the one that is larger in the box grown by an old voxel on every side wins, then the
//            smaller label.
//   closing  A layer thinner than a voxel wins no vote, and tissues that it parted would meet. So where two labels meet
//            by a face in the new volume, but nowhere in the two voxels' boxes in the old one, the tissue that lies
//            between them there takes the voxel of the two in which it has more; against air it takes the tissue's
//            voxel, unless more than half of the air's box is tissue, so that the body keeps its volume. Against
//            air this holds for edges and corners as well (which may meet where edges and corners met before): a skin
//            of 1 mm is a closed skin at 4 mm. No knowledge of what a label means is needed.
// Throws Error for a spacing that is not positive or makes more voxels than fit.
LabelVolume regrid(const LabelVolume& volume, const glm::dvec3& spacing, Progress& progress = no_progress());

// The body mirrored across the middle of the grid along a world axis (0, 1, 2 = x, y, z); the grid stays. On an oblique
// grid, along the voxel axis that is nearest to that world axis.
LabelVolume flip(const LabelVolume& volume, int axis);

// Voxel axes turned to the nearest axes of `code`, three letters of L or R, P or A, S or I ("LPS", "RAS" ...), exactly:
// no voxel is resampled, none moves in the world. Throws Error for a code that names no three axes.
LabelVolume reorient(const LabelVolume& volume, const std::string& code);

// Throws Error when there is no tissue.
LabelVolume crop_to_tissue(const LabelVolume& volume);
// The voxels from `low` to `high`, both included. Throws Error when there are none of the volume's among them.
LabelVolume crop(const LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high);
// Air on every side. Throws Error when more voxels result than fit.
LabelVolume pad(const LabelVolume& volume, int voxels);
LabelVolume merge_labels(const LabelVolume& volume, Label from, Label into);

// Connected pieces (26) of one tissue with fewer than `voxels` voxels take the label, air included, that most of the
// voxels around them have, other specks not counted; a speck among specks only becomes air.
LabelVolume drop_specks(const LabelVolume& volume, std::int64_t voxels);

struct LabelStatistics {
  Label label;
  std::int64_t voxels = 0;
  double volume_mm3 = 0;
  glm::dvec3 centre{0};              // world, mm
  glm::ivec3 lowest{0}, highest{0};  // bounding box, voxels
  int components = 0;                // 26-connected
  std::int64_t surface_voxels = 0;   // with a 6-neighbour of another label; outside the grid is air
};
// Of every tissue label present, by label.
std::vector<LabelStatistics> label_statistics(const LabelVolume& volume);
// A header line, then one line a label: file value, name, voxels, mm3, mass in g, centre, bounding box, components,
// surface.
std::string to_csv(const std::vector<LabelStatistics>& statistics, const TissueTable& tissues);

}  // namespace limber
