// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes light by rays for still pictures, in which nothing moves. From the surface point that a pixel shows, some
// rays go to the disc of the key light, which gives soft shadows. Other rays go into the hemisphere above the surface
// with a cosine-weighted density; the fraction of them that leaves the body is the visible share of the sky (ambient
// occlusion). A ray is followed through the field of the body, also of a posed body, to any distance. Each of the
// averaged pictures uses other rays, all from fixed sequences: the same scene gives the same light, byte for byte.
//
// Rays through the inverse map of a posed body take several times as long. In that case, light is computed only at
// every other pixel along each axis.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "render/passes/volume_pass.h"

namespace limber::render {

// The light at every n-th pixel of a picture along each axis (n = `every`). Each averaged picture uses other pixels.
class LightBuffer {
 public:
  void resize(const GBuffer& buffer, int every);

  gl::Texture light;  // RG8: fractions [0, 1] of the key light (R) and of the sky (G) that reach the surface
  gl::Framebuffer target;
  int every = 1;
  glm::ivec2 offset{0};  // the first pixel that has light; set by LightPass::draw()

 private:
  glm::ivec2 size_{0};
};

class LightPass {
 public:
  LightPass();

  // Follows light rays from the hits inside `rect` that VolumePass::march() stored in `buffer` for the same layer.
  //   picture  number of pictures averaged before this one; selects the rays of this picture
  void draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
            const PosedHull* posed_hull, const Clip& clip, const ViewRays& rays, const GBuffer& buffer,
            LightBuffer& into, int picture, const PixelRect& rect);

 private:
  // The shader programs. First key: the number of atlas textures; second key: true if the body is posed.
  std::map<std::pair<int, bool>, std::unique_ptr<gl::Program>> programs_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
