// SPDX-License-Identifier: AGPL-3.0-or-later
// Lights what the rays met: a soft key light over the viewer's left shoulder, sky from above, a thin rim, and shade where
// the body closes in on itself (from its blurred occupancy). Light adds up linearly; colours are sRGB by a gamma of two.
// In X-ray the visible surface is a ghost over the solid bones. Cut faces show plain tissue colours.
#pragma once

#include "render/volume_pass.h"

namespace limber::render {

class ShadePass {
 public:
  ShadePass();

  // Into the framebuffer that is bound, which has the buffer's size and hull depth and is clear: premultiplied colours where
  // the volume shows.
  //   bones  what lies under the ghost; nullptr: the surface is solid
  void draw(const VolumeTexture& volume, const VisibleField& field, const GBuffer& surface, const GBuffer* bones, const VisibleField* bone_field,
            const gl::Texture& looks, const ViewRays& rays, const PixelRect& rect);

 private:
  gl::Program solid_, ghost_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
