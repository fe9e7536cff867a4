// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/shade_pass.h"

#include <algorithm>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

// Two adjacent pixels count as one surface if their rest positions are at most kJoined voxels plus kSlant pixel sizes
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
                     int layer, bool ghost, Colours colours) {
  if (field.hull().empty()) return;
  const bool weights = colours != Colours::Tissues && !ghost;
  gl::Program& program = ghost ? ghost_ : weights ? (posed ? posed_weights_ : weights_) : posed ? posed_ : solid_;
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, rect.high.x - rect.low.x, rect.high.y - rect.low.y);
  // Covers the picture with a triangle at the far plane. Only pixels with the hull in front of the far plane pass the
  // depth test, so that all others are skipped.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  program.use();
  set_rays(program, rays);
  program.set("u_layer", static_cast<unsigned>(layer));
  program.set_texture("u_depth", 0, GL_TEXTURE_2D, buffer.depth.name());
  program.set_texture("u_normal", 1, GL_TEXTURE_2D, buffer.normal.name());
  program.set_texture("u_label", 2, GL_TEXTURE_2D, buffer.label.name());
  program.set_texture("u_looks", 3, GL_TEXTURE_2D, looks.name());
  program.set_texture("u_occupancy", 4, GL_TEXTURE_3D, field.occupancy().name());
  program.set("u_occupancy_texel", 1.0f / glm::vec3(volume.layout().bricks() * kBrick));
  int unit = 5;
  if (posed && !ghost) unit = posed->bind(volume, program, unit);
  if (weights) {
    program.set_texture("u_weight", unit++, GL_TEXTURE_2D, buffer.weight.name());
    program.set_texture("u_place", unit++, GL_TEXTURE_2D, buffer.place.name());
    program.set("u_lines", colours == Colours::WeightsWithContours  ? 1
                           : colours == Colours::WeightsWithBorders ? 2
                                                                    : 0);
    program.set("u_joined", glm::vec2(kJoined, kSlant * 2 / float(buffer.size().x)) / place_step(volume));
  }
  // The matrix converts a unit normal in view axes to a vector in padded coordinates that is one brick long, for any
  // voxel spacing.
  const glm::dmat3 to_view = glm::transpose(rays.view_from_gradient);
  const double scale = kBrick / std::max({glm::length(to_view[0]), glm::length(to_view[1]), glm::length(to_view[2])});
  program.set("u_padded_from_view", glm::mat3(to_view * scale));
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace limber::render
