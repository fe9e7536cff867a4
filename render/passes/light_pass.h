// SPDX-License-Identifier: AGPL-3.0-or-later
// Light by rays, for pictures at rest. From the surface that a pixel shows, rays go to a disc of the key light, which
// gives soft shadows, and into the half space over the surface, evenly by the cosine, which gives the share of the sky
// that is seen there (ambient occlusion, the form factor of the sky). A ray is followed through the field of the body,
// posed bodies included, without a limit of its length. Every picture that is averaged has other rays than those
// before, all from fixed sequences: the same scene gives the same light, byte for byte.
//
// Rays through the map of a posed body take several times as long, so that there only every other pixel along each axis
// is followed.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "render/passes/volume_pass.h"

namespace limber::render {

// The light at the pixels of a picture, or at every n-th pixel along each axis, other ones in each picture.
class LightBuffer {
 public:
  void resize(const GBuffer& buffer, int every);

  gl::Texture light;  // RG8: shares [0, 1] of the key light and of the sky
  gl::Framebuffer target;
  int every = 1;
  glm::ivec2 offset{0};  // the first pixel that has light; set by LightPass::draw()

 private:
  glm::ivec2 size_{0};
};

class LightPass {
 public:
  LightPass();

  // Follows rays from the hits inside `rect` that VolumePass::march() stored in `buffer` for the same layer.
  //   picture  number of pictures before this one, whose rays were others
  void draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
            const PosedHull* posed_hull, const Clip& clip, const ViewRays& rays, const GBuffer& buffer,
            LightBuffer& into, int picture, const PixelRect& rect);

 private:
  // One program for each number of atlas textures, at rest (false) and posed (true).
  std::map<std::pair<int, bool>, std::unique_ptr<gl::Program>> programs_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
