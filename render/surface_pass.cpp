// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/surface_pass.h"

#include <epoxy/gl.h>

namespace limber::render {

namespace {

const char* const kVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint label;
layout(location = 3) in vec3 rest;
uniform mat4 u_clip;
uniform vec4 u_depth;
uniform mat3 u_view;
out float depth;
out vec3 view_normal, rest_place;
flat out uint tissue;
void main() {
  rest_place = rest;
  gl_Position = u_clip * vec4(place, 1.0);
  depth = dot(u_depth.xyz, place) + u_depth.w;
  view_normal = u_view * normal;
  tissue = label;
}
)";

const char* const kFragment = R"(
in float depth;
in vec3 view_normal, rest_place;
flat in uint tissue;
uniform mat4 u_padded;
uniform float u_places;  // a padded voxel
layout(location = 0) out float out_depth;
layout(location = 1) out vec4 out_normal;
layout(location = 2) out uint out_label;
layout(location = 3) out uvec4 out_place;
void main() {
  vec3 n = normalize(view_normal);
  n.z = abs(n.z);  // in a fold the inside may be seen
  out_depth = depth;
  out_normal = vec4(n * 0.5 + 0.5, 1.0 / 3.0);
  out_label = tissue;
  out_place = uvec4(uvec3(clamp((u_padded * vec4(rest_place, 1.0)).xyz * u_places, vec3(0.0), vec3(65535.0))), 1u);
}
)";

template <class Value>
void fill(GLenum target, const gl::Buffer& buffer, const std::vector<Value>& values, GLenum use) {
  glBindBuffer(target, buffer.name());
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(Value)), values.data(), use);
}

}  // namespace

SurfacePass::SurfacePass()
    : program_("surface", kVertex, kFragment), array_(gl::VertexArray::create()), places_(gl::Buffer::create()), normals_(gl::Buffer::create()),
      labels_(gl::Buffer::create()), rest_(gl::Buffer::create()), corners_(gl::Buffer::create()) {}

void SurfacePass::upload(const std::shared_ptr<const PosedSurface>& surface) {
  if (uploaded_ == surface) return;
  glBindVertexArray(array_.name());
  fill(GL_ARRAY_BUFFER, places_, surface->V, GL_STREAM_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  fill(GL_ARRAY_BUFFER, normals_, surface->N, GL_STREAM_DRAW);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  if (!uploaded_ || uploaded_->at_rest != surface->at_rest) {
    fill(GL_ARRAY_BUFFER, labels_, surface->at_rest->label, GL_STATIC_DRAW);
    glEnableVertexAttribArray(2);
    glVertexAttribIPointer(2, 1, GL_UNSIGNED_SHORT, 0, nullptr);
    const std::vector<glm::vec3> rest(surface->at_rest->V.begin(), surface->at_rest->V.end());
    fill(GL_ARRAY_BUFFER, rest_, rest, GL_STATIC_DRAW);
    glEnableVertexAttribArray(3);
    glVertexAttribPointer(3, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    fill(GL_ELEMENT_ARRAY_BUFFER, corners_, surface->at_rest->F, GL_STATIC_DRAW);
  }
  glBindVertexArray(0);
  uploaded_ = surface;
  gl::check_gl("the upload of a surface");
}

void SurfacePass::draw(const std::shared_ptr<const PosedSurface>& surface, const VolumeTexture& volume, const ViewRays& rays, const glm::dmat3& view_from_world, const GBuffer& buffer) {
  upload(surface);
  glBindFramebuffer(GL_FRAMEBUFFER, buffer.march_target.name());
  glViewport(0, 0, buffer.size().x, buffer.size().y);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  const float far = 1, depth[4] = {kNothingDepth, 0, 0, 0}, normal[4] = {0, 0, 0, 0};
  const GLuint label[4] = {0, 0, 0, 0};
  glClearBufferfv(GL_DEPTH, 0, &far);
  glClearBufferfv(GL_COLOR, 0, depth);
  glClearBufferfv(GL_COLOR, 1, normal);
  glClearBufferuiv(GL_COLOR, 2, label);
  if (buffer.place) glClearBufferuiv(GL_COLOR, 3, label);
  program_.use();
  program_.set("u_clip", glm::mat4(rays.clip_from_padded * rays.padded_from_world));
  program_.set("u_depth", glm::vec4(rays.depth_of_padded * rays.padded_from_world));
  program_.set("u_view", glm::mat3(view_from_world));
  program_.set("u_padded", glm::mat4(rays.padded_from_world));
  program_.set("u_places", 1.0f / place_step(volume));
  glBindVertexArray(array_.name());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(surface->at_rest->F.size() * 3), GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
}

}  // namespace limber::render
