// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/view_projection.h"

#include <cmath>

#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"

namespace limber::editor {

ViewProjection::ViewProjection(const Context& context, const ViewPlace& at)
    : place(at),
      camera(context.views->body.camera) {
  if (place.id == ViewId::Body) {
    right = camera.world_from_view * glm::dvec3(1, 0, 0);
    up = camera.world_from_view * glm::dvec3(0, 1, 0);
  } else {
    slice = context.views->slices[static_cast<std::size_t>(axis_of(place.id))].camera;
    const render::SliceFrame frame = render::frame_of(slice.axis);
    right = frame.right;
    up = -frame.down;
  }
  towards_eye = glm::cross(right, up);
}

std::optional<glm::dvec2> ViewProjection::pixel_of(const glm::dvec3& point) const {
  const glm::dvec2 corner(place.rect.low);
  if (place.id != ViewId::Body) {
    const glm::dvec3 offset = (point - slice.centre) / slice.millimetres_per_pixel;
    return corner + glm::dvec2(place.rect.size()) * 0.5 + glm::dvec2(glm::dot(offset, right), -glm::dot(offset, up));
  }
  glm::dvec2 pixel;
  if (!render::project(camera, point, glm::ivec2(place.rect.size()), pixel)) return std::nullopt;
  return corner + pixel;
}

bool ViewProjection::shows(const glm::dvec3& point) const {
  constexpr double kDepth = 20;  // points farther than this from the slice's plane are not shown, mm
  return place.id == ViewId::Body || std::abs(glm::dot(point - slice.centre, towards_eye)) <= kDepth;
}

render::Ray ViewProjection::ray(const glm::dvec2& pixel) const {
  const glm::dvec2 inside = pixel - glm::dvec2(place.rect.low);
  if (place.id == ViewId::Body) return render::ray_through(camera, inside, glm::ivec2(place.rect.size()));
  const glm::dvec2 off = (inside - glm::dvec2(place.rect.size()) * 0.5) * slice.millimetres_per_pixel;
  return {slice.centre + right * off.x - up * off.y, -towards_eye};
}

glm::dvec3 ViewProjection::direction_to_eye(const glm::dvec3& point) const {
  if (place.id != ViewId::Body || camera.projection == render::Projection::Orthographic) return towards_eye;
  return glm::normalize(render::eye_of(camera) - point);
}

double ViewProjection::millimetres_per_pixel(const glm::dvec3& point) const {
  if (place.id != ViewId::Body) return slice.millimetres_per_pixel;
  const double depth = camera.projection == render::Projection::Orthographic
                           ? camera.distance
                           : glm::dot(render::eye_of(camera) - point, towards_eye);
  return 2 * depth * std::tan(camera.field_of_view / 2) / std::floor(place.rect.height());
}

std::optional<glm::dvec3> ViewProjection::in_plane(const glm::dvec2& pixel, const glm::dvec3& point,
                                                   const glm::dvec3& normal) const {
  const render::Ray sight = ray(pixel);
  const double steep = glm::dot(sight.direction, normal);
  if (std::abs(steep) < 1e-9) return std::nullopt;
  const double far = glm::dot(point - sight.origin, normal) / steep;
  const bool parallel = place.id != ViewId::Body || camera.projection == render::Projection::Orthographic;
  if (!parallel && far <= 0) return std::nullopt;
  return sight.origin + far * sight.direction;
}

std::optional<double> ViewProjection::along_line(const glm::dvec2& pixel, const glm::dvec3& point,
                                                 const glm::dvec3& direction) const {
  const render::Ray sight = ray(pixel);
  const glm::dvec3 off = point - sight.origin;
  const double b = glm::dot(direction, sight.direction), d = glm::dot(direction, off),
               e = glm::dot(sight.direction, off), denominator = 1 - b * b;
  if (denominator < 1e-6) return std::nullopt;
  return (b * e - d) / denominator;
}

std::optional<ViewProjection> body_seen(const Context& context) {
  const Rect* rect = context.screen->layout.place_of(ViewId::Body);
  if (!rect) return std::nullopt;
  return ViewProjection(context, {ViewId::Body, *rect});
}

}  // namespace limber::editor
