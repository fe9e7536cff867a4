// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from a CT by thresholds, so that a CT without a segmentation can be rigged and posed. It tells
// skin, fat, soft tissue, lung, gas and bone apart, and leaves out the table, blankets and other thin things around the
// body. It knows no anatomy: contrast agent and metal count as bone, and bones that touch are one.
#pragma once

#include "core/base/progress.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/grey_levels.h"
#include "core/volume/label_volume.h"

namespace limber {

// Thresholds in Hounsfield units. The values given here are chosen by Limber: air is -1000 and water 0 by definition,
// and fat lies below water, muscle a little above it and bone far above it. A scan may need others.
struct CtThresholds {
  double body = -300;  // from here on, voxels belong to a body
  double fat = -190;   // from here to `soft`: fat
  double soft = -30;   // from here on: soft tissue
  double bone = 200;   // from here on: bone
  double skin_mm = 2;  // thickness of the skin, at least one voxel
};

struct CtLabels {
  LabelVolume volume;
  TissueTable tissues;  // one tissue for each label that the volume has
};

// Returns the labels of a CT on its own grid. Throws Error if the thresholds do not rise, if no value is below that of
// the body, or if nothing in the image is a body: no connected region of at least 10 ml above the threshold of the body
// that is thicker than 6 mm.
CtLabels labels_of_ct(const GreyLevels& image, const CtThresholds& thresholds = {}, Progress& progress = no_progress());

}  // namespace limber
