// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from a CT by thresholds, so that a CT without a segmentation can be rigged and posed.
// Distinguishes skin, fat, soft tissue, lung, gas and bone, and removes the table, blankets and other thin things
// around the body. It uses no knowledge of anatomy: contrast agent and metal count as bone, and bones that touch are
// not separated. The values of an MR have no unit; in such an image only the body and its skin are labelled, by one
// threshold.
#pragma once

#include "core/base/progress.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/grey_levels.h"
#include "core/volume/label_volume.h"

namespace limber {

// Thresholds in Hounsfield units. The default values are Limber's choice: air is -1000 and water 0 by definition, and
// fat is below water, muscle a little above it and bone far above it. Some scans need other values.
struct CtThresholds {
  double body = -300;  // from this value on, voxels belong to a body
  double fat = -190;   // from this value up to `soft`: fat
  double soft = -30;   // from this value on: soft tissue
  double bone = 200;   // from this value on: bone
  double skin_mm = 2;  // thickness of the skin, at least one voxel
};

struct CtLabels {
  LabelVolume volume;
  TissueTable tissues;  // one tissue for each label that the volume has
};

// Returns the labels of a CT on its own grid. Throws Error if the thresholds do not ascend, if no value is below the
// body's threshold, or if there is no body: no connected region of at least 10 ml above this threshold that is thicker
// than 6 mm.
CtLabels labels_of_ct(const GreyLevels& image, const CtThresholds& thresholds = {}, Progress& progress = no_progress());

// Returns the threshold between background and body, from the histogram of an image, by minimum cross entropy of the
// two classes [Li and Lee 1993, iterated as by Li and Tam 1998]. In an MR the background is far more uniform than
// tissue, so Otsu's threshold (1979), half way between the means of the two classes, would count dark muscle as
// background.
double body_threshold(const GreyLevels& image);

// Returns the labels of an image whose values have no unit, on its own grid: the body and its skin. Dark regions that
// the body encloses, such as cortical bone in an MR, count as body. It suffices that a region is enclosed within one
// slice across the body's longest axis, as lungs are when the windpipe is open. Therefore air that arms and trunk
// enclose in a slice is filled too. Throws Error if no value is below the threshold, or if there is no body (as
// labels_of_ct).
CtLabels labels_of_body(const GreyLevels& image, double threshold, double skin_mm = 2,
                        Progress& progress = no_progress());

}  // namespace limber
