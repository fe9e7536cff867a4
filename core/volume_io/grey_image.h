// SPDX-License-Identifier: AGPL-3.0-or-later
// Grey images (CT, MR) that come where labels are meant, and pictures of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_io.h"

namespace limber {

// Says what makes a label volume look like a grey image, "it has 300 values, and 99 % of neighbouring voxels differ";
// nothing where it does not. Labels that mostly have names are labels, however finely they are mixed.
std::optional<std::string> grey_image_doubt(const LabelVolume& volume, const TissueTable& tissues);

// Throws Error, one line that names the file, for a volume that looks like a grey image.
void require_labels(const LabelVolume& volume, const TissueTable& tissues, const Path& path);

// Which values are shown: `level` is the middle grey, and `width` reaches from black to white.
struct GreyWindow {
  double level = 0, width = 1;

  bool operator==(const GreyWindow&) const = default;
};
// From the first to the last hundredth of the values, which hides outliers.
GreyWindow usual_window(const GreyVolume& volume);

// Where a picture lies in the world: its middle, mm, and unit axes along its rows and columns.
struct PictureFrame {
  glm::dvec3 middle{0}, right{1, 0, 0}, down{0, 1, 0};
  glm::ivec2 size{1};  // pixels
  double millimetres_per_pixel = 1;
};
// Values by rows from the top; NaN outside the volume.
//   slice       of the nearest voxels
//   projection  the largest value along each line of sight through the whole volume
std::vector<float> grey_slice(const GreyVolume& volume, const PictureFrame& frame);
std::vector<float> grey_projection(const GreyVolume& volume, const PictureFrame& frame);

// A value's grey in that window; 0 for NaN.
std::uint8_t grey_of(float value, const GreyWindow& window);

}  // namespace limber
