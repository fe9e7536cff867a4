// SPDX-License-Identifier: AGPL-3.0-or-later
// Prepares a volume: reorients, mirrors, merges labels, changes the spacing, removes specks, crops, pads and computes
// statistics. Only regrid(), which changes the spacing, resamples; all other functions keep voxels as they are.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// Returns the volume at another spacing (mm). The new grid has the axes and the lowest corner of the old grid and
// covers all of it. A voxel's box is the space that it fills. There are two steps, and neither depends on what a label
// means.
//   vote   Each new voxel gets the label with the largest share of its box, by exact overlap with the old voxels. If
//          labels have equal shares, the one with the larger share in the box extended by an old voxel on every side
//          wins, then the smaller label.
//   close  A layer thinner than a new voxel would lose every vote, and the tissues that it separates would touch. This
//          step restores such layers. If the labels of two new voxels that share a face touch nowhere in the old volume
//          within the boxes of these voxels, the tissue between them replaces one of the two: the voxel in which it
//          has the larger share. Between tissue and air, the tissue voxel is replaced, or the air voxel if more than
//          half of its box is tissue, so that the body keeps its volume. Between tissue and air this also applies to
//          voxels that share only an edge or a corner, so that a skin of 1 mm is a closed skin at 4 mm.
// Throws Error for a spacing that is not positive or gives too many voxels.
LabelVolume regrid(const LabelVolume& volume, const glm::dvec3& spacing, Progress& progress = no_progress());

// Returns the volume at another spacing (mm) so that every label keeps its volume, as far as whole voxels can. A new
// voxel gets the label with the largest weighted share of its box, air included. The weight of each label is found in
// rounds: it grows while the label has too few voxels. A label whose volume is half a new voxel or more gets at least
// one. A layer thinner than half the spacing gets holes, since a closed layer would have too much volume. Throws Error
// for a spacing that is not positive or gives too many voxels.
LabelVolume balanced_regrid(const LabelVolume& volume, double spacing, Progress& progress = no_progress());

// Mirrors the volume along a world axis (0, 1, 2 = x, y, z) about the middle of its grid. The grid stays the same. On
// an oblique grid, the voxel axis nearest to the world axis is used.
LabelVolume flip(const LabelVolume& volume, int axis);

// Permutes and flips the voxel axes so that they point as nearly as possible in the directions of `code`. A code has
// three letters, one each of L or R, P or A, S or I ("LPS", "RAS" ...). Voxels keep their labels and their positions in
// the world. Throws Error for a code that does not name three axes.
LabelVolume reorient(const LabelVolume& volume, const std::string& code);

// Crops to the bounding box of the tissue. Throws Error when there is no tissue.
LabelVolume crop_to_tissue(const LabelVolume& volume);
// Crops to the box from voxel `low` to voxel `high`, both included. Throws Error if the box contains no voxel of the
// volume.
LabelVolume crop(const LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high);
// Returns the volume with `voxels` more voxels of air on every side. Throws Error if it would have too many voxels.
LabelVolume pad(const LabelVolume& volume, int voxels);
LabelVolume merge_labels(const LabelVolume& volume, Label from, Label into);

// Removes specks: connected components of one label (26-connected) with fewer than `voxels` voxels. The voxels of a
// speck get the most frequent label, air included, of the neighbouring voxels that are not in specks. A speck that is
// surrounded only by specks becomes air.
LabelVolume drop_specks(const LabelVolume& volume, std::int64_t voxels);

struct LabelStatistics {
  Label label;
  std::int64_t voxels = 0;
  double volume_mm3 = 0;
  glm::dvec3 centre{0};              // mean position of the label's voxels, world, mm
  glm::ivec3 lowest{0}, highest{0};  // bounding box, voxel indices, both included
  int components = 0;                // number of connected components (26-connected)
  std::int64_t surface_voxels = 0;   // number of voxels that share a face with another label or the grid's outside
};
// Returns the statistics of every tissue label in the volume, sorted by label.
std::vector<LabelStatistics> label_statistics(const LabelVolume& volume);
// Returns the statistics as comma-separated values: a title line, then one line per label with its file value, name,
// number of voxels, volume in mm3, mass in g, centre, bounding box, components and surface voxels.
std::string to_csv(const std::vector<LabelStatistics>& statistics, const TissueTable& tissues);

}  // namespace limber
