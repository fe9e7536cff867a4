// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures of a study: slices drawn here, voxels as they are; bodies in 3D by whoever can draw them.
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

// What part of the world a picture shows, seen along `up` x `right`, without perspective.
struct PictureFrame {
  glm::dvec3 centre{0}, right{1, 0, 0}, up{0, 0, 1};  // mm; unit, at right angles
  double height_mm = 100;
  glm::ivec2 size{480, 360};  // pixels

  glm::dvec3 towards_eye() const { return glm::cross(right, up); }
};

struct Picture {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgb;  // rows from the top
};
using LabelColours = std::vector<glm::u8vec3>;  // [65536], sRGB; air's is the background

LabelColours tissue_colours(const TissueTable& tissues);
LabelColours ratio_colours();  // of the codes of run_study.h: blue half and less, grey 1, orange twice and more

// The plane through the frame's centre: each pixel has the colour of the voxel that it lies in.
Picture slice_picture(const LabelVolume& volume, const LabelColours& colours, const PictureFrame& frame);
// The same in dull colours, with what `marks` holds (1: tissue on tissue, 2: bone in bone) in loud ones.
Picture marked_picture(const LabelVolume& volume, const LabelVolume& marks, const LabelColours& colours,
                       const PictureFrame& frame);

std::string png_of(const Picture& picture);  // the bytes of the file

// Where a pose presses or stretches the most: a box of 48 mm with most voxels whose volume is less than half or more
// than twice what it was.   codes  ratio.nrrd of a cell
struct WorstRegion {
  glm::dvec3 centre{0};             // of those voxels, world
  std::int64_t voxels = 0, of = 0;  // those voxels, and all of tissue in the box
  double least = 1, most = 1;       // volume ratio in it
};
std::optional<WorstRegion> worst_region(const LabelVolume& codes);

// A body in 3D, at that frame; `cut` takes away what lies between the frame's plane and the eye.
struct BodyPicture {
  std::shared_ptr<const LabelVolume> volume;
  const TissueTable* tissues;
  PictureFrame frame;
  bool cut = false;
};
using PictureMaker = std::function<std::string(const BodyPicture&)>;  // the bytes of a PNG file
using StartPictures = std::function<PictureMaker()>;                  // throws Error where this machine cannot draw

}  // namespace limber
