// SPDX-License-Identifier: AGPL-3.0-or-later
// Puts a picture together: background, ground grid, the body at whatever resolution it has, the outline of a tissue.
#pragma once

#include <optional>

#include "core/volume/label_volume.h"
#include "render/passes/volume_pass.h"
#include "render/scene/camera.h"

namespace limber::render {

enum class Background { Dark, Light, Transparent };

class ComposePass {
 public:
  ComposePass();

  // All into the framebuffer that is bound, of `size` pixels.
  void background(Background background, const glm::ivec2& size);
  // Lines every 100 mm on the plane z = height, fading out `reach` mm from the middle.
  void grid(const Camera& camera, const glm::ivec2& size, const glm::dvec3& middle, double height, double reach,
            float line_scale);
  // `picture`, premultiplied, stretched over the framebuffer.
  void body(const gl::Texture& picture, const glm::ivec2& size, const PixelRect& rect);
  // Two pixels, or line_scale times as many, about the places where `label` is shown.
  void outline(const GBuffer& buffer, Label label, const glm::ivec2& size, const PixelRect& rect, float line_scale);
  // accumulated = mix(accumulated, picture, weight), into the framebuffer that is bound
  void accumulate(const gl::Texture& picture, const glm::ivec2& size, float weight, const PixelRect& rect);

 private:
  void cover(const glm::ivec2& size, const PixelRect& rect);

  gl::Program background_, grid_, body_, outline_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
