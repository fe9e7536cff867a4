// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/phantom/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/quaternion.hpp>

namespace limber::phantom {

namespace {
// Number of cross sections in a loft's lookup table. The surface is straight from one section to the next, which is not
// visible with this number.
constexpr int kLoftSamples = 96;
constexpr double kFar = 1e30;

double squared(const glm::dvec3& v) { return glm::dot(v, v); }

double cone_distance(const Cone& cone, const glm::dvec3& p) {
  const glm::dvec3 along = cone.b - cone.a, from_a = p - cone.a;
  const double l2 = squared(along), narrowing = cone.radius_a - cone.radius_b;
  const double a2 = l2 - narrowing * narrowing;
  // If one of the spheres at the ends contains the other one, the cone is the larger sphere.
  if (a2 <= 0) return narrowing > 0 ? glm::length(from_a) - cone.radius_a : glm::length(p - cone.b) - cone.radius_b;

  const double y = glm::dot(from_a, along), z = y - l2;
  const double x2 = squared(from_a * l2 - along * y), y2 = y * y * l2, z2 = z * z * l2;
  const double k = (narrowing > 0 ? 1 : narrowing < 0 ? -1 : 0) * narrowing * narrowing * x2;
  if ((z > 0 ? 1 : z < 0 ? -1 : 0) * a2 * z2 > k) return std::sqrt(x2 + z2) / l2 - cone.radius_b;
  if ((y > 0 ? 1 : y < 0 ? -1 : 0) * a2 * y2 < k) return std::sqrt(x2 + y2) / l2 - cone.radius_a;
  return (std::sqrt(x2 * a2 / l2) + y * narrowing) / l2 - cone.radius_a;
}

double ellipsoid_distance(const Ellipsoid& ellipsoid, const glm::dvec3& p) {
  const glm::dvec3 q = (p - ellipsoid.frame.origin) * ellipsoid.frame.axes / ellipsoid.radii;  // v * M is M^T v in GLM
  const double k0 = glm::length(q), k1 = glm::length(q / ellipsoid.radii);
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -std::min({ellipsoid.radii.x, ellipsoid.radii.y, ellipsoid.radii.z});
}

double segment_squared_distance(const glm::dvec3& p, const glm::dvec3& along) {
  return squared(p - along * std::clamp(glm::dot(p, along) / squared(along), 0.0, 1.0));
}

double plate_distance(const Plate& plate, const glm::dvec3& p) {
  const glm::dvec3 ab = plate.b - plate.a, bc = plate.c - plate.b, ca = plate.a - plate.c;
  const glm::dvec3 pa = p - plate.a, pb = p - plate.b, pc = p - plate.c, normal = glm::cross(ab, -ca);
  const bool above = glm::dot(glm::cross(ab, normal), pa) <= 0 && glm::dot(glm::cross(bc, normal), pb) <= 0 &&
                     glm::dot(glm::cross(ca, normal), pc) <= 0;
  const double height = glm::dot(normal, pa);
  const double d2 = above ? height * height / squared(normal)
                          : std::min({segment_squared_distance(pa, ab), segment_squared_distance(pb, bc),
                                      segment_squared_distance(pc, ca)});
  return std::sqrt(d2) - plate.radius;
}

// Interpolates a value between the cross sections i and i + 1 by a cubic. Its slope at a cross section is the harmonic
// mean of the slopes to both neighbours, so that the curve does not overshoot the given values.
double interpolate(const std::vector<Station>& stations, std::size_t i, double z, auto value) {
  const auto secant = [&](std::size_t k) {
    return (value(stations[k + 1]) - value(stations[k])) / (stations[k + 1].z - stations[k].z);
  };
  const auto slope = [&](std::size_t k) {
    if (k == 0 || k + 1 == stations.size()) return k == 0 ? secant(0) : secant(k - 1);
    const double before = secant(k - 1), after = secant(k);
    return before * after <= 0 ? 0.0 : 2 * before * after / (before + after);
  };
  const double length = stations[i + 1].z - stations[i].z, t = (z - stations[i].z) / length;
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * value(stations[i]) + (3 * t2 - 2 * t3) * value(stations[i + 1]) +
         length * ((t3 - 2 * t2 + t) * slope(i) + (t3 - t2) * slope(i + 1));
}
}  // namespace

Frame Frame::turned(const glm::dvec3& local_axis, double degrees) const {
  const auto turn = glm::angleAxis(degrees * std::numbers::pi / 180, glm::normalize(local_axis));
  return {origin, axes * glm::mat3_cast(turn)};
}

Frame Frame::mirrored_x() const {
  const glm::dmat3 mirror(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
  return {mirror * origin, mirror * axes};
}

Loft::Loft(const Frame& frame, std::vector<Station> stations, double rounding) : frame_(frame), rounding_(rounding) {
  std::sort(stations.begin(), stations.end(), [](const Station& a, const Station& b) { return a.z < b.z; });
  low_ = stations.front().z;
  high_ = stations.back().z;
  std::size_t i = 0;
  for (int s = 0; s < kLoftSamples; ++s) {
    const double z = low_ + (high_ - low_) * s / (kLoftSamples - 1);
    while (i + 2 < stations.size() && z > stations[i + 1].z) ++i;
    const auto at = [&](auto value) { return interpolate(stations, i, z, value); };
    samples_.push_back(
        {{at([](const Station& k) { return k.centre.x; }), at([](const Station& k) { return k.centre.y; })},
         {at([](const Station& k) { return k.radii.x; }), at([](const Station& k) { return k.radii.y; })},
         at([](const Station& k) { return k.exponent; })});
  }
}

double Loft::distance(const glm::dvec3& world) const {
  const glm::dvec3 p = (world - frame_.origin) * frame_.axes;
  const double step = (high_ - low_) / (kLoftSamples - 1);
  const double u = std::clamp((p.z - low_) / step, 0.0, kLoftSamples - 1.0);
  const int i = std::min(static_cast<int>(u), kLoftSamples - 2);
  const double t = u - i;
  const Sample &below = samples_[i], &above = samples_[i + 1];
  const glm::dvec2 centre = glm::mix(below.centre, above.centre, t), radii = glm::mix(below.radii, above.radii, t);
  const double n = below.exponent + (above.exponent - below.exponent) * t;

  // Distance to the outline within the plane of the cross section: (k - 1) / |grad k|, where k is the norm whose unit
  // curve is the superellipse.
  const glm::dvec2 q = (glm::dvec2(p) - centre) / radii, size = glm::abs(q);
  double k, in_plane;
  glm::dvec2 gradient;
  if (n == 2) {
    k = glm::length(q);
    gradient = k > 0 ? q / radii / k : glm::dvec2(0);
  } else {
    k = std::pow(std::pow(size.x, n) + std::pow(size.y, n), 1 / n);
    gradient = k > 0 ? glm::sign(q) * glm::pow(size / k, glm::dvec2(n - 1)) / radii : glm::dvec2(0);
  }
  const double steepness = glm::length(gradient);
  in_plane = steepness > 0 ? (k - 1) / steepness : -std::min(radii.x, radii.y);
  // If the loft's wall is oblique to its axis, the true distance is less than the distance within the cross section.
  if (steepness > 0 && p.z > low_ && p.z < high_) {
    const glm::dvec2 growth = (above.radii - below.radii) / step, drift = (above.centre - below.centre) / step;
    const double lean = glm::dot(gradient / steepness, drift + growth * q / std::max(k, 1e-9));
    in_plane /= std::sqrt(1 + lean * lean);
  }

  const double beyond = std::max(low_ - p.z, p.z - high_);
  const glm::dvec2 w(in_plane + rounding_, beyond + rounding_);
  return std::min(std::max(w.x, w.y), 0.0) + glm::length(glm::max(w, glm::dvec2(0))) - rounding_;
}

Box Loft::bounds() const {
  Box box;
  const double step = (high_ - low_) / (kLoftSamples - 1);
  for (int s = 0; s < kLoftSamples; ++s)
    for (double x : {-1.0, 1.0})
      for (double y : {-1.0, 1.0})
        box.add(frame_.point({samples_[s].centre + samples_[s].radii * glm::dvec2(x, y), low_ + s * step}));
  return box;
}

double distance(const Shape& shape, const glm::dvec3& p) {
  if (const auto* cone = std::get_if<Cone>(&shape)) return cone_distance(*cone, p);
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) return ellipsoid_distance(*ellipsoid, p);
  if (const auto* plate = std::get_if<Plate>(&shape)) return plate_distance(*plate, p);
  return std::get<Loft>(shape).distance(p);
}

Box bounds(const Shape& shape) {
  Box box;
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    box.add(Box{cone->a - cone->radius_a, cone->a + cone->radius_a});
    box.add(Box{cone->b - cone->radius_b, cone->b + cone->radius_b});
  } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) {
    glm::dvec3 reach(0);
    for (int world = 0; world < 3; ++world)
      for (int local = 0; local < 3; ++local) {
        const double part = ellipsoid->frame.axes[local][world] * ellipsoid->radii[local];
        reach[world] += part * part;
      }
    reach = glm::sqrt(reach);
    box = {ellipsoid->frame.origin - reach, ellipsoid->frame.origin + reach};
  } else if (const auto* plate = std::get_if<Plate>(&shape)) {
    for (const auto& corner : {plate->a, plate->b, plate->c}) box.add(corner);
    box = box.grown(plate->radius);
  } else {
    box = std::get<Loft>(shape).bounds();
  }
  return box;
}

double smooth_min(double a, double b, double blend) {
  const double h = blend - std::abs(a - b);
  return h > 0 ? std::min(a, b) - h * h / (4 * blend) : std::min(a, b);
}

Solid& Solid::add(const Shape& shape, double blend) {
  steps.push_back({Step::Kind::Add, shape, blend});
  box.add(bounds(shape).grown(blend / 4));
  return *this;
}

Solid& Solid::cut(const Shape& shape, double blend) {
  steps.push_back({Step::Kind::Cut, shape, blend});
  return *this;
}

Solid& Solid::add_tube(const Frame& frame, std::span<const glm::dvec4> points, double blend) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    add(Cone{frame.point(points[i]), frame.point(points[i + 1]), points[i].w, points[i + 1].w}, blend);
  return *this;
}

double Solid::distance(const glm::dvec3& p) const {
  double d = kFar;
  for (const Step& step : steps) {
    const double s = phantom::distance(step.shape, p);
    d = step.kind == Step::Kind::Add ? smooth_min(d, s, step.blend) : -smooth_min(-d, s, step.blend);
  }
  return d;
}

}  // namespace limber::phantom
