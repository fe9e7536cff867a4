// SPDX-License-Identifier: AGPL-3.0-or-later
// How labels are drawn, as a table for the shaders, and the layers in which they are drawn.
//
// A picture is made of layers, each the outer surface of a set of labels that lies within the set before it: the first
// holds every visible label, the next ones those left when the outer, more transparent ones are peeled off. Solid has
// one layer, X-ray two (the ghost, what stays solid), Tissue as many as its labels ask for, kMostLayers at most. A
// label is drawn with its own opacity in the last layer that has it.
#pragma once

#include <vector>

#include "render/gl/object.h"
#include "render/scene/scene.h"
#include "render/textures/surface_field.h"

namespace limber::render {

inline constexpr int kMostLayers = 5;

class LooksTexture {
 public:
  // exposure  by label, 65536: the share of its voxels that touch air, which tells outer tissues from inner ones
  LooksTexture(const LabelLooks& looks, Display display, const std::vector<float>& exposure);

  // 256 x 256 texels RGBA16UI, label = x + 256 y: colour in 1/255; then 1 + its last layer in bits 0 to 2 (0:
  // invisible), opacity in 1/255 above.
  const gl::Texture& texture() const { return texture_; }
  const std::vector<LabelSet>& layers() const { return layers_; }

 private:
  gl::Texture texture_;
  std::vector<LabelSet> layers_;
};

}  // namespace limber::render
