// SPDX-License-Identifier: AGPL-3.0-or-later
// Bones over the body: octahedra, cylinders or sticks with joints, smooth edges of even width in pixels (by the scene's
// scale of lines) whatever the distance. What lies behind the body's surface shows at 45 %, unless bones are drawn in
// front.
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

  // Into the framebuffer that is bound, of `size` pixels.
  //   body_depth  mm before the eye along the direction of view, of any resolution; nullptr: nothing hides bones
  void draw(const Scene& scene, const Camera& camera, const glm::ivec2& size, const gl::Texture* body_depth);

 private:
  gl::Program program_;
  gl::VertexArray array_;
  gl::Buffer vertices_;
};

// The bones whose drawn shapes lie within a few pixels of the pixel (from the top left corner), in their order.
std::vector<BoneHit> bones_at(const Scene& scene, const Camera& camera, const glm::ivec2& size,
                              const glm::dvec2& pixel);
// Of them the one that is meant: the least beside it.
std::optional<int> bone_at(const Scene& scene, const Camera& camera, const glm::ivec2& size, const glm::dvec2& pixel);

}  // namespace limber::render
