// SPDX-License-Identifier: AGPL-3.0-or-later
// Detects grey images (CT, MR) where a label volume is expected, and makes pictures of grey images.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_io.h"

namespace limber {

// Returns the reason for which a label volume looks like a grey image, such as "it has 300 values, and 99 % of
// neighbouring voxels differ". Returns nothing when it looks like labels. A volume whose labels mostly have names is
// always treated as labels.
std::optional<std::string> grey_image_doubt(const LabelVolume& volume, const TissueTable& tissues);

// Throws Error naming the file when the volume looks like a grey image.
void require_labels(const LabelVolume& volume, const TissueTable& tissues, const Path& path);

// The range of values that a picture shows. The value `level` is shown as middle grey, and `width` is the difference
// between the values shown as white and as black.
struct GreyWindow {
  double level = 0, width = 1;

  bool operator==(const GreyWindow&) const = default;
};
// Returns the window from the 1 % to the 99 % quantile of the volume's values, so that outliers do not widen the
// window.
GreyWindow usual_window(const GreyVolume& volume);

// The position of a picture in the world: its centre `middle`, mm, and unit vectors along its rows (`right`) and its
// columns (`down`).
struct GreyFrame {
  glm::dvec3 middle{0}, right{1, 0, 0}, down{0, 1, 0};
  glm::ivec2 size{1};  // width and height of the picture, pixels
  double millimetres_per_pixel = 1;
};
// Both functions return the picture's values row by row from the top. A value is NaN where the picture lies outside the
// volume.
//   grey_slice       the value of the voxel nearest to each pixel
//   grey_projection  the largest value along each pixel's line of sight through the whole volume
std::vector<float> grey_slice(const GreyVolume& volume, const GreyFrame& frame);
std::vector<float> grey_projection(const GreyVolume& volume, const GreyFrame& frame);

// Returns the grey level at which a value is shown: 0 (black) to 255 (white), and 0 for NaN.
std::uint8_t grey_of(float value, const GreyWindow& window);

}  // namespace limber
