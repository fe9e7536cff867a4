// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from a CT by thresholds, so that a CT without a segmentation can be rigged and posed. It tells
// skin, fat, soft tissue, lung, gas and bone apart, and leaves out the table, blankets and other thin things around the
// body. It knows no anatomy: contrast agent and metal count as bone, and bones that touch are one.
// The values of an MR have no unit. Of such an image only the body and its skin are labelled, by one threshold.
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

// Returns the threshold between background and body that the histogram of an image gives, by the minimum cross entropy
// of both classes [Li and Lee 1993, iterated as by Li and Tam 1998]. Background is far more uniform than tissue in an
// MR; a threshold half way between the means of both (Otsu 1979) would take dark muscle for background.
double body_threshold(const GreyLevels& image);

// Returns the labels of an image whose values have no unit, on its own grid: the body and its skin. Whatever is dark
// and enclosed by the body, such as cortical bone in an MR, counts as body. It is enough that it is enclosed in one
// slice across the body's longest axis, as lungs are where the windpipe is open: so the air in a ring that arms and
// trunk close in a slice is filled too. Throws Error if no value is below the threshold, or if nothing in the image is
// a body (as labels_of_ct).
CtLabels labels_of_body(const GreyLevels& image, double threshold, double skin_mm = 2,
                        Progress& progress = no_progress());

}  // namespace limber
