// SPDX-License-Identifier: AGPL-3.0-or-later
// Renders a grey image in 3D. Each ray adds up colours and opacities of the image's values from front to back [Levoy
// 1988], shaded by the image's gradient, or keeps the largest value (maximum intensity projection). Blocks in which
// all values have zero opacity are skipped. For a posed body, the rays convert each position to its rest position by
// the body's inverse map, so that the image moves with the body.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/passes/view_rays.h"
#include "render/passes/volume_pass.h"
#include "render/scene/scene.h"
#include "render/textures/grey_texture.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

class ImagePass {
 public:
  ImagePass();

  // Returns the box, in padded coordinates of the volume, in which the image can be visible: the image's box at rest,
  // or the box of the posed body's inverse map.
  static std::array<glm::dvec3, 2> box(const VolumeTexture& volume, const PosedTexture* posed, const GreyTexture& grey);

  // Draws the image, with premultiplied alpha, into a rectangle of the bound framebuffer of `size` pixels, and
  // replaces the previous content.
  //   posed  the inverse map of the posed body; null: the body is at rest
  //   clip   clip box and plane, which cut the image in the same way as the body
  //   step   length of a ray's steps, in voxels of the image; longer while something moves
  void draw(const VolumeTexture& volume, const PosedTexture* posed, const GreyTexture& grey, const ShownGrey& shown,
            const Clip& clip, const ViewRays& rays, double step, const PixelRect& rect, const glm::ivec2& size);

 private:
  void upload_transfer(const ShownGrey& shown);

  // The shader programs. First key: true if the body is posed; second key: true for a maximum intensity projection.
  std::map<std::pair<bool, bool>, std::unique_ptr<gl::Program>> programs_;
  gl::Texture transfer_;
  std::optional<ShownGrey> transfer_of_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
