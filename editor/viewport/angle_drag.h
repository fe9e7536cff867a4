// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures the angle by which the pointer turns about an axis during a drag. The angle is measured either in the plane
// of a ring around the axis, or on the screen around the pixel of the pivot (the point to turn about).
#pragma once

#include "editor/context/view_projection.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

struct Theme;

class AngleDrag {
 public:
  static constexpr double kRing = 86;  // radius of the ring, pixels at scale 1

  // Begins to measure a turn about the point `pivot`; about() then sets the axis.
  //   on_ring  true: the angle is measured in the plane of the ring; false: on the screen, around the pivot's pixel
  AngleDrag(const ViewProjection& view, float scale, const glm::dvec3& pivot, bool on_ring);

  // Sets the axis to turn about. During a drag, the axis may be changed: the angles measured so far are kept.
  void about(const glm::dvec3& axis, const glm::dvec2& start, const glm::dvec2& pointer);
  void leave_ring() { on_ring_ = false; }
  void follow(const glm::dvec2& from, const glm::dvec2& to);
  double degrees() const;

  const Ring& ring() const { return ring_; }
  double start() const { return start_; }  // angle on the ring at which the drag began, radians
  bool on_ring() const { return on_ring_; }
  // Draws a turn by the angle `degrees`: the ring, the sector from the start to the end of the turn with its two radii,
  // and a handle at the end of the turn.
  void draw(const GizmoPainter& painter, const Theme& theme, double degrees) const;

 private:
  ViewProjection view_;
  float scale_;
  bool on_ring_;
  Ring ring_;
  glm::dvec2 centre_{0};
  double start_ = 0;
  std::optional<double> last_;
  double swept_seen_ = 0, swept_ring_ = 0;  // angles measured on the screen and on the ring, radians
};

}  // namespace limber::editor
