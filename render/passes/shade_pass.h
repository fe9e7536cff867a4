// SPDX-License-Identifier: AGPL-3.0-or-later
// Shades the surfaces that the rays hit: with a soft key light from over the viewer's left shoulder, light from the
// sky above, a thin rim light, and darker creases (ambient occlusion from the body's blurred occupancy). Light is
// added in linear space; sRGB is approximated by a gamma of two. If skin weights are shown, their colours replace
// those of the tissues, with contour lines on top. In X-ray the outer layer is a ghost: nearly transparent where it
// faces the viewer, and denser where it is seen at a slant. Cut faces have plain tissue colours without shading, so
// that they match the legend.
#pragma once

#include "render/passes/light_pass.h"
#include "render/passes/volume_pass.h"

namespace limber::render {

class ShadePass {
 public:
  ShadePass();

  // What colours the body: the tissues, or the skin weights of the buffer. Weights can have contour lines between
  // ranges of the weight, or lines at the borders between different colours.
  enum class Colours { Tissues, Weights, WeightsWithContours, WeightsWithBorders };
  // Blends one layer (the surface of a set of labels), with premultiplied alpha, over the bound framebuffer. The
  // framebuffer must have the buffer's size, and the first layer's GBuffer::hull_depth as its depth. Layers must be
  // drawn from the innermost outward.
  //   ghost       draws the layer as the outer layer of X-ray
  //   layer       index of the layer; labels that also belong to a deeper layer are not drawn here
  //   posed       the inverse map of the posed body; null: the body is at rest
  //   light       light by rays at the buffer's pixels; null: the body's blurred occupancy darkens creases instead
  //   line_scale  width of contour lines and of the outlines of tissues on cut faces, pixels
  void draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed, const GBuffer& buffer,
            const gl::Texture& looks, const ViewRays& rays, const PixelRect& rect, int layer, bool ghost,
            Colours colours, const LightBuffer* light, float line_scale);

 private:
  gl::Program solid_, posed_, ghost_, weights_, posed_weights_;
  // For pictures with ray-traced light; compiled for the first such picture.
  std::unique_ptr<gl::Program> lit_, lit_weights_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
