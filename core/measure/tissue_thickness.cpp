// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/measure/tissue_thickness.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/measure/least_direction.h"
#include "core/measure/tissue_share.h"

namespace limber {

namespace {

constexpr int kDirections = 400;
constexpr double kStep = 0.25;  // step along a line, in shortest voxel edges
// The angle by which the search rotates the shortest line: kFirstTurn at first, then halved down to kLastTurn, radians.
constexpr double kFirstTurn = 0.08, kLastTurn = 0.005;

// Bundles of parallel lines through one point of a tissue.
class LinesThrough {
 public:
  LinesThrough(const LabelVolume& volume, const glm::dvec3& centre, Label label)
      : volume_(volume),
        to_voxel_(voxel_from_world(volume.grid)),
        centre_(centre),
        label_(label),
        voxel_(std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z})) {}

  // Returns the mean distances from the centre to the tissue's border in the given direction and in the opposite one,
  // mm. Lines that begin outside the tissue are ignored.
  //   most  a larger distance counts as this, mm
  std::array<double, 2> to_borders(const glm::dvec3& direction, double most) const {
    const glm::dvec3 other = std::abs(direction.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 a = glm::normalize(glm::cross(direction, other)), b = glm::cross(direction, a);
    std::array<double, 2> sum{0, 0};
    int count = 0;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const glm::dvec3 from = centre_ + voxel_ * (double(i) * a + double(j) * b);
        if ((i || j) && share(from) < kInside) continue;
        sum[0] += to_border(from, direction, most);
        sum[1] += to_border(from, -direction, most);
        ++count;
      }
    return {sum[0] / count, sum[1] / count};
  }
  double length(const glm::dvec3& direction, double most) const {
    const auto [ahead, behind] = to_borders(direction, most);
    return ahead + behind;
  }

 private:
  static constexpr double kInside = 0.5;

  double to_border(const glm::dvec3& from, const glm::dvec3& direction, double most) const {
    const double step = kStep * voxel_;
    double before = share(from);
    for (double way = step; way < most + step; way += step) {
      const double here = share(from + way * direction);
      if (here < kInside) return way - step * std::clamp((kInside - here) / std::max(before - here, 1e-9), 0.0, 1.0);
      before = here;
    }
    return most;
  }
  double share(const glm::dvec3& point) const {
    return tissue_share(volume_, to_voxel_ * point, [this](Label label) { return label == label_; });
  }

  const LabelVolume& volume_;
  AffineTransform to_voxel_;
  glm::dvec3 centre_;
  Label label_;
  double voxel_;  // shortest voxel edge, mm
};

}  // namespace

std::array<glm::dvec3, 2> thickness_line(const LabelVolume& volume, const glm::ivec3& voxel) {
  const Label label = volume.at_or_air(voxel);
  if (label == 0) throw Error("there is no tissue at this point", "measuring", "choose a point on the body");
  const glm::dvec3 centre = world_from_voxel(volume.grid) * glm::dvec3(voxel);
  const LinesThrough lines(volume, centre, label);
  const double longest = glm::length(glm::dvec3(volume.grid.size) * volume.grid.spacing);
  const LeastDirection found = least_direction(
      kDirections, kFirstTurn, kLastTurn,
      [&](const glm::dvec3& direction, double most) { return lines.length(direction, std::min(most, longest)); });
  const glm::dvec3 best = found.direction;
  const auto [ahead, behind] = lines.to_borders(best, std::min(found.length, longest));
  const std::array<glm::dvec3, 2> ends{centre - behind * best, centre + ahead * best};
  for (const glm::dvec3& end : ends) {
    const glm::dvec3 place = voxel_from_world(volume.grid) * end;
    if (glm::any(glm::lessThan(place, glm::dvec3(-0.25))) ||
        glm::any(glm::greaterThan(place, glm::dvec3(volume.grid.size) - 0.75)))
      throw Error("the tissue is cut off by the border of the volume", "measuring",
                  "choose a point further from where the body is cut off");
  }
  return ends;
}

}  // namespace limber
