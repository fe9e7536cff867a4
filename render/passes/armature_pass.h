// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws bones over the body as octahedra, cylinders or sticks with joints. Their edges are antialiased and have the
// same width in pixels at any distance (times the scene's line scale). Portions of bones behind the body's surface are
// drawn at 45 % opacity, unless the scene asks for bones in front of the body.
#pragma once

#include <optional>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

namespace limber::render {

class ArmaturePass {
 public:
  ArmaturePass();

  // Draws the bones into the bound framebuffer of `size` pixels.
  //   body_depth  depth of the body in mm from the eye along the viewing direction, at any resolution; nullptr: the
  //               body hides no bones
  void draw(const Scene& scene, const Camera& camera, const glm::ivec2& size, const gl::Texture* body_depth);

 private:
  gl::Program program_;
  gl::VertexArray array_;
  gl::Buffer vertices_;
};

// Returns the bones whose drawn shapes are within a few pixels of `pixel`, in the rig's order. Pixels are counted from
// the top left corner.
std::vector<BoneHit> bones_at(const Scene& scene, const Camera& camera, const glm::ivec2& size,
                              const glm::dvec2& pixel);
// Returns the bone of bones_at() whose axis is nearest to the pixel, relative to the bone's drawn width; nothing if
// there is no bone.
std::optional<int> bone_at(const Scene& scene, const Camera& camera, const glm::ivec2& size, const glm::dvec2& pixel);

}  // namespace limber::render
