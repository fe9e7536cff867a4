// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a plane through the labels without smoothing voxels. For a posed body, each position of the plane is converted
// to its rest position by the inverse map. If weights are shown, their colours replace those of the tissues, with
// faint lines at the borders of tissues. A grey image is drawn below the tissues, which are then transparent.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "render/scene/scene.h"
#include "render/scene/slice_camera.h"
#include "render/textures/appearance_texture.h"
#include "render/textures/grey_texture.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/volume_texture.h"
#include "render/textures/weight_texture.h"

namespace limber::render {

class SlicePass {
 public:
  SlicePass();

  // Draws the slice into the bound framebuffer. Pixels of air or of hidden tissue keep the background.
  //   posed    the inverse map of the posed body; null: the body is at rest
  //   weights  weights to show instead of tissue colours; null: tissue colours
  //   line_scale  width of borders and contour lines, pixels
  //   grey     the texture of shown_grey's image, to show below the tissues; null: no image is shown
  void draw(const VolumeTexture& volume, const PosedTexture* posed, const LooksTexture& looks,
            const WeightTexture* weights, bool contours, const GreyTexture* grey, const ShownGrey& shown_grey,
            const SliceCamera& camera, SliceDisplay display, std::optional<Label> outlined, float line_scale,
            const glm::ivec2& size);

 private:
  // One program for each number of atlas textures, for a body at rest or posed, without or with a grey image, and for
  // each way to read weights (empty: no weights are shown).
  std::map<std::tuple<int, bool, bool, std::optional<WeightReading>>, std::unique_ptr<gl::Program>> programs_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
