// SPDX-License-Identifier: AGPL-3.0-or-later
// The outer faces of the bricks in which rays can meet a body. They are drawn first: they give each pixel the place to
// start from, and pixels beside the body no work at all.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "render/gl/object.h"

namespace limber::render {

class Hull {
 public:
  struct Faces {
    std::vector<glm::u16vec4> corners;   // in bricks, the last 1
    std::vector<std::uint32_t> indices;  // two triangles a face, counter-clockwise from outside
  };

  Hull();

  // Padded coordinates (brick_atlas.h) of a corner: offset + scale corner.
  void upload(const Faces& faces, double scale, const glm::dvec3& offset);
  void draw() const;

  bool empty() const { return faces_ == 0; }
  std::int64_t face_count() const { return faces_; }
  const glm::vec3& low() const { return low_; }  // padded coordinates
  const glm::vec3& high() const { return high_; }
  const glm::dmat4& padded_from_corner() const { return padded_from_corner_; }

 private:
  gl::Buffer corners_, indices_;
  gl::VertexArray array_;
  std::int64_t faces_ = 0;
  glm::vec3 low_{0}, high_{0};
  glm::dmat4 padded_from_corner_{1};
};

}  // namespace limber::render
