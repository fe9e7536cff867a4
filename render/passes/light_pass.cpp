// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/light_pass.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace limber::render {

void LightBuffer::resize(const GBuffer& buffer) {
  if (!target) target = gl::Framebuffer::create(), light = gl::Texture::create();
  glBindFramebuffer(GL_FRAMEBUFFER, target.name());
  if (size_ != buffer.size()) {
    size_ = buffer.size();
    glBindTexture(GL_TEXTURE_2D, light.name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RG8, size_.x, size_.y, 0, GL_RG, GL_UNSIGNED_BYTE, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light.name(), 0);
  }
  // Buffers of pictures are swapped, so the depth may be another one than last time.
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, buffer.hull_depth.name(), 0);
  gl::check_gl("the buffer of a picture's light");
}

LightPass::LightPass() : nothing_(gl::VertexArray::create()) {}

void LightPass::draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
                     const PosedHull* posed_hull, const Clip& clip, const ViewRays& rays, const GBuffer& buffer,
                     const LightBuffer& into, int picture, const PixelRect& rect) {
  const Hull& hull = posed_hull ? posed_hull->hull() : field.hull();
  if (hull.empty() || rect.empty()) return;
  auto& program = programs_[{volume.layout().atlases, posed != nullptr}];
  if (!program)
    program = std::make_unique<gl::Program>(
        gl::kWholePicture, "light.frag",
        march_defines(volume.layout().atlases, posed ? VolumePass::Space::Posed : VolumePass::Space::Rest));
  glBindFramebuffer(GL_FRAMEBUFFER, into.target.name());
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, rect.high.x - rect.low.x, rect.high.y - rect.low.y);
  glDisable(GL_BLEND);
  // Covers the picture with a triangle at the far plane. Only pixels with the hull in front of the far plane pass the
  // depth test, so that all others are skipped.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  program->use();
  int unit = field.bind(volume, *program, 0);
  if (posed) {
    unit = posed->bind(volume, *program, unit);
    program->set_texture("u_near_cubes", unit++, GL_TEXTURE_3D, posed_hull->cubes().name());
    program->set("u_blocks", volume.layout().blocks);
  }
  program->set_texture("u_depth", unit++, GL_TEXTURE_2D, buffer.depth.name());
  program->set_texture("u_normal", unit++, GL_TEXTURE_2D, buffer.normal.name());
  program->set("u_picture", picture);
  set_rays(*program, rays);
  program->set("u_padded_from_view", padded_from_view(rays));
  set_clip(*program, hull, volume, clip, rays);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
