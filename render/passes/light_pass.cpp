// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/light_pass.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace limber::render {

void LightBuffer::resize(const GBuffer& buffer, int every_nth) {
  if (!target) target = gl::Framebuffer::create(), light = gl::Texture::create();
  every = every_nth;
  const glm::ivec2 size = (buffer.size() + every - 1) / every;
  if (size_ == size) return;
  size_ = size;
  glBindFramebuffer(GL_FRAMEBUFFER, target.name());
  glBindTexture(GL_TEXTURE_2D, light.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RG8, size.x, size.y, 0, GL_RG, GL_UNSIGNED_BYTE, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light.name(), 0);
  gl::check_gl("the buffer of a picture's light");
}

LightPass::LightPass() : nothing_(gl::VertexArray::create()) {}

void LightPass::draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
                     const PosedHull* posed_hull, const Clip& clip, const ViewRays& rays, const GBuffer& buffer,
                     LightBuffer& into, int picture, const PixelRect& rect) {
  const Hull& hull = posed_hull ? posed_hull->hull() : field.hull();
  if (hull.empty() || rect.empty()) return;
  auto& program = programs_[{volume.layout().atlases, posed != nullptr}];
  if (!program)
    program = std::make_unique<gl::Program>(
        gl::kWholePicture, "light.frag",
        march_defines(volume.layout().atlases, posed ? VolumePass::Space::Posed : VolumePass::Space::Rest));
  glBindFramebuffer(GL_FRAMEBUFFER, into.target.name());
  const glm::ivec2 size = (buffer.size() + into.every - 1) / into.every, low = rect.low / into.every,
                   high = (rect.high + into.every - 1) / into.every;
  into.offset = glm::ivec2(picture % 2, (picture + picture / 2) % 2) % into.every;
  glViewport(0, 0, size.x, size.y);
  glEnable(GL_SCISSOR_TEST);
  glScissor(low.x, low.y, high.x - low.x, high.y - low.y);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
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
  program->set("u_every", into.every);
  program->set("u_offset", into.offset);
  set_rays(*program, rays);
  program->set("u_padded_from_view", padded_from_view(rays));
  set_clip(*program, hull, volume, clip, rays);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
