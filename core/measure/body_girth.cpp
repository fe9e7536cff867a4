// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/measure/body_girth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/measure/least_direction.h"
#include "core/measure/measurement.h"
#include "core/measure/tissue_share.h"

namespace limber {

namespace {

constexpr double kBeside = 2;  // a point farther than this from tissue is refused, voxels
// The cells of a plane are made so large that the plane has at most about this many of them along each axis.
constexpr int kMostCells = 4096;
constexpr double kFine = 0.5;  // cell size for the tape that is returned, in shortest voxel edges
constexpr double kCoarse = 2;  // cell size while planes are compared, in shortest voxel edges
constexpr int kPlanes = 64;    // number of planes that are compared first
// The angle by which the search tilts the plane of least girth: kFirstTurn at first, then halved down to kLastTurn,
// radians.
constexpr double kFirstTurn = 0.12, kLastTurn = 0.01;

bool is_tissue(Label label) { return label != 0; }

// Returns the share of tissue around a point, smoothed over the width of two voxels. Thus a smooth surface has a smooth
// border although its voxels form stairs.
double smooth_share(const LabelVolume& volume, const glm::dvec3& voxel) {
  // Returns early if all voxels around are tissue or all are air, as is the case away from the surface.
  const glm::ivec3 nearest(glm::floor(voxel + 0.5));
  const bool is_inside = volume.at_or_air(nearest) != 0;
  bool is_same = true;
  for (int corner = 0; corner < 8 && is_same; ++corner)
    is_same = (volume.at_or_air(nearest + glm::ivec3(corner & 1 ? 2 : -2, corner & 2 ? 2 : -2, corner & 4 ? 2 : -2)) !=
               0) == is_inside;
  for (int side = 0; side < 6 && is_same; ++side) {
    glm::ivec3 beside = nearest;
    beside[side / 2] += side % 2 ? 2 : -2;
    is_same = (volume.at_or_air(beside) != 0) == is_inside;
  }
  if (is_same) return is_inside ? 1 : 0;
  double sum = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) sum += tissue_share(volume, voxel + glm::dvec3(x, y, z), is_tissue);
  return sum / 27;
}

// Returns the convex hull of points, in counterclockwise order [Andrew 1979, monotone chain].
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
  std::sort(points.begin(), points.end(),
            [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<glm::dvec2> hull;
  const auto turns_right = [&](const glm::dvec2& p) {
    const glm::dvec2 a = hull[hull.size() - 1] - hull[hull.size() - 2], b = p - hull[hull.size() - 2];
    return a.x * b.y - a.y * b.x <= 0;
  };
  for (const bool lower : {true, false}) {
    const std::size_t first = hull.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2& p = lower ? points[i] : points[points.size() - 1 - i];
      while (hull.size() >= first + 2 && turns_right(p)) hull.pop_back();
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
  }
  return hull;
}

// The section of a plane through the body, sampled in square cells.
class PlaneCut {
 public:
  PlaneCut(const LabelVolume& volume, const glm::dvec3& point, const glm::dvec3& normal, double cell_in_voxels)
      : volume_(volume),
        to_voxel_(voxel_from_world(volume.grid)),
        centre_(point) {
    const glm::dvec3 n = glm::normalize(normal);
    const glm::dvec3 other = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    u_ = glm::normalize(glm::cross(n, other));
    v_ = glm::cross(n, u_);
    const glm::dvec3 extent = glm::dvec3(volume.grid.size) * volume.grid.spacing;
    const double diagonal = glm::length(extent);
    cell_ = std::max(cell_in_voxels * std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z}),
                     2 * diagonal / kMostCells);
    half_ = static_cast<int>(std::ceil(diagonal / cell_)) + 2;
    side_ = 2 * half_ + 1;
  }

  // Returns the corners of the tape around the section, in the plane's coordinates. Returns nothing if the section
  // reaches the volume's border, or if the tape is certainly longer than `most` cells.
  std::optional<std::vector<glm::dvec2>> tape(double most = std::numeric_limits<double>::infinity()) const {
    std::vector<bool> seen(static_cast<std::size_t>(side_) * side_);
    struct Open {
      glm::ivec2 cell;
      double share;
    };
    std::vector<Open> open{{{0, 0}, share({0, 0})}};
    seen[index({0, 0})] = true;
    std::vector<glm::dvec2> border;
    glm::ivec2 low(0), high(0);
    while (!open.empty()) {
      const auto [cell, here] = open.back();
      open.pop_back();
      if (is_at_border(cell)) return std::nullopt;
      low = glm::min(low, cell);
      high = glm::max(high, cell);
      if (2.0 * std::max(high.x - low.x, high.y - low.y) > most) return std::nullopt;
      for (const glm::ivec2& step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
        const glm::ivec2 next = cell + step;
        if (std::max(std::abs(next.x), std::abs(next.y)) >= half_) return std::nullopt;
        if (seen[index(next)]) continue;
        const double there = share(next);
        if (there >= kInside) {
          seen[index(next)] = true;
          open.push_back({next, there});
        } else {
          const double t = here > there ? std::clamp((here - kInside) / (here - there), 0.0, 1.0) : 0;
          border.push_back(glm::dvec2(cell) + t * glm::dvec2(step));
        }
      }
    }
    return convex_hull(std::move(border));
  }
  glm::dvec3 world(const glm::dvec2& place) const { return centre_ + cell_ * (place.x * u_ + place.y * v_); }

