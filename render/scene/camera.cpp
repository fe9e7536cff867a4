// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber::render {

namespace {

constexpr double kPi = std::numbers::pi;
// The distance from the eye to the centre is clamped to this range, mm.
constexpr double kNearest = 1e-2, kFarthest = 1e6;
// Rotation per pixel of mouse motion, radians: 0.4 degrees, as in Blender's turntable.
constexpr double kOrbitPerPixel = kPi / 450;

glm::dquat from_columns(const glm::dvec3& right, const glm::dvec3& up) {
  return glm::normalize(glm::quat_cast(glm::dmat3(right, up, glm::cross(right, up))));
}

// Returns half the height of the region that the picture shows at the depth of the camera's centre, mm.
double half_height(const Camera& camera) { return camera.distance * std::tan(camera.field_of_view / 2); }

}  // namespace

Camera looking_from(StandardView side, const Camera& camera) {
  Camera result = camera;
  const glm::dvec3 up(0, 0, 1);
  switch (side) {
    case StandardView::Front: result.world_from_view = from_columns({1, 0, 0}, up); break;
    case StandardView::Back: result.world_from_view = from_columns({-1, 0, 0}, up); break;
    case StandardView::Left: result.world_from_view = from_columns({0, 1, 0}, up); break;
    case StandardView::Right: result.world_from_view = from_columns({0, -1, 0}, up); break;
    case StandardView::Top: result.world_from_view = from_columns({1, 0, 0}, {0, 1, 0}); break;
    case StandardView::Bottom: result.world_from_view = from_columns({1, 0, 0}, {0, -1, 0}); break;
  }
  return result;
}

Camera framing(const Camera& camera, const glm::dvec3& low, const glm::dvec3& high, double aspect) {
  Camera result = camera;
  result.centre = (low + high) / 2.0;
  const double tan_y = std::tan(camera.field_of_view / 2), tan_x = tan_y * aspect;
  const glm::dquat view_from_world = glm::conjugate(camera.world_from_view);

  // Finds the smallest distance from the centre at which every corner of the box is within the picture.
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 world(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    const glm::dvec3 view = view_from_world * (world - result.centre);
    const double towards = camera.projection == Projection::Perspective ? view.z : 0;
    distance = std::max({distance, towards + std::abs(view.x) / tan_x, towards + std::abs(view.y) / tan_y});
  }
  constexpr double kMargin = 1.06;
  result.distance = std::clamp(distance * kMargin, kNearest, kFarthest);
  return result;
}

glm::dvec3 eye_of(const Camera& camera) {
  return camera.centre + camera.world_from_view * glm::dvec3(0, 0, camera.distance);
}

glm::dmat4 view_from_world(const Camera& camera) {
  const glm::dmat3 rotation = glm::mat3_cast(glm::conjugate(camera.world_from_view));
  glm::dmat4 view(rotation);
  view[3] = glm::dvec4(-(rotation * eye_of(camera)), 1);
  return view;
}

glm::dmat4 clip_from_view(const Camera& camera, double aspect, const glm::dvec3& middle, double radius) {
  const double depth = -(view_from_world(camera) * glm::dvec4(middle, 1)).z;
  const bool perspective = camera.projection == Projection::Perspective;
  const double reach = std::max(depth + radius, 1e-3) * 1.001;
  // The near plane is at least a ten-thousandth of the far plane's depth away. 24 bits of depth are then precise enough
  // everywhere.
  const double nearest = perspective ? std::max(depth - radius * 1.001, reach * 1e-4) : depth - radius * 1.001;
  glm::dmat4 clip(0);
  const double height = perspective ? std::tan(camera.field_of_view / 2) : half_height(camera);
  clip[0][0] = 1 / (height * aspect);
  clip[1][1] = 1 / height;
  const double span = std::max(reach - nearest, 1e-6);
  if (perspective) {
    clip[2][2] = -(reach + nearest) / span;
    clip[2][3] = -1;
    clip[3][2] = -2 * reach * nearest / span;
  } else {
    clip[2][2] = -2 / span;
    clip[3][2] = -(reach + nearest) / span;
    clip[3][3] = 1;
  }
  return clip;
}

Ray ray_through(const Camera& camera, const glm::dvec2& pixel, const glm::ivec2& size) {
  const double aspect = double(size.x) / size.y;
  const glm::dvec2 ndc(2 * pixel.x / size.x - 1, 1 - 2 * pixel.y / size.y);
  const glm::dvec3 eye = eye_of(camera);
  if (camera.projection == Projection::Orthographic) {
    const double height = half_height(camera);
    return {eye + camera.world_from_view * glm::dvec3(ndc.x * height * aspect, ndc.y * height, 0),
            camera.world_from_view * glm::dvec3(0, 0, -1)};
  }
  const double tan_y = std::tan(camera.field_of_view / 2);
  return {eye, glm::normalize(camera.world_from_view * glm::dvec3(ndc.x * tan_y * aspect, ndc.y * tan_y, -1))};
}

bool project(const Camera& camera, const glm::dvec3& point, const glm::ivec2& size, glm::dvec2& pixel) {
  const glm::dvec3 view = glm::dvec3(view_from_world(camera) * glm::dvec4(point, 1));
  const bool perspective = camera.projection == Projection::Perspective;
  if (perspective && view.z > -1e-9) return false;
  const double height = perspective ? -view.z * std::tan(camera.field_of_view / 2) : half_height(camera);
  const double scale = size.y / (2 * height);
  pixel = {size.x / 2.0 + view.x * scale, size.y / 2.0 - view.y * scale};
  return true;
}

Camera orbited(const Camera& camera, const glm::dvec2& pixels) {
  Camera result = camera;
  const glm::dquat about_z = glm::angleAxis(-pixels.x * kOrbitPerPixel, glm::dvec3(0, 0, 1));
  const glm::dquat about_x = glm::angleAxis(-pixels.y * kOrbitPerPixel, camera.world_from_view * glm::dvec3(1, 0, 0));
  result.world_from_view = glm::normalize(about_z * about_x * camera.world_from_view);
  return result;
}

Camera panned(const Camera& camera, const glm::dvec2& pixels, const glm::ivec2& size) {
  Camera result = camera;
  const double millimetres_per_pixel = 2 * half_height(camera) / size.y;
  result.centre +=
      camera.world_from_view * glm::dvec3(-pixels.x * millimetres_per_pixel, pixels.y * millimetres_per_pixel, 0);
  return result;
}

Camera zoomed(const Camera& camera, double factor) {
  Camera result = camera;
  result.distance = std::clamp(camera.distance * factor, kNearest, kFarthest);
  return result;
}

Camera zoomed(const Camera& camera, double factor, const glm::dvec2& pixel, const glm::ivec2& size) {
  Camera result = zoomed(camera, factor);
  const double nearer = 1 - result.distance / camera.distance, millimetres_per_pixel = 2 * half_height(camera) / size.y;
  const glm::dvec2 from_middle = (pixel - glm::dvec2(size) * 0.5) * millimetres_per_pixel;
  result.centre += camera.world_from_view * glm::dvec3(from_middle.x, -from_middle.y, 0) * nearer;
  return result;
}

Camera looked_round(const Camera& camera, const glm::dvec2& pixels) {
  Camera result = orbited(camera, pixels);
  result.centre = eye_of(camera) - result.world_from_view * glm::dvec3(0, 0, camera.distance);
  return result;
}

}  // namespace limber::render
