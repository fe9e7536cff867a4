// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the rays of a picture in a volume's padded coordinates (brick_atlas.h), as the shaders need them. The ray
// through the point `ndc` of the picture (from -1 to 1) is
//   (base + ndc.x base_x + ndc.y base_y) + z (toward + ndc.x toward_x + ndc.y toward_y)
// where z is the depth from the eye along the viewing direction, mm.
#pragma once

#include <glm/glm.hpp>

#include "core/volume/grid.h"
#include "render/gl/program.h"
#include "render/scene/camera.h"
#include "render/textures/brick_atlas.h"

namespace limber::render {

struct ViewRays {
  glm::dvec3 base, base_x, base_y, toward, toward_x, toward_y;
  glm::dmat4 clip_from_padded;
  glm::dmat3 view_from_gradient;  // converts a gradient in padded coordinates to a vector in view axes (not normalized)
  glm::dvec4 depth_of_padded;     // the point `padded` has the depth dot(xyz, padded) + w, mm
  // Position of the eye in padded coordinates; for an orthographic camera, the viewing direction.
  glm::dvec3 eye;
  // Converts a clip plane to padded coordinates: points p with dot(xyz, p) <= w stay visible.
  glm::dvec4 padded_from_clip_plane(const glm::dvec3& point, const glm::dvec3& normal) const;
  glm::dmat4 padded_from_world;
  double nearest = 0;  // depth of the near plane, mm
  bool perspective = true;
  // Offset, in voxels, that is added to positions before labels are read. Each of the averaged pictures has another
  // offset, so that the average blends the borders between labels.
  glm::vec3 label_shift{0};
  // True: the gradient is computed from the four corners of the mirrored tetrahedron. Averaged pictures alternate
  // between the mirrored and the unmirrored tetrahedron.
  bool mirrored_taps = false;
  bool smooth_cuts = false;  // true: borders between labels on cut faces are smooth
};

// Computes the rays of a picture of `size` pixels.
//   jitter     shift of the picture relative to the pixel grid, pixels
//   low, high  corners of a box in padded coordinates; the camera's depth range covers this box
ViewRays view_rays(const Camera& camera, const Grid& grid, const glm::ivec2& size, const glm::dvec2& jitter,
                   const glm::vec3& low, const glm::vec3& high);

// Returns the matrix that converts directions in view axes to padded coordinates, scaled so that a unit vector becomes
// at most one brick (4 voxels) long, for any voxel spacing.
glm::mat3 padded_from_view(const ViewRays& rays);

// Sets the uniforms that shaders/rays.glsl declares.
void set_rays(gl::Program& program, const ViewRays& rays);

}  // namespace limber::render
