// SPDX-License-Identifier: AGPL-3.0-or-later
// How labels are drawn, as a table for the shaders: 256 x 256 texels RGBA8UI, label = x + 256 y. Colour in the first three
// channels; the last one's bit 0: visible, bit 1: visible and bone, bits 2 to 7: opacity in 1/63.
#pragma once

#include "render/gl/object.h"
#include "render/scene.h"
#include "render/visible_field.h"

namespace limber::render {

class LooksTexture {
 public:
  explicit LooksTexture(const LabelLooks& looks);

  const gl::Texture& texture() const { return texture_; }
  const LabelSet& visible() const { return visible_; }
  const LabelSet& bones() const { return bones_; }

 private:
  gl::Texture texture_;
  LabelSet visible_, bones_;
};

}  // namespace limber::render
