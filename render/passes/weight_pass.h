// SPDX-License-Identifier: AGPL-3.0-or-later
// Looks up the colour of the skin weights at the rest position of each pixel. This pass runs after the rays and before
// shading. When other weights, another bone or another display are shown, the rays and their buffers can therefore be
// reused.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "render/passes/volume_pass.h"
#include "render/textures/weight_texture.h"

namespace limber::render {

class WeightPass {
 public:
  WeightPass();

  // Draws the colours of the weights into GBuffer::weight inside `rect`. The buffer must have been resized with places
  // = true.
  void draw(const VolumeTexture& volume, const WeightTexture& weights, const ViewRays& rays, const GBuffer& buffer,
            const PixelRect& rect);

 private:
  // One program for each number of atlas textures and each way to read weights.
  std::map<std::pair<int, WeightReading>, std::unique_ptr<gl::Program>> programs_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
