// SPDX-License-Identifier: AGPL-3.0-or-later
// Composes a picture from the background, the ground grid, the body (at any resolution) and the outline of a tissue.
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

  // All functions draw into the bound framebuffer of `size` pixels. Functions with `rect` change only the pixels in it.
  void background(Background background, const glm::ivec2& size);
  // Draws grid lines every 100 mm on the plane z = height. The lines fade out towards `reach` mm from `middle`.
  void grid(const Camera& camera, const glm::ivec2& size, const glm::dvec3& middle, double height, double reach,
            float line_scale);
  // Draws the picture of the body, which has premultiplied alpha, stretched over the framebuffer. Pixels outside `rect`
  // do not change.
  void body(const gl::Texture& picture, const glm::ivec2& size, const PixelRect& rect);
  // Draws a blend of two pictures of the body, which have premultiplied alpha: `share` of `other` and 1 - `share` of
  // `picture`. Pixels outside `rect` do not change.
  void bodies(const gl::Texture& picture, const gl::Texture& other, float share, const glm::ivec2& size,
              const PixelRect& rect);
  // Draws an outline around the pixels that show `label`, two pixels times line_scale wide.
  void outline(const GBuffer& buffer, Label label, const glm::ivec2& size, const PixelRect& rect, float line_scale);
  // Adds a picture to the average in the framebuffer: accumulated = mix(accumulated, picture, weight).
  void accumulate(const gl::Texture& picture, const glm::ivec2& size, float weight, const PixelRect& rect);

 private:
  void cover(const glm::ivec2& size, const PixelRect& rect);

  gl::Program background_, grid_, body_, bodies_, outline_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
