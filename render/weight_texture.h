// SPDX-License-Identifier: AGPL-3.0-or-later
// What is shown of skin weights, on the card: four bytes a voxel in atlases laid out like the volume's labels
// (block_layout.h), so that a place is found by the labels' own index, and filtered reads go smoothly from voxel to voxel.
//
// A texel holds what the display asks for, worked out here from the whole numbers: of the active bone its weight in 8 bits,
// whether that is exactly 0, whether it is exactly 1; else a colour. The last channel says that there is tissue, so that
// what is filtered counts tissue alone: (weight, is 0, is 1, 1) or (colour, 1), and zeros in air; air beside tissue is
// coloured like it, for what is read on the surface. Within a region all four are half of that, so that outside of it colours
// can be dull while only the bricks of the region are uploaded. The arm of 646 912 tissue voxels takes twice as much as its labels.
//
// Weights share the bricks that are equal in both, and only bricks that differ from what is there are uploaded; another
// active bone uploads the bricks in which the old or the new one occurs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/scene.h"
#include "render/volume_texture.h"

namespace limber::render {

// How a display is read: as a ramp of filtered weights, filtered colours, or the colours of voxels. Programs are made for
// each, since a software driver follows every branch.
enum class WeightReading { Ramp, Filtered, Voxels };
WeightReading reading_of(WeightDisplay display);

class WeightTexture {
 public:
  // Throws Error when the driver has no room for it.
  explicit WeightTexture(const VolumeTexture& volume);

  // Throws std::logic_error if weights or tissue are another volume's.
  void update(const VolumeTexture& volume, const ShownWeights& shown);

  // The box of padded coordinates in which the last change lies, and how many there were.
  struct Change {
    glm::vec3 low{0}, high{0};
    int count = 0;
  };
  const Change& change() const { return change_; }
  std::int64_t texels_uploaded() const { return texels_uploaded_; }  // by the last update
  std::int64_t bytes() const { return bytes_; }

  WeightReading reading() const { return reading_of(shown_->display); }
  // What weight_functions() read; returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

 private:
  std::vector<std::uint8_t> changed_bricks(const ShownWeights& shown) const;
  bool region_differs(const ShownWeights& shown, std::int64_t brick) const;

  std::vector<gl::Texture> atlases_;
  std::optional<ShownWeights> shown_;  // what is there
  Change change_;
  std::int64_t texels_uploaded_ = 0, bytes_ = 0;
};

// vec4 weights_at(vec3 p): the texel at a place in padded coordinates, filtered or of the voxel; zeros in air. vec4
// weight_colour(vec4 texel): the last channel is 0 without tissue, else the active bone's range between contours, 1 to 4, in
// 255. Defines RAMP, FILTERED or VOXELS.
std::string weight_functions(int atlases, WeightReading reading);

}  // namespace limber::render
