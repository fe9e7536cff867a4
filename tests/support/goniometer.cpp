// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/support/goniometer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <Eigen/Dense>

namespace limber::test {

namespace {

// Finds nearest points by a grid of cubes.
class NearestPoint {
 public:
  explicit NearestPoint(const std::vector<glm::dvec3>& points) : points_(points) {
    for (std::size_t i = 0; i < points.size(); ++i) cells_[cell_of(points[i])].push_back(i);
  }

  // Returns the nearest point within four cubes, or null if there is none.
  const glm::dvec3* find(const glm::dvec3& p) const {
    const glm::dvec3* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (int reach = 1; reach <= 4 && !nearest; ++reach)
      visit(p, reach, [&](const glm::dvec3& q) {
        if (const glm::dvec3 d = q - p; glm::dot(d, d) < least) least = glm::dot(d, d), nearest = &q;
      });
    return nearest;
  }

  // Returns the mean of the points around p, weighted by a Gaussian; p itself if there are none. Unlike the nearest
  // point, the mean changes smoothly with p, so that the registration does not get stuck between two layers of voxels.
  glm::dvec3 mean_around(const glm::dvec3& p, double deviation) const {
    glm::dvec3 sum(0);
    double weights = 0;
    visit(p, static_cast<int>(std::ceil(2 * deviation / kCube)), [&](const glm::dvec3& q) {
      const double weight = std::exp(-glm::dot(q - p, q - p) / (2 * deviation * deviation));
      sum += weight * q;
      weights += weight;
    });
    return weights > 1e-6 ? sum / weights : p;
  }

