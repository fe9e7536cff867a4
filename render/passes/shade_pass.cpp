// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/shade_pass.h"

#include <algorithm>
#include <cmath>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

// Two pixels count as one surface if their rest positions are at most kJoined voxels plus kSlant times their distance
// apart. The second term allows for surfaces seen at a slant.
constexpr float kJoined = 3, kSlant = 6;

}  // namespace

ShadePass::ShadePass()
    : solid_(gl::kWholePicture, "shade.frag"),
      posed_(gl::kWholePicture, "shade.frag", gl::define("POSED")),
      ghost_(gl::kWholePicture, "shade.frag", gl::define("GHOST")),
      weights_(gl::kWholePicture, "shade.frag", gl::define("WEIGHTS")),
      posed_weights_(gl::kWholePicture, "shade.frag", gl::define("POSED") + gl::define("WEIGHTS")),
      nothing_(gl::VertexArray::create()) {}

void ShadePass::draw(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
                     const GBuffer& buffer, const gl::Texture& looks, const ViewRays& rays, const PixelRect& rect,
                     int layer, bool ghost, Colours colours, const LightBuffer* light, float line_scale) {
  if (field.hull().empty()) return;
  const bool weights = colours != Colours::Tissues && !ghost, lit = light && !ghost;
  std::unique_ptr<gl::Program>& lit_program = weights ? lit_weights_ : lit_;
  if (lit && !lit_program)
    lit_program = std::make_unique<gl::Program>(gl::kWholePicture, "shade.frag",
                                                gl::define("LIT") + (weights ? gl::define("WEIGHTS") : ""));
  gl::Program& program = lit       ? *lit_program
                         : ghost   ? ghost_
                         : weights ? (posed ? posed_weights_ : weights_)
                         : posed   ? posed_
                                   : solid_;
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, rect.high.x - rect.low.x, rect.high.y - rect.low.y);
  // Draws one triangle over the whole picture, at the far plane. Only pixels where the hull of the visible tissue was
  // drawn in front of this triangle pass the depth test, so all other pixels are skipped.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  program.use();
  set_rays(program, rays);
  program.set("u_layer", static_cast<unsigned>(layer));
  program.set("u_line", std::max(1, static_cast<int>(std::lround(line_scale))));
  program.set_texture("u_depth", 0, GL_TEXTURE_2D, buffer.depth.name());
  program.set_texture("u_normal", 1, GL_TEXTURE_2D, buffer.normal.name());
  program.set_texture("u_label", 2, GL_TEXTURE_2D, buffer.label.name());
  program.set_texture("u_looks", 3, GL_TEXTURE_2D, looks.name());
  int unit = 4;
  if (lit) {
    program.set_texture("u_light", unit++, GL_TEXTURE_2D, light->light.name());
    const glm::dmat3 to_world = glm::inverse(glm::dmat3(rays.padded_from_world));
    program.set("u_every", light->every);
    program.set("u_offset", light->offset);
    const double step = 2.0 / buffer.size().x;
    program.set("u_pixel",
                glm::vec2(step * glm::length(to_world * rays.base_x), step * glm::length(to_world * rays.toward_x)));
  } else {
    program.set_texture("u_occupancy", unit++, GL_TEXTURE_3D, field.occupancy().name());
    program.set("u_occupancy_texel", 1.0f / glm::vec3(volume.layout().bricks() * kBrick));
  }
  if (posed && !ghost && !lit) unit = posed->bind(volume, program, unit);
  if (weights) {
    program.set_texture("u_weight", unit++, GL_TEXTURE_2D, buffer.weight.name());
    program.set_texture("u_place", unit++, GL_TEXTURE_2D, buffer.place.name());
    program.set("u_lines", colours == Colours::WeightsWithContours  ? 1
                           : colours == Colours::WeightsWithBorders ? 2
                                                                    : 0);
    program.set("u_joined", glm::vec2(kJoined, kSlant * 2 / float(buffer.size().x)) / place_step(volume));
  }
  program.set("u_padded_from_view", padded_from_view(rays));
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
