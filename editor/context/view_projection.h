// SPDX-License-Identifier: AGPL-3.0-or-later
// A view of the window as a camera, 3D or a slice: where a point of the world is seen, and what lies under a pixel.
// Pixels are the window's; a slice looks along its normal, everything in it at one scale.
#pragma once

#include <optional>

#include "editor/context/layout.h"
#include "render/view.h"

namespace limber::editor {

struct Editor;

struct ViewProjection {
  ViewProjection(const Editor& editor, const ViewPlace& place);

  std::optional<glm::dvec2> pixel_of(const glm::dvec3& point) const;  // nothing behind the eye
  render::Ray ray(const glm::dvec2& pixel) const;
  glm::dvec3 direction_to_eye(const glm::dvec3& point) const;   // unit
  double millimetres_per_pixel(const glm::dvec3& point) const;  // across the line of sight

  // All of the world in 3D; in a slice what lies within 20 mm of it.
  bool shows(const glm::dvec3& point) const;

  // The point under the pixel in the plane through `point` with that normal; nothing where the line of sight misses it.
  std::optional<glm::dvec3> in_plane(const glm::dvec2& pixel, const glm::dvec3& point, const glm::dvec3& normal) const;
  // How far along the line through `point` (unit direction) it comes nearest to what is under the pixel; nothing where
  // the line is seen end on.
  std::optional<double> along_line(const glm::dvec2& pixel, const glm::dvec3& point, const glm::dvec3& direction) const;

  ViewPlace place;
  render::Camera camera;              // of the 3D view
  render::SliceCamera slice;          // of the others
  glm::dvec3 right, up, towards_eye;  // of the picture; unit
};

// The 3D view; nothing when it is not shown.
std::optional<ViewProjection> body_seen(const Editor& editor);

}  // namespace limber::editor
