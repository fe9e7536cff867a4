// SPDX-License-Identifier: AGPL-3.0-or-later
// The shapes of which the procedural anatomy is modelled. Each shape computes the signed distance of a point in mm,
// negative inside. Approximate distances are accurate enough for layers (skin, cortex) of even thickness.
//   Cone       a sphere swept from a to b while its radius changes (exact) [Quilez, "Round Cone"]
//   Ellipsoid  first-order distance, scaled by the gradient
//   Plate      a triangle thickened by a radius (exact)
//   Loft       elliptic cross sections at stations along a straight axis, interpolated smoothly; for limbs and trunk
// A Solid combines shapes one after another: each is added by a smooth union, or cut away by a smooth difference.
#pragma once

#include <span>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

namespace limber::phantom {

// The transform from local to world coordinates, mm. Its axes are orthonormal and may mirror, which turns a left limb
// into a right one.
struct Frame {
  glm::dvec3 origin{0};
  glm::dmat3 axes{1};

  glm::dvec3 point(const glm::dvec3& local) const { return origin + axes * local; }
  glm::dvec3 vector(const glm::dvec3& local) const { return axes * local; }
  // Returns the world axis of a rotation about a local axis. A frame that mirrors also reverses the sense of rotation.
  glm::dvec3 turn_axis(const glm::dvec3& local) const { return axes * local * glm::determinant(axes); }
  Frame at(const glm::dvec3& local_origin) const { return {point(local_origin), axes}; }
  Frame turned(const glm::dvec3& local_axis, double degrees) const;  // rotates about the frame's origin
  Frame mirrored_x() const;                                          // mirrors the frame at the world plane x = 0
};

struct Box {
  glm::dvec3 low{1e30}, high{-1e30};

  void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  void add(const Box& box) { low = glm::min(low, box.low), high = glm::max(high, box.high); }
  Box grown(double by) const { return {low - by, high + by}; }
  bool touches(const Box& other) const {
    return glm::all(glm::lessThanEqual(low, other.high)) && glm::all(glm::lessThanEqual(other.low, high));
  }
};

struct Cone {
  glm::dvec3 a, b;
  double radius_a, radius_b;
};

struct Ellipsoid {
  Frame frame;
  glm::dvec3 radii;
};

struct Plate {
  glm::dvec3 a, b, c;
  double radius;
};

// One cross section of a loft, at coordinate z of the loft's frame. It is an ellipse for exponent 2, and a superellipse
// that approaches a rectangle for higher exponents.
struct Station {
  double z;
  glm::dvec2 centre, radii;
  double exponent = 2;
};

class Loft {
 public:
  // Makes a loft.
  //   stations  cross sections, two or more, in any order
  //   rounding  radius of the edges at both ends, mm
  Loft(const Frame& frame, std::vector<Station> stations, double rounding);
  double distance(const glm::dvec3& p) const;
  Box bounds() const;

 private:
  struct Sample {
    glm::dvec2 centre, radii;
    double exponent;
  };
  Frame frame_;
  double low_, high_, rounding_;
  std::vector<Sample> samples_;  // interpolated cross sections at equal steps of z
};

using Shape = std::variant<Cone, Ellipsoid, Plate, Loft>;

double distance(const Shape& shape, const glm::dvec3& p);
Box bounds(const Shape& shape);

// Returns a smooth minimum of a and b. If they differ by `blend` or more, it is the smaller value; else it is less than
// the smaller value by at most blend / 4 [Quilez, polynomial].
double smooth_min(double a, double b, double blend);

struct Solid {
  struct Step {
    enum class Kind { Add, Cut } kind;
    Shape shape;
    double blend;  // width of the smooth union or difference, mm
  };
  std::vector<Step> steps;
  Box box;  // bounding box of the solid

  Solid() = default;
  explicit Solid(const Shape& shape) { add(shape); }
  Solid& add(const Shape& shape, double blend = 0);
  Solid& cut(const Shape& shape, double blend = 0);
  // Adds a chain of cones through the given points; the fourth component (w) is the radius at the point, mm.
  Solid& add_tube(const Frame& frame, std::span<const glm::dvec4> points_and_radii, double blend = 0);
  double distance(const glm::dvec3& p) const;
};

}  // namespace limber::phantom
