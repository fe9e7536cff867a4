// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes the pictures of a study. Slices are drawn here, voxel by voxel; bodies in 3D are drawn by a PictureMaker.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// The region of world space that a picture shows, in parallel projection. The view direction is opposite to right x up.
struct PictureFrame {
  glm::dvec3 centre{0}, right{1, 0, 0}, up{0, 0, 1};  // centre in mm; right and up: perpendicular unit vectors
  double height_mm = 100;
  glm::ivec2 size{480, 360};  // pixels

  glm::dvec3 towards_eye() const { return glm::cross(right, up); }
};

struct Picture {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgb;  // 3 bytes per pixel, rows from top to bottom
};
using LabelColours = std::vector<glm::u8vec3>;  // sRGB colour of each of 65536 labels; label 0 (air): the background

LabelColours tissue_colours(const TissueTable& tissues);
// Returns the colours of the volume ratio codes of run_study.h: blue for a half and less, grey for 1, orange for twice
// and more.
LabelColours ratio_colours();

// Draws the slice in the plane through the frame's centre: each pixel has the colour of the voxel that it lies in.
Picture slice_picture(const LabelVolume& volume, const LabelColours& colours, const PictureFrame& frame);
// Draws the slice in dull colours, and in bright colours the voxels that `marks` has as 1 (claimed by two positions of
// tissue) or 2 (claimed by two bones).
Picture marked_picture(const LabelVolume& volume, const LabelVolume& marks, const LabelColours& colours,
                       const PictureFrame& frame);

std::string png_of(const Picture& picture);  // returns the bytes of the PNG file

// The box of 48 mm with the most extreme voxels, that is, voxels with less than half or more than twice their rest
// volume. There the pose compresses or stretches the tissue most.
struct WorstRegion {
  glm::dvec3 centre{0};             // mean position of the box's extreme voxels, world space, mm
  std::int64_t voxels = 0, of = 0;  // voxels: extreme voxels in the box; of: all its tissue voxels
  double least = 1, most = 1;       // smallest and largest volume ratio in the box
};
std::optional<WorstRegion> worst_region(const LabelVolume& codes);

// A request for a picture of a body in 3D. With `cut`, the tissue between the viewer and the frame's plane is removed.
struct BodyPicture {
  std::shared_ptr<const LabelVolume> volume;
  const TissueTable* tissues;
  PictureFrame frame;
  bool cut = false;
};
using PictureMaker = std::function<std::string(const BodyPicture&)>;  // returns the bytes of a PNG file
using StartPictures = std::function<PictureMaker()>;  // throws Error where this machine cannot draw pictures

}  // namespace limber