 private:
  static constexpr double kInside = 0.5;

  std::size_t index(const glm::ivec2& cell) const {
    return static_cast<std::size_t>(cell.x + half_) + static_cast<std::size_t>(side_) * (cell.y + half_);
  }
  double share(const glm::ivec2& cell) const { return smooth_share(volume_, to_voxel_ * world(glm::dvec2(cell))); }
  // Returns whether the cell's tissue is in an outermost voxel of the volume, where the body may be cut off.
  bool is_at_border(const glm::ivec2& cell) const {
    const glm::ivec3 voxel(glm::floor(to_voxel_ * world(glm::dvec2(cell)) + 0.5));
    const bool inside =
        glm::all(glm::greaterThan(voxel, glm::ivec3(0))) && glm::all(glm::lessThan(voxel, volume_.grid.size - 1));
    return !inside && volume_.at_or_air(voxel) != 0;
  }

  const LabelVolume& volume_;
  AffineTransform to_voxel_;
  glm::dvec3 centre_, u_, v_;
  double cell_;  // cell size, mm
  int half_, side_;
};

// Returns the point itself, or the centre of a near tissue voxel if the point is not inside tissue.
glm::dvec3 point_in_tissue(const LabelVolume& volume, const glm::dvec3& point) {
  const glm::dvec3 place = voxel_from_world(volume.grid) * point;
  if (smooth_share(volume, place) >= 0.75) return point;
  const glm::ivec3 voxel(glm::floor(place + 0.5));
  const int reach = static_cast<int>(kBeside) + 1;
  double best = std::numeric_limits<double>::max();
  std::optional<glm::dvec3> found;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const glm::dvec3 at(voxel + glm::ivec3(x, y, z));
        // Prefers a voxel deeper inside to a nearer one at the surface, since little of a surface voxel may be in the
        // plane.
        const double share = smooth_share(volume, at), score = glm::distance(at, place) - 2 * share;
        if (share > 0.5 && score < best) best = score, found = at;
      }
  if (!found) throw Error("there is no tissue at this point", "measuring", "choose a point on the body");
  return world_from_voxel(volume.grid) * *found;
}

double length_of(const std::optional<std::vector<glm::dvec2>>& tape, double none) {
  if (!tape || tape->size() < 3) return none;
  double length = glm::distance(tape->back(), tape->front());
  for (std::size_t i = 1; i < tape->size(); ++i) length += glm::distance((*tape)[i - 1], (*tape)[i]);
  return length;
}

Error is_cut_off() {
  return {"the girth cannot be measured across the border of the volume", "measuring",
          "choose a point further from where the body is cut off"};
}

}  // namespace

std::vector<glm::dvec3> girth_tape(const LabelVolume& volume, const glm::dvec3& point, const glm::dvec3& normal) {
  const PlaneCut cut(volume, point_in_tissue(volume, point), normal, kFine);
  const auto tape = cut.tape();
  if (!tape) throw is_cut_off();
  if (tape->size() < 3)
    throw Error("the body is too thin here to measure its girth", "measuring", "choose another point");
  std::vector<glm::dvec3> corners;
  const std::size_t stride = (tape->size() + kMostTapeCorners - 1) / kMostTapeCorners;
  for (std::size_t i = 0; i < tape->size(); i += stride) corners.push_back(cut.world((*tape)[i]));
  return corners;
}

glm::dvec3 middle_along(const LabelVolume& volume, const glm::dvec3& surface, const glm::dvec3& direction) {
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  const double step = 0.5 * std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  const double most = glm::length(glm::dvec3(volume.grid.size) * volume.grid.spacing);
  const glm::dvec3 way = step * glm::normalize(direction);
  double first = 0, last = 0;  // where along the line tissue begins and ends, in steps from `surface`
  for (double n = 0; n * step < most; ++n) {
    const bool is_in = tissue_share(volume, to_voxel * (surface + n * way), is_tissue) >= 0.5;
    if (is_in) {
      if (last == 0) first = n;
      last = n + 1;
    }
    // Continues at first even outside tissue, since the point on the displayed surface may be slightly outside the
    // tissue.
    if (!is_in && (last > 0 || n > 4 * kBeside)) break;
  }
  return surface + 0.5 * (first + last) * way;
}

glm::dvec3 least_girth_normal(const LabelVolume& volume, const glm::dvec3& point) {
  const glm::dvec3 centre = point_in_tissue(volume, point);
  const LeastDirection least =
      least_direction(kPlanes, kFirstTurn, kLastTurn, [&](const glm::dvec3& normal, double most) {
        return length_of(PlaneCut(volume, centre, normal, kCoarse).tape(most), std::numeric_limits<double>::infinity());
      });
  if (least.length == std::numeric_limits<double>::infinity()) throw is_cut_off();
  return least.direction;
}

}  // namespace limber
