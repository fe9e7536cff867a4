// SPDX-License-Identifier: AGPL-3.0-or-later
// A plane through the labels, one pixel at a time, voxels as they are; or through a posed body, where its map leads.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "render/looks_texture.h"
#include "render/posed_texture.h"
#include "render/view.h"
#include "render/volume_texture.h"

namespace limber::render {

class SlicePass {
 public:
  SlicePass();

  // Into the framebuffer that is bound: hidden tissue and air show the background.
  //   posed  of a posed body, or null
  void draw(const VolumeTexture& volume, const PosedTexture* posed, const LooksTexture& looks, const SliceCamera& camera, SliceDisplay display,
            std::optional<Label> outlined, const glm::ivec2& size);

 private:
  std::map<std::pair<int, bool>, std::unique_ptr<gl::Program>> programs_;  // by number of atlases, and for posed bodies
  gl::VertexArray nothing_;
};

}  // namespace limber::render
