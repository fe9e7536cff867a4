// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/line_pass.h"

#include <limits>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

const char* const kVertex = R"(
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
uniform mat4 u_clip;
uniform vec3 u_ahead;
uniform vec2 u_size;
uniform float u_reach;
out float depth, across;
void main() {
  vec4 a = u_clip * vec4(from, 1.0), b = u_clip * vec4(to, 1.0);
  vec2 first = a.xy / a.w * u_size * 0.5, last = b.xy / b.w * u_size * 0.5, along = last - first;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  bool end = (gl_VertexID & 1) == 1;
  across = (gl_VertexID < 2 ? -1.0 : 1.0) * (u_reach + 1.0);
  depth = dot(end ? to : from, u_ahead);
  vec2 pixel = (end ? last + 0.5 * along : first - 0.5 * along) + across * vec2(-along.y, along.x);
  gl_Position = a.w > 0.0 && b.w > 0.0 ? vec4(pixel / (u_size * 0.5), 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
)";

const char* const kFragment = R"(
in float depth, across;
uniform sampler2D u_depth;
uniform vec2 u_size;
uniform float u_reach, u_off;
uniform vec4 u_colour;
layout(location = 0) out vec4 colour;
void main() {
  if (u_off > 0.0 && abs(depth - textureLod(u_depth, gl_FragCoord.xy / u_size, 0.0).r) > u_off) discard;
  float alpha = u_colour.a * clamp(u_reach + 0.5 - abs(across), 0.0, 1.0);
  colour = vec4(u_colour.rgb * alpha, alpha);
}
)";

}  // namespace

std::vector<Segment> lines_on_cuts(const CutMesh& mesh, const Clip& clip, const Grid& grid) {
  struct Plane {
    glm::dvec3 point, normal;  // towards what is hidden
  };
  std::vector<Plane> planes;
  if (clip.plane) planes.push_back({(*clip.plane)[0], (*clip.plane)[1]});
  if (clip.box) {
    const AffineTransform world = world_from_voxel(grid);
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) planes.push_back({world * (*clip.box)[side], (side ? 1.0 : -1.0) * glm::dvec3(grid.direction[axis])});
  }
  std::vector<Segment> all;
  for (const Plane& cut : planes) {
    std::vector<Segment> lines = plane_cut(*mesh.V, *mesh.faces, cut.point, cut.normal);
    for (const Plane& other : planes)
      if (&other != &cut) keep_behind(lines, other.point, other.normal);
    all.insert(all.end(), lines.begin(), lines.end());
  }
  return all;
}

LinePass::LinePass() : program_("lines", kVertex, kFragment), array_(gl::VertexArray::create()), ends_(gl::Buffer::create()) {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, ends_.name());
  for (const GLuint end : {0u, 1u}) {
    glEnableVertexAttribArray(end);
    glVertexAttribPointer(end, 3, GL_FLOAT, GL_FALSE, 2 * sizeof(glm::vec3), reinterpret_cast<const void*>(end * sizeof(glm::vec3)));
    glVertexAttribDivisor(end, 1);
  }
  glBindVertexArray(0);
}

void LinePass::draw(const std::vector<Segment>& lines, const Camera& camera, const glm::ivec2& size, const gl::Texture& body_depth, float off, const Ink& ink) {
  const glm::dmat4 clip = clip_from_view(camera, double(size.x) / size.y, camera.centre, camera.distance) * view_from_world(camera);
  draw(lines, View{clip, eye_of(camera), camera.world_from_view * glm::dvec3(0, 0, -1)}, size, &body_depth, off, ink);
}

void LinePass::draw(const std::vector<Segment>& lines, const SliceCamera& camera, const glm::ivec2& size, const Ink& ink) {
  const SliceFrame frame = frame_of(camera.axis);
  glm::dmat4 clip(1);
  const glm::dvec3 rows[3] = {frame.right * (2 / (camera.millimetres_per_pixel * size.x)), -frame.down * (2 / (camera.millimetres_per_pixel * size.y)), glm::dvec3(0)};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) clip[column][row] = rows[row][column];
    clip[3][row] = -glm::dot(rows[row], camera.centre);
  }
  draw(lines, View{clip, camera.centre, frame.normal}, size, nullptr, 0, ink);
}

void LinePass::draw(const std::vector<Segment>& lines, const View& view, const glm::ivec2& size, const gl::Texture* body_depth, float off, const Ink& ink) {
  if (lines.empty()) return;
  // From the eye: floats are then exact enough.
  std::vector<glm::vec3> ends;
  ends.reserve(2 * lines.size());
  for (const Segment& line : lines)
    for (const glm::dvec3& end : line) ends.push_back(glm::vec3(end - view.eye));
  glm::dmat4 clip = view.clip_from_world;
  clip[3] = view.clip_from_world * glm::dvec4(view.eye, 1);
  glBindBuffer(GL_ARRAY_BUFFER, ends_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(ends.size() * sizeof(glm::vec3)), ends.data(), GL_STREAM_DRAW);
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  program_.use();
  program_.set("u_clip", glm::mat4(clip));
  program_.set("u_ahead", glm::vec3(view.ahead));
  program_.set("u_size", glm::vec2(size));
  program_.set("u_reach", ink.width / 2);
  program_.set("u_off", body_depth ? off : 0.0f);
  program_.set("u_colour", glm::vec4(ink.colour, ink.alpha));
  program_.set_texture("u_depth", 0, GL_TEXTURE_2D, body_depth ? body_depth->name() : 0);
  glBindVertexArray(array_.name());
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(lines.size()));
  glBindVertexArray(0);
}

}  // namespace limber::render
