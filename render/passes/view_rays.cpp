// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/view_rays.h"

#include <algorithm>
#include <cmath>

namespace limber::render {

ViewRays view_rays(const Camera& camera, const Grid& grid, const glm::ivec2& size, const glm::dvec2& jitter,
                   const glm::vec3& low, const glm::vec3& high) {
  ViewRays rays;
  const AffineTransform to_padded = padded_from_world(grid);
  const glm::dmat3 to_world = glm::inverse(to_padded.linear);
  rays.padded_from_world = glm::dmat4(to_padded.linear);
  rays.padded_from_world[3] = glm::dvec4(to_padded.offset, 1);
  rays.perspective = camera.projection == Projection::Perspective;

  const double aspect = double(size.x) / size.y;
  const double height = std::tan(camera.field_of_view / 2) * (rays.perspective ? 1 : camera.distance);
  const glm::dvec2 shift = 2.0 * jitter / glm::dvec2(size);
  const glm::dvec3 eye = to_padded * eye_of(camera);
  const auto direction = [&](const glm::dvec3& view) { return to_padded.linear * (camera.world_from_view * view); };
  const glm::dvec3 across = direction({height * aspect, 0, 0}), up = direction({0, height, 0}),
                   ahead = direction({0, 0, -1});
  const glm::dvec3 zero(0), shifted = shift.x * across + shift.y * up;
  rays.base = rays.perspective ? eye : eye + shifted;
  rays.base_x = rays.perspective ? zero : across;
  rays.base_y = rays.perspective ? zero : up;
  rays.toward = rays.perspective ? ahead + shifted : ahead;
  rays.toward_x = rays.perspective ? across : zero;
  rays.toward_y = rays.perspective ? up : zero;
  rays.eye = rays.perspective ? eye : ahead;

  glm::dmat4 padded_to_world(to_world);
  padded_to_world[3] = glm::dvec4(-(to_world * to_padded.offset), 1);
  const glm::dmat4 view = view_from_world(camera) * padded_to_world;
  const glm::dvec3 middle = glm::dvec3(low + high) / 2.0;
  const glm::dvec3 half = glm::dvec3(high - low) / 2.0;
  double radius = 0;  // radius of the sphere around the box, mm
  for (int corner = 0; corner < 4; ++corner)
    radius = std::max(radius, glm::length(to_world * glm::dvec3(half.x, corner & 1 ? half.y : -half.y,
                                                                corner & 2 ? half.z : -half.z)));
  const glm::dmat4 clip = clip_from_view(camera, aspect, glm::dvec3(padded_to_world * glm::dvec4(middle, 1)), radius);
  glm::dmat4 jittered(1);
  jittered[3] = glm::dvec4(-shift.x, -shift.y, 0, 1);
  rays.clip_from_padded = jittered * clip * view;
  rays.depth_of_padded = -glm::dvec4(view[0].z, view[1].z, view[2].z, view[3].z);
  rays.nearest = rays.perspective ? clip[3][2] / (clip[2][2] - 1) : (clip[3][2] + 1) / clip[2][2];
  rays.view_from_gradient = glm::mat3_cast(glm::conjugate(camera.world_from_view)) * glm::transpose(to_padded.linear);
  return rays;
}

glm::dvec4 ViewRays::padded_from_clip_plane(const glm::dvec3& point, const glm::dvec3& normal) const {
  const glm::dmat3 to_world = glm::inverse(glm::dmat3(padded_from_world));
  const glm::dvec3 padded_normal = glm::transpose(to_world) * normal;
  const glm::dvec3 padded_point(padded_from_world * glm::dvec4(point, 1));
  return glm::dvec4(padded_normal, glm::dot(padded_normal, padded_point));
}

glm::mat3 padded_from_view(const ViewRays& rays) {
  const glm::dmat3 to_padded = glm::transpose(rays.view_from_gradient);
  return to_padded *
         (kBrick / std::max({glm::length(to_padded[0]), glm::length(to_padded[1]), glm::length(to_padded[2])}));
}

void set_rays(gl::Program& program, const ViewRays& rays) {
  program.set("u_base", glm::vec3(rays.base));
  program.set("u_base_x", glm::vec3(rays.base_x));
  program.set("u_base_y", glm::vec3(rays.base_y));
  program.set("u_toward", glm::vec3(rays.toward));
  program.set("u_toward_x", glm::vec3(rays.toward_x));
  program.set("u_toward_y", glm::vec3(rays.toward_y));
}

}  // namespace limber::render
