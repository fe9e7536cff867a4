// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/line_pass.h"

#include <limits>

#include <epoxy/gl.h>

namespace limber::render {

namespace {}  // namespace

std::vector<Segment> lines_on_cuts(const CutMesh& mesh, const Clip& clip, const Grid& grid) {
  struct Plane {
    glm::dvec3 point, normal;  // a point of the plane; its normal, which points to the side that is cut away
  };
  std::vector<Plane> planes;
  if (clip.plane) planes.push_back({(*clip.plane)[0], (*clip.plane)[1]});
  if (clip.box) {
    const AffineTransform world = world_from_voxel(grid);
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1})
        planes.push_back({world * (*clip.box)[side], (side ? 1.0 : -1.0) * glm::dvec3(grid.direction[axis])});
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

LinePass::LinePass()
    : program_("line.vert", "line.frag"),
      array_(gl::VertexArray::create()),
      ends_(gl::Buffer::create()) {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, ends_.name());
  for (const GLuint end : {0u, 1u}) {
    glEnableVertexAttribArray(end);
    glVertexAttribPointer(end, 3, GL_FLOAT, GL_FALSE, 2 * sizeof(glm::vec3),
                          reinterpret_cast<const void*>(end * sizeof(glm::vec3)));
    glVertexAttribDivisor(end, 1);
  }
  glBindVertexArray(0);
}

void LinePass::draw(const std::vector<Segment>& lines, const Camera& camera, const glm::ivec2& size,
                    const gl::Texture& body_depth, float off, const Ink& ink) {
  const glm::dmat4 clip =
      clip_from_view(camera, double(size.x) / size.y, camera.centre, camera.distance) * view_from_world(camera);
  draw(lines, View{clip, eye_of(camera), camera.world_from_view * glm::dvec3(0, 0, -1)}, size, &body_depth, off, ink);
}

void LinePass::draw(const std::vector<Segment>& lines, const SliceCamera& camera, const glm::ivec2& size,
                    const Ink& ink) {
  const SliceFrame frame = frame_of(camera.axis);
  glm::dmat4 clip(1);
  const glm::dvec3 rows[3] = {frame.right * (2 / (camera.millimetres_per_pixel * size.x)),
                              -frame.down * (2 / (camera.millimetres_per_pixel * size.y)), glm::dvec3(0)};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) clip[column][row] = rows[row][column];
    clip[3][row] = -glm::dot(rows[row], camera.centre);
  }
  draw(lines, View{clip, camera.centre, frame.normal}, size, nullptr, 0, ink);
}

void LinePass::draw(const std::vector<Segment>& lines, const View& view, const glm::ivec2& size,
                    const gl::Texture* body_depth, float off, const Ink& ink) {
  if (lines.empty()) return;
  // Coordinates are relative to the eye, so that floats are precise enough.
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
