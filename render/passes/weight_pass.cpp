// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/weight_pass.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace limber::render {

namespace {}  // namespace

WeightPass::WeightPass() : nothing_(gl::VertexArray::create()) {}

void WeightPass::draw(const VolumeTexture& volume, const WeightTexture& weights, const ViewRays& rays,
                      const GBuffer& buffer, const PixelRect& rect) {
  auto& program = programs_[{volume.layout().atlases, weights.reading()}];
  if (!program)
    program = std::make_unique<gl::Program>(gl::kWholePicture, "weights.frag",
                                            weight_defines(volume.layout().atlases, weights.reading()));
  glBindFramebuffer(GL_FRAMEBUFFER, buffer.weight_target.name());
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, std::max(rect.high.x - rect.low.x, 0), std::max(rect.high.y - rect.low.y, 0));
  // Draws one triangle over the whole picture, at the far plane. Only pixels where the hull of the visible tissue was
  // drawn in front of this triangle pass the depth test, so all other pixels are skipped.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  glDisable(GL_BLEND);
  program->use();
  const int unit = weights.bind(volume, *program, 0);
  program->set_texture("u_place", unit, GL_TEXTURE_2D, buffer.place.name());
  program->set("u_place_step", place_step(volume));
  program->set("u_shift", rays.label_shift);
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
