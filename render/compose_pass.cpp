// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/compose_pass.h"

#include <cmath>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

// A gradient from the top down. Its steps are one in 255: half a step of ordered noise hides them.
const char* const kBackground = R"(
in vec2 ndc;
uniform vec3 u_top, u_bottom;
layout(location = 0) out vec4 colour;
void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  int order = ((cell.x ^ cell.y) & 1) * 8 + (cell.x & 1) * 4 + ((cell.x >> 1 ^ cell.y >> 1) & 1) * 2 + (cell.x >> 1);
  colour = vec4(mix(u_bottom, u_top, ndc.y * 0.5 + 0.5) + (float(order) - 7.5) / (16.0 * 255.0), 1.0);
}
)";

const char* const kBody = R"(
in vec2 ndc;
uniform sampler2D u_picture;
layout(location = 0) out vec4 colour;
void main() { colour = textureLod(u_picture, ndc * 0.5 + 0.5, 0.0); }
)";

const char* const kOutline = R"(
in vec2 ndc;
uniform usampler2D u_label;
uniform uint u_outlined;
uniform vec2 u_scale;       // buffer pixels a picture pixel
uniform float u_line;       // picture pixels a line's pixel
layout(location = 0) out vec4 colour;
bool shows(vec2 pixel) { return texelFetch(u_label, clamp(ivec2(pixel * u_scale), ivec2(0), textureSize(u_label, 0) - 1), 0).r == u_outlined; }
void main() {
  vec2 at = gl_FragCoord.xy;
  float share = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) share += shows(at + vec2(x, y) * u_line) ? 1.0 : 0.0;
  // Strongest where half of the neighbourhood shows the tissue.
  float edge = clamp(1.6 - abs(share - 12.5) / 12.5 * 1.8, 0.0, 1.0);
  if (share == 0.0 || share == 25.0) edge = 0.0;
  colour = vec4(vec3(1.0, 0.624, 0.18) * edge, edge);
}
)";

const char* const kGridVertex = R"(
uniform mat4 u_clip;
uniform vec3 u_middle;
uniform float u_reach;
out vec2 place;
void main() {
  place = vec2((gl_VertexID & 1) * 2 - 1, (gl_VertexID >> 1) * 2 - 1) * u_reach;
  gl_Position = u_clip * vec4(u_middle + vec3(place, 0.0), 1.0);
}
)";

const char* const kGridFragment = R"(
in vec2 place;
uniform vec2 u_offset;   // of the middle from the nearest line
uniform float u_reach, u_step, u_line;
layout(location = 0) out vec4 colour;
float line(vec2 at, float width) {
  vec2 slope = max(fwidth(at), vec2(1e-6));
  vec2 near = abs(fract(at - 0.5) - 0.5) / slope;
  vec2 strength = clamp(width * u_line - near + 0.5, 0.0, 1.0) * clamp(0.7 - slope * 2.0, 0.0, 1.0);
  return max(strength.x, strength.y);
}
void main() {
  vec2 at = (place + u_offset) / u_step;
  float fade = clamp(1.0 - length(place) / u_reach, 0.0, 1.0);
  float alpha = max(line(at, 0.6) * 0.16, line(at * 0.2, 0.7) * 0.20) * fade;
  colour = vec4(vec3(0.75, 0.79, 0.85) * alpha, alpha);
}
)";

glm::vec3 rgb(unsigned hex) { return glm::vec3(hex >> 16 & 255, hex >> 8 & 255, hex & 255) / 255.0f; }

void blend_premultiplied() {
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

}  // namespace

ComposePass::ComposePass()
    : background_("background", gl::kWholePicture, kBackground),
      grid_("grid", kGridVertex, kGridFragment),
      body_("body", gl::kWholePicture, kBody),
      outline_("outline", gl::kWholePicture, kOutline),
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

void ComposePass::grid(const Camera& camera, const glm::ivec2& size, const glm::dvec3& middle, double height, double reach, float line_scale) {
  constexpr double kStep = 100;  // mm
  const glm::dvec3 ground(middle.x, middle.y, height);
  const glm::dmat4 clip = clip_from_view(camera, double(size.x) / size.y, ground, reach * 1.5) * view_from_world(camera);
  glm::dmat4 moved = clip;  // the shader's coordinates count from the middle: floats are then exact enough
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

void ComposePass::outline(const GBuffer& buffer, Label label, const glm::ivec2& size, const PixelRect& rect, float line_scale) {
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
