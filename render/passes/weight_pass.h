// SPDX-License-Identifier: AGPL-3.0-or-later
// Looks up what each pixel of a picture shows of skin weights, at the places where its rays met the body. It stands
// between rays and shading: other weights, another bone or another display need neither new rays nor new buffers.
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

  // Into the buffer's own weights, inside `rect`. The buffer has places.
  void draw(const VolumeTexture& volume, const WeightTexture& weights, const ViewRays& rays, const GBuffer& buffer,
            const PixelRect& rect);

 private:
  std::map<std::pair<int, WeightReading>, std::unique_ptr<gl::Program>> programs_;  // by number of atlases
  gl::VertexArray nothing_;
};

}  // namespace limber::render
