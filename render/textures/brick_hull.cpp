// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/brick_hull.h"

#include <epoxy/gl.h>

namespace limber::render {

Hull::Hull() : corners_(gl::Buffer::create()), indices_(gl::Buffer::create()), array_(gl::VertexArray::create()) {}

void Hull::upload(const Faces& faces, double scale, const glm::dvec3& offset) {
  faces_ = static_cast<std::int64_t>(faces.indices.size()) / 6;
  padded_from_corner_ = glm::dmat4(scale);
  padded_from_corner_[3] = glm::dvec4(offset, 1);
  glm::u16vec4 low(65535), high(0);
  for (const glm::u16vec4& corner : faces.corners) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  low_ = high_ = glm::vec3(offset);
  if (faces_ > 0) {
    low_ += glm::vec3(low) * static_cast<float>(scale);
    high_ += glm::vec3(high) * static_cast<float>(scale);
  }

  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, corners_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(faces.corners.size() * sizeof(glm::u16vec4)),
               faces.corners.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.name());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(faces.indices.size() * sizeof(std::uint32_t)),
               faces.indices.data(), GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_UNSIGNED_SHORT, GL_FALSE, sizeof(glm::u16vec4), nullptr);
  glBindVertexArray(0);
}

void Hull::draw() const {
  glBindVertexArray(array_.name());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(faces_ * 6), GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
}

}  // namespace limber::render
