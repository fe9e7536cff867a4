// SPDX-License-Identifier: AGPL-3.0-or-later
// A plane through the labels, one pixel at a time, voxels as they are.
#pragma once

#include <map>
#include <memory>

#include "render/looks_texture.h"
#include "render/view.h"
#include "render/volume_texture.h"

namespace limber::render {

class SlicePass {
 public:
  SlicePass();

  // Into the framebuffer that is bound: hidden tissue and air show the background.
  void draw(const VolumeTexture& volume, const LooksTexture& looks, const SliceCamera& camera, SliceDisplay display,
            std::optional<Label> outlined, const glm::ivec2& size);

 private:
  std::map<int, std::unique_ptr<gl::Program>> programs_;  // by number of atlases
  gl::VertexArray nothing_;
};

}  // namespace limber::render
