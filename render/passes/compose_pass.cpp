// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/compose_pass.h"

#include <cmath>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

glm::vec3 rgb(unsigned hex) { return glm::vec3(hex >> 16 & 255, hex >> 8 & 255, hex & 255) / 255.0f; }

void blend_premultiplied() {
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

}  // namespace

ComposePass::ComposePass()
    : background_(gl::kWholePicture, "background.frag"),
      grid_("grid.vert", "grid.frag"),
      body_(gl::kWholePicture, "copy.frag"),
      bodies_(gl::kWholePicture, "copy.frag", gl::define("MIXED")),
      outline_(gl::kWholePicture, "outline.frag"),
      nothing_(gl::VertexArray::create()) {}

void ComposePass::cover(const glm::ivec2& size, const PixelRect& rect) {
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.low.x, rect.low.y, std::max(rect.high.x - rect.low.x, 0), std::max(rect.high.y - rect.low.y, 0));
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

void ComposePass::background(Background background, const glm::ivec2& size) {
  glDisable(GL_BLEND);
  if (background == Background::Transparent) {
    const float nothing[4] = {0, 0, 0, 0};
    glDisable(GL_SCISSOR_TEST);
    glClearBufferfv(GL_COLOR, 0, nothing);
    return;
  }
  background_.use();
  background_.set("u_top", background == Background::Light ? rgb(0x3E434B) : rgb(0x31343B));
  background_.set("u_bottom", background == Background::Light ? rgb(0x25282D) : rgb(0x1B1D21));
  cover(size, {{0, 0}, size});
}

void ComposePass::grid(const Camera& camera, const glm::ivec2& size, const glm::dvec3& middle, double height,
                       double reach, float line_scale) {
  constexpr double kStep = 100;  // distance between grid lines, mm
  const glm::dvec3 ground(middle.x, middle.y, height);
  const glm::dmat4 clip =
      clip_from_view(camera, double(size.x) / size.y, ground, reach * 1.5) * view_from_world(camera);
  glm::dmat4 moved = clip;  // projects positions relative to `ground`, so that floats are precise enough
  moved[3] = clip * glm::dvec4(ground, 1);
  blend_premultiplied();
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
  grid_.use();
  grid_.set("u_clip", glm::mat4(moved));
  grid_.set("u_middle", glm::vec3(0));
  grid_.set("u_line", line_scale);
  grid_.set("u_reach", static_cast<float>(reach));
  grid_.set("u_step", static_cast<float>(kStep));
  grid_.set("u_offset", glm::vec2(glm::mod(glm::dvec2(middle), kStep * 5)));
  glBindVertexArray(nothing_.name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glBindVertexArray(0);
}

void ComposePass::body(const gl::Texture& picture, const glm::ivec2& size, const PixelRect& rect) {
  blend_premultiplied();
  body_.use();
  body_.set_texture("u_picture", 0, GL_TEXTURE_2D, picture.name());
  cover(size, rect);
}

void ComposePass::bodies(const gl::Texture& picture, const gl::Texture& other, float share, const glm::ivec2& size,
                         const PixelRect& rect) {
  blend_premultiplied();
  bodies_.use();
  bodies_.set_texture("u_picture", 0, GL_TEXTURE_2D, picture.name());
  bodies_.set_texture("u_other", 1, GL_TEXTURE_2D, other.name());
  bodies_.set("u_share", share);
  cover(size, rect);
}

void ComposePass::outline(const GBuffer& buffer, Label label, const glm::ivec2& size, const PixelRect& rect,
                          float line_scale) {
  blend_premultiplied();
  outline_.use();
  outline_.set("u_line", line_scale);
  outline_.set_texture("u_label", 0, GL_TEXTURE_2D, buffer.label.name());
  outline_.set("u_outlined", static_cast<unsigned>(label));
  outline_.set("u_scale", glm::vec2(buffer.size()) / glm::vec2(size));
  cover(size, rect);
}

void ComposePass::accumulate(const gl::Texture& picture, const glm::ivec2& size, float weight, const PixelRect& rect) {
  glEnable(GL_BLEND);
  glBlendColor(0, 0, 0, weight);
  glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
  body_.use();
  body_.set_texture("u_picture", 0, GL_TEXTURE_2D, picture.name());
  cover(size, rect);
}

}  // namespace limber::render
