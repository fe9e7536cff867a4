// SPDX-License-Identifier: AGPL-3.0-or-later
// The hull of a body: the outer faces of the bricks (or of the cubes of a posed body's inverse map) in which rays can
// hit the body. The hull is drawn first and gives each ray its start. Pixels that the hull does not cover cost no work.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "render/gl/object.h"

namespace limber::render {

class Hull {
 public:
  struct Faces {
    std::vector<glm::u16vec4> corners;   // corners of the faces, in whole bricks or cubes; the last component is 1
    std::vector<std::uint32_t> indices;  // two triangles per face, counter-clockwise when seen from outside
  };

  Hull();

  // Uploads the faces. Each corner c of a face lies at offset + scale * c, in coordinates of the padded grid
  // (brick_atlas.h).
  void upload(const Faces& faces, double scale, const glm::dvec3& offset);
  void draw() const;

  bool empty() const { return faces_ == 0; }
  std::int64_t face_count() const { return faces_; }
  const glm::vec3& low() const { return low_; }  // lowest corner of the hull's box, padded coordinates
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
