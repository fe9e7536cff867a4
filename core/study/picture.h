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

// The rectangle of world space that a picture shows, in parallel projection. The vector right x up points to the
// viewer.
struct PictureFrame {
  glm::dvec3 centre{0}, right{1, 0, 0}, up{0, 0, 1};  // centre in mm; right and up: perpendicular unit vectors
  double height_mm = 100;
  glm::ivec2 size{480, 360};  // width and height of the picture, pixels

  glm::dvec3 towards_eye() const { return glm::cross(right, up); }
};

struct Picture {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgb;  // 3 bytes per pixel, rows from top to bottom
};
using LabelColours = std::vector<glm::u8vec3>;  // sRGB colours of the labels 0 to 65535; label 0 (air): the background

LabelColours tissue_colours(const TissueTable& tissues);
// Returns the colours of the volume ratios in ratio.nrrd, which are coded as bytes (see code_of_ratio in run_study.h):
// blue for 1/2 and less, grey for 1, orange for 2 and more.
LabelColours ratio_colours();

// Draws the slice of a volume in the frame's plane. Each pixel gets the colour of the voxel at its position.
Picture slice_picture(const LabelVolume& volume, const LabelColours& colours, const PictureFrame& frame);
glm::u8vec3 dulled(const glm::u8vec3& colour);  // returns the dull colour of a voxel that is not marked
// Draws the slice of a volume in dull colours, and marked voxels in bright colours. In `marks`, 1 means that the pose
// moves two pieces of tissue to this voxel, 2 that it moves two bones there.
Picture marked_picture(const LabelVolume& volume, const LabelVolume& marks, const LabelColours& colours,
                       const PictureFrame& frame);

std::string png_of(const Picture& picture);  // returns the bytes of the PNG file

// The region that a pose compresses or stretches most: the cube of 48 mm with the largest number of extreme voxels,
// which have less than half or more than twice their rest volume.
struct WorstRegion {
  glm::dvec3 centre{0};             // mean position of the cube's extreme voxels, world space, mm
  std::int64_t voxels = 0, of = 0;  // number of extreme voxels in the cube; number of all its tissue voxels
  double least = 1, most = 1;       // smallest and largest volume ratio in the cube
};
std::optional<WorstRegion> worst_region(const LabelVolume& codes);

// A request for a picture of a body in 3D. If `cut` is true, the tissue between viewer and frame's plane is removed, so
// that the picture shows the body's inside.
struct BodyPicture {
  std::shared_ptr<const LabelVolume> volume;
  const TissueTable* tissues;
  PictureFrame frame;
  bool cut = false;
};
using PictureMaker = std::function<std::string(const BodyPicture&)>;  // returns the bytes of a PNG file
using StartPictures = std::function<PictureMaker()>;  // throws Error if this machine cannot draw 3D pictures

}  // namespace limber
