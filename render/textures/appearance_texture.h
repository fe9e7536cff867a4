// SPDX-License-Identifier: AGPL-3.0-or-later
// The appearance of labels as a texture for the shaders, and the layers in which labels are drawn.
//
// A picture consists of layers. Each layer is the outer surface of a set of labels, and each set contains the next one.
// The first set contains every visible label; each next set leaves out the outer, more transparent labels. Solid has
// one layer, X-ray two (the ghost, and the tissues that stay solid), and Tissue as many as its labels need, at most
// kMostLayers. A label is drawn with its own opacity in the last layer that contains it.
#pragma once

#include <vector>

#include "render/gl/object.h"
#include "render/scene/scene.h"
#include "render/textures/surface_field.h"

namespace limber::render {

inline constexpr int kMostLayers = 5;

// Returns the label sets of the layers. Layer 0 has all visible labels; each next layer has only the labels that lie
// deeper than the layer before it.
//   exposure  for each label, the fraction of its voxels that touch air
std::vector<LabelSet> layers_of(const LabelLooks& looks, Display display, const std::vector<float>& exposure);

class LooksTexture {
 public:
  // Computes the layers of the labels, and uploads their looks as a texture.
  //   exposure  for each of the 65536 labels, the fraction of its voxels that touch air; tells outer from inner tissues
  LooksTexture(const LabelLooks& looks, Display display, const std::vector<float>& exposure);

  // Returns a texture of 256 x 256 texels in RGBA16UI; label = x + 256 y. RGB is the label's colour in 1/255. Bits 0 to
  // 2 of alpha are 1 + the index of the last layer that contains the label (0: the label is invisible). The bits above
  // are its opacity in 1/255.
  const gl::Texture& texture() const { return texture_; }
  const std::vector<LabelSet>& layers() const { return layers_; }

 private:
  gl::Texture texture_;
  std::vector<LabelSet> layers_;
};

}  // namespace limber::render
