// SPDX-License-Identifier: AGPL-3.0-or-later
// Projects world points to pixels of a view and back, for the 3D view and for slices. Pixels are those of the window;
// lengths are mm. A slice is a parallel projection along its normal.
#pragma once

#include <optional>

#include "editor/context/view_place.h"
#include "render/view.h"

namespace limber::editor {

struct Context;

struct ViewProjection {
  ViewProjection(const Context& context, const ViewPlace& place);

  std::optional<glm::dvec2> pixel_of(const glm::dvec3& point) const;  // returns no value for a point behind the eye
  render::Ray ray(const glm::dvec2& pixel) const;
  glm::dvec3 direction_to_eye(const glm::dvec3& point) const;  // returns a unit vector
  // Returns the size of a pixel at the depth of the point, measured across the line of sight.
  double millimetres_per_pixel(const glm::dvec3& point) const;

  // Returns true if the view shows the point: always in the 3D view, and in a slice if the point lies within 20 mm of
  // the slice's plane.
  bool shows(const glm::dvec3& point) const;

  // Returns the point where the pixel's line of sight meets the plane through `point` with normal `normal`. Returns no
  // value if the line of sight misses the plane.
  std::optional<glm::dvec3> in_plane(const glm::dvec2& pixel, const glm::dvec3& point, const glm::dvec3& normal) const;
  // Finds the point of a line that is nearest to the pixel's line of sight. The line runs through `point` along the
  // unit vector `direction`. Returns the found point's signed distance from `point` along the line, mm. Returns no
  // value if the line and the line of sight are parallel.
  std::optional<double> along_line(const glm::dvec2& pixel, const glm::dvec3& point, const glm::dvec3& direction) const;

  ViewPlace place;
  render::Camera camera;              // camera of the 3D view; unused in a slice
  render::SliceCamera slice;          // camera of a slice; unused in the 3D view
  glm::dvec3 right, up, towards_eye;  // the picture's axes in the world, unit vectors
};

// Returns the projection of the 3D view. Returns no value when the 3D view is not shown.
std::optional<ViewProjection> body_seen(const Context& context);

}  // namespace limber::editor
