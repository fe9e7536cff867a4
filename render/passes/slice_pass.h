// SPDX-License-Identifier: AGPL-3.0-or-later
// A plane through the labels, one pixel at a time, voxels as they are; or through a posed body, where its map leads.
// Weights take the place of the tissues' colours, with the borders of tissues faintly upon them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "render/scene/slice_camera.h"
#include "render/textures/appearance_texture.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/volume_texture.h"
#include "render/textures/weight_texture.h"

namespace limber::render {

class SlicePass {
 public:
  SlicePass();

  // Into the framebuffer that is bound: hidden tissue and air show the background.
  //   posed    of a posed body, or null
  //   weights  shown in the tissues' place, or null
  void draw(const VolumeTexture& volume, const PosedTexture* posed, const LooksTexture& looks,
            const WeightTexture* weights, bool contours, const SliceCamera& camera, SliceDisplay display,
            std::optional<Label> outlined, const glm::ivec2& size);

 private:
  std::map<std::tuple<int, bool, std::optional<WeightReading>>, std::unique_ptr<gl::Program>>
      programs_;  // by number of atlases, for posed bodies, with weights
  gl::VertexArray nothing_;
};

}  // namespace limber::render
