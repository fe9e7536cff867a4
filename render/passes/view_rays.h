// SPDX-License-Identifier: AGPL-3.0-or-later
// The rays of a picture in a volume's padded coordinates (brick_atlas.h), as the shaders want them: the ray through
// the picture's point `ndc` (-1 to 1) is  (base + ndc.x base_x + ndc.y base_y) + z (toward + ndc.x toward_x + ndc.y
// toward_y) where z is the depth before the eye in millimetres, along the direction of view.
#pragma once

#include <glm/glm.hpp>

#include "core/volume/grid.h"
#include "render/gl/program.h"
#include "render/scene/camera.h"

namespace limber::render {

struct ViewRays {
  glm::dvec3 base, base_x, base_y, toward, toward_x, toward_y;
  glm::dmat4 clip_from_padded;
  glm::dmat3 view_from_gradient;  // a gradient in padded coordinates as a vector of the view (not unit)
  glm::dvec4 depth_of_padded;     // z = dot(xyz, padded) + w
  glm::dvec3 eye;                 // padded; orthographic: the direction of view instead
  glm::dvec4 padded_from_clip_plane(const glm::dvec3& point,
                                    const glm::dvec3& normal) const;  // dot(xyz, p) <= w is kept
  glm::dmat4 padded_from_world;
  double nearest = 0;  // depth of the near plane
  bool perspective = true;
  glm::vec3 label_shift{
      0};  // voxels by which labels are read beside their place: averaged pictures blend their borders
  bool mirrored_taps = false;  // gradients by the other tetrahedron: averaged pictures use both
};

AffineTransform padded_from_world(const Grid& grid);

// `jitter` shifts the picture, in pixels. The depth range covers [low, high], padded.
ViewRays view_rays(const Camera& camera, const Grid& grid, const glm::ivec2& size, const glm::dvec2& jitter,
                   const glm::vec3& low, const glm::vec3& high);

// The uniforms of shaders/rays.glsl.
void set_rays(gl::Program& program, const ViewRays& rays);

}  // namespace limber::render
