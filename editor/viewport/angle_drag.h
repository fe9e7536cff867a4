// SPDX-License-Identifier: AGPL-3.0-or-later
// The pointer going round a point: by how much it turned about an axis, as a ring or as the point is seen.
#pragma once

#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

class AngleDrag {
 public:
  static constexpr double kRing = 86;  // pixels at scale 1

  // `on_ring`: measured round the ring as it is seen, not round the point.
  AngleDrag(const ViewProjection& view, float scale, const glm::dvec3& pivot, bool on_ring);

  // Another axis from now on; what was swept as the point is seen stays.
  void about(const glm::dvec3& axis, const glm::dvec2& start, const glm::dvec2& pointer);
  void leave_ring() { on_ring_ = false; }
  void follow(const glm::dvec2& from, const glm::dvec2& to);
  double degrees() const;

  const Ring& ring() const { return ring_; }
  double start() const { return start_; }  // on the ring, radians
  bool on_ring() const { return on_ring_; }
  // Sector, ring, both lines and the handle, turned by so many degrees.
  void draw(const GizmoPainter& painter, const Theme& theme, double degrees) const;

 private:
  ViewProjection view_;
  float scale_;
  bool on_ring_;
  Ring ring_;
  glm::dvec2 centre_{0};
  double start_ = 0;
  std::optional<double> last_;
  double swept_seen_ = 0, swept_ring_ = 0;  // radians
};

}  // namespace limber::editor
