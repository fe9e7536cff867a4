// SPDX-License-Identifier: AGPL-3.0-or-later
// Lights what the rays met: a soft key light over the viewer's left shoulder, sky from above, a thin rim, and shade
// where the body closes in on itself (from its blurred occupancy). Light adds up linearly; colours are sRGB by a gamma
// of two. Where skin weights are shown their colours take the place of the tissues', with contours upon them. In X-ray
// the outer layer is a ghost: nearly clear where it faces the viewer, denser at its rim. Cut faces show plain tissue
// colours.
#pragma once

#include "render/passes/volume_pass.h"

namespace limber::render {

class ShadePass {
 public:
  ShadePass();

  // Blends one layer over the framebuffer that is bound, which has the buffer's size and the first layer's hull depth:
  // premultiplied colours. Layers are drawn from the innermost outward.
  //   ghost  as the outer layer of X-ray
  //   layer  labels that belong to a deeper layer too are left to it
  //   posed  of a posed body, or null
  //   colours  of tissues, or of the weights that the buffer holds
  enum class Colours {
    Tissues,
    Weights,
    WeightsWithContours,
    WeightsWithBorders
  };  // contours between ranges, borders between colours
  void draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed, const GBuffer& buffer,
            const gl::Texture& looks, const ViewRays& rays, const PixelRect& rect, int layer, bool ghost,
            Colours colours);

 private:
  gl::Program solid_, posed_, ghost_, weights_, posed_weights_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
