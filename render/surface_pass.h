// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a posed surface into the buffers that rays fill for a volume: the passes that shade, outline and pick do not tell
// them apart.
#pragma once

#include <memory>

#include "core/deform/skinned_surface.h"
#include "render/volume_pass.h"

namespace limber::render {

class SurfacePass {
 public:
  SurfacePass();

  // All of the buffer; `view_from_world` turns directions.
  void draw(const std::shared_ptr<const PosedSurface>& surface, const VolumeTexture& volume, const ViewRays& rays, const glm::dmat3& view_from_world, const GBuffer& buffer);

 private:
  void upload(const std::shared_ptr<const PosedSurface>& surface);

  gl::Program program_;
  gl::VertexArray array_;
  gl::Buffer places_, normals_, labels_, rest_, corners_;
  std::shared_ptr<const PosedSurface> uploaded_;
};

}  // namespace limber::render
