// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/brush_cursor.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "editor/context/views.h"
#include "editor/skin/painting.h"

namespace limber::editor {

namespace {

// The surface is searched along the normal in at most this many steps over the brush's radius.
constexpr int kMostSteps = 96;
constexpr int kHalvings = 4;  // number of bisections that refine where the last step crossed the surface
// Number of neighbours on either side of a ring point whose heights above the tangent plane are averaged with the
// point's own height. The average smooths the ring, because a surface of voxels has steps.
constexpr int kSmoothed = 2;

// The visible part of the body: the voxels of visible tissues inside the clip plane and the clip box.
class SeenBody {
 public:
  explicit SeenBody(const render::Scene& scene) : scene_(scene), to_voxel_(voxel_from_world(scene.volume->grid)) {}

  bool holds(const glm::dvec3& point) const {
    if (scene_.clip.plane && glm::dot(point - (*scene_.clip.plane)[0], (*scene_.clip.plane)[1]) > 0) return false;
    const auto voxel =
        scene_.pose ? voxel_shown_at(scene_, point) : std::optional(glm::ivec3(glm::floor(to_voxel_ * point + 0.5)));
    if (!voxel) return false;
    const Label label = scene_.volume->at_or_air(*voxel);
    if (label == 0 || (scene_.looks && (label >= scene_.looks->size() || !(*scene_.looks)[label].visible)))
      return false;
    if (!scene_.clip.box) return true;
    const glm::dvec3 at = scene_.pose ? glm::dvec3(*voxel) : to_voxel_ * point;
    return glm::all(glm::greaterThanEqual(at, (*scene_.clip.box)[0])) &&
           glm::all(glm::lessThanEqual(at, (*scene_.clip.box)[1]));
  }

 private:
  const render::Scene& scene_;
  AffineTransform to_voxel_;
};

// Searches for the body's surface along `up` in steps of `step` mm. If `point` is inside the body the search goes
// upwards, otherwise downwards. Returns the height of the surface above `point`, mm (negative: below it). Returns
// nothing if the surface is farther away than `most` mm.
std::optional<double> height_of(const SeenBody& body, const glm::dvec3& point, const glm::dvec3& up, double most,
                                double step) {
  const bool inside = body.holds(point);
  const double way = inside ? 1 : -1;
  for (double height = step; height <= most; height += step) {
    if (body.holds(point + way * height * up) == inside) continue;
    double near = height - step, far = height;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (near + far) / 2;
      (body.holds(point + way * middle * up) == inside ? near : far) = middle;
    }
    return way * (near + far) / 2;
  }
  return std::nullopt;
}

}  // namespace

std::vector<RingPoint> ring_on_body(const Views& views, const BrushPlace& place, double radius, int count) {
  const render::Scene& scene = views.scene;
  const std::optional<SeenBody> body = scene.volume ? std::optional<SeenBody>(scene) : std::nullopt;
  const glm::dvec3 up = glm::normalize(place.normal),
                   along =
                       glm::normalize(glm::cross(up, std::abs(up.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0))),
                   across = glm::cross(up, along);
  std::vector<RingPoint> ring(static_cast<std::size_t>(count));
  std::vector<std::optional<double>> heights(ring.size());
  const glm::dvec3 spacing = scene.volume ? scene.volume->grid.spacing : glm::dvec3(1);
  const double step = std::max(std::min({spacing.x, spacing.y, spacing.z}) / 2, radius / kMostSteps);
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    ring[static_cast<std::size_t>(i)].at = place.seen + radius * (std::cos(angle) * along + std::sin(angle) * across);
    if (body)
      heights[static_cast<std::size_t>(i)] = height_of(*body, ring[static_cast<std::size_t>(i)].at, up, radius, step);
  }
  for (int i = 0; i < count; ++i) {
    if (!heights[static_cast<std::size_t>(i)]) continue;
    double sum = 0;
    int known = 0;
    for (int off = -kSmoothed; off <= kSmoothed; ++off)
      if (const auto& height = heights[static_cast<std::size_t>((i + off + count) % count)]) sum += *height, ++known;
    ring[static_cast<std::size_t>(i)].at += sum / known * up;
    ring[static_cast<std::size_t>(i)].on_body = true;
  }
  return ring;
}

}  // namespace limber::editor