 private:
  using Cell = std::tuple<int, int, int>;
  static constexpr double kCube = 6;
  template <class Visit>
  void visit(const glm::dvec3& p, int reach, const Visit& each) const {
    const auto [x, y, z] = cell_of(p);
    for (int k = -reach; k <= reach; ++k)
      for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i)
          if (const auto found = cells_.find({x + i, y + j, z + k}); found != cells_.end())
            for (const std::size_t at : found->second) each(points_[at]);
  }
  static Cell cell_of(const glm::dvec3& p) {
    return {int(std::floor(p.x / kCube)), int(std::floor(p.y / kCube)), int(std::floor(p.z / kCube))};
  }
  const std::vector<glm::dvec3>& points_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

struct Pairing {
  glm::dvec3 rest, posed;
  double squared = 0;
};

Eigen::Vector3d eigen(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// Returns the rigid motion that brings the rest points nearest to their partners, by least squares [Kabsch 1976].
Registration best_motion(const std::vector<Pairing>& pairs) {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  for (const Pairing& pair : pairs)
    from += eigen(pair.rest) / double(pairs.size()), to += eigen(pair.posed) / double(pairs.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Pairing& pair : pairs) spread += (eigen(pair.posed) - to) * (eigen(pair.rest) - from).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const Eigen::Vector3d t = to - R * from;
  Registration best;
  for (int column = 0; column < 3; ++column) best.rotation[column] = {R(0, column), R(1, column), R(2, column)};
  best.shift = {t.x(), t.y(), t.z()};
  return best;
}

}  // namespace

std::vector<glm::dvec3> surface_of_labels(const LabelVolume& volume, const std::set<Label>& labels) {
  const glm::ivec3 size = volume.grid.size;
  std::vector<char> wanted(65536, 0);
  for (const Label label : labels) wanted[label] = 1;
  const auto is_in = [&](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= size.x || y >= size.y || z >= size.z) return false;
    return wanted[volume.voxels[(std::size_t(z) * size.y + y) * size.x + x]] != 0;
  };
  const AffineTransform to_world = world_from_voxel(volume.grid);
  std::vector<glm::dvec3> points;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (is_in(x, y, z) && !(is_in(x - 1, y, z) && is_in(x + 1, y, z) && is_in(x, y - 1, z) && is_in(x, y + 1, z) &&
                                is_in(x, y, z - 1) && is_in(x, y, z + 1)))
          points.push_back(to_world * glm::dvec3(x, y, z));
  return points;
}

Registration register_points(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed,
                             const Registration& start, double spacing) {
  constexpr std::size_t kPoints = 1500;
  constexpr int kByNearest = 60, kByMean = 60;
  const NearestPoint nearest(posed);
  Registration found = start;
  for (int iteration = 0; iteration < kByNearest + kByMean; ++iteration) {
    std::vector<Pairing> pairs;
    for (std::size_t i = 0; i < std::min(rest.size(), kPoints); ++i) {
      const glm::dvec3& p = rest[rest.size() <= kPoints ? i : i * rest.size() / kPoints];
      const glm::dvec3 moved = found.rotation * p + found.shift;
      const glm::dvec3* partner = nearest.find(moved);
      if (!partner) continue;
      const double squared = glm::dot(*partner - moved, *partner - moved);
      pairs.push_back({p, iteration < kByNearest ? *partner : nearest.mean_around(moved, 0.75 * spacing), squared});
    }
    if (pairs.size() * 10 < std::min(rest.size(), kPoints) * 9) {
      found.residual_mm = std::numeric_limits<double>::infinity();  // more than a tenth of the points have no partner
      return found;
    }
    const auto kept = static_cast<std::ptrdiff_t>(pairs.size() * 7 / 10);
    std::nth_element(pairs.begin(), pairs.begin() + kept, pairs.end(),
                     [](const Pairing& a, const Pairing& b) { return a.squared < b.squared; });
    pairs.resize(static_cast<std::size_t>(kept));
    const Registration next = best_motion(pairs);
    const double turned = glm::length(rotation_vector_of(next.rotation * glm::transpose(found.rotation)));
    found = next;
    found.residual_mm = 0;
    for (const Pairing& pair : pairs) found.residual_mm += pair.squared / double(pairs.size());
    found.residual_mm = std::sqrt(found.residual_mm);
    if (turned > 1e-3) continue;
    if (iteration >= kByNearest) break;
    iteration = kByNearest - 1;
  }
  return found;
}

double degrees_between_vectors(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

glm::dvec3 rotation_vector_of(const glm::dmat3& R) {
  const glm::dvec3 twice(R[1].z - R[2].y, R[2].x - R[0].z, R[0].y - R[1].x);
  const double sine = glm::length(twice) / 2, cosine = (R[0].x + R[1].y + R[2].z - 1) / 2;
  return sine > 0 ? twice / (2 * sine) * glm::degrees(std::atan2(sine, cosine)) : glm::dvec3(0);
}

LimbAngles limb_angles(const glm::dvec3& upper, const glm::dvec3& lower, double out, double bends, bool raised) {
  // Vectors of right limbs are mirrored, so all limbs are measured as left ones.
  const auto as_left = [&](const glm::dvec3& v) { return glm::normalize(glm::dvec3(out * v.x, v.y, v.z)); };
  const glm::dvec3 u = as_left(upper), s = as_left(lower);
  LimbAngles angles;
  angles.bend = degrees_between_vectors(u, s);
  const double f = raised ? 0 : std::atan2(-u.y, -u.z),
               a = raised ? std::atan2(u.x, -u.z) : std::atan2(u.x, std::hypot(u.y, u.z));
  angles.flexion = glm::degrees(f);
  angles.abduction = glm::degrees(a);
  // Axes of the limb at zero rotation: across the limb in the plane of abduction, and backwards.
  const glm::dvec3 across(std::cos(a), std::sin(a) * std::sin(f), std::sin(a) * std::cos(f)),
      back(0, std::cos(f), -std::sin(f));
  angles.rotation = glm::degrees(std::atan2(bends * glm::dot(s, across), bends * glm::dot(s, back)));
  return angles;
}

double pronation_angle(const glm::dvec3& upper, const glm::dvec3& forearm, const glm::dvec3& index_to_little,
                       double out) {
  const glm::dvec3 along = glm::normalize(forearm), elbow = glm::normalize(glm::cross(upper, forearm));
  const glm::dvec3 palm = index_to_little - along * glm::dot(index_to_little, along);
  // At pronation 0, both vectors point to the body's right in a left arm.
  const glm::dvec3 zero = out * elbow;
  return out * glm::degrees(std::atan2(glm::dot(glm::cross(zero, palm), along), glm::dot(zero, palm)));
}

}  // namespace limber::test
