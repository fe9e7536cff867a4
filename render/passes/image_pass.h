// SPDX-License-Identifier: AGPL-3.0-or-later
// Renders a grey image in 3D. Each ray adds up colours and opacities of the image's values from front to back
// [Levoy 1988], lit by the image's gradient, or keeps the largest value (maximum intensity projection). Blocks whose
// values are all without opacity are skipped. The rays of a posed body convert each position to rest by the body's
// inverse map, so that the image moves with the body.
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

  // The box in the padded coordinates of the volume in which the image can be seen: that of the image at rest, or that
  // of the posed body's map.
  static std::array<glm::dvec3, 2> box(const VolumeTexture& volume, const PosedTexture* posed, const GreyTexture& grey);

  // Draws the image, with premultiplied alpha, into a rectangle of the bound framebuffer of `size` pixels, and replaces
  // what was there.
  //   posed  the inverse map of the posed body; null: the body is at rest
  //   clip   cuts the image open as it cuts the body
  //   step   the length of a ray's steps, in voxels of the image; a moving picture takes longer steps
  void draw(const VolumeTexture& volume, const PosedTexture* posed, const GreyTexture& grey, const ShownGrey& shown,
            const Clip& clip, const ViewRays& rays, double step, const PixelRect& rect, const glm::ivec2& size);

 private:
  void upload_transfer(const ShownGrey& shown);

  std::map<std::pair<bool, bool>, std::unique_ptr<gl::Program>> programs_;  // by: posed, maximum
  gl::Texture transfer_;
  std::optional<ShownGrey> transfer_of_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
