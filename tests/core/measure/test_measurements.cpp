// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/measure/measurement.h"

#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

#include "core/base/error.h"
#include "core/measure/body_girth.h"
#include "core/measure/tissue_thickness.h"
#include "core/rig/armature.h"

using namespace limber;

namespace {

constexpr Label kSkin = 1, kFlesh = 2;

// A cylinder along any axis, with its skin in another label, on a grid that is rotated and whose voxels are not cubes.
struct Cylinder {
  LabelVolume volume;
  glm::dvec3 centre, axis;

  glm::ivec3 voxel_at(const glm::dvec3& point) const {
    return glm::ivec3(glm::floor(voxel_from_world(volume.grid) * point + 0.5));
  }

  Cylinder(double radius, double half, double skin, const glm::dvec3& along, const glm::dvec3& spacing,
           const glm::dmat3& direction = glm::dmat3(1))
      : axis(glm::normalize(along)) {
    volume.grid.spacing = spacing;
    volume.grid.direction = direction;
    const double reach = std::hypot(radius, half) + 6 * spacing.x;
    volume.grid.size = glm::ivec3(glm::ceil(2 * reach / spacing));
    volume.grid.origin = {10, -20, 30};
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    const AffineTransform world = world_from_voxel(volume.grid);
    centre = world * (glm::dvec3(volume.grid.size - 1) * 0.5);
    for (int z = 0; z < volume.grid.size.z; ++z)
      for (int y = 0; y < volume.grid.size.y; ++y)
        for (int x = 0; x < volume.grid.size.x; ++x) {
          const glm::dvec3 off = world * glm::dvec3(x, y, z) - centre;
          const double t = glm::dot(off, axis), r = glm::length(off - t * axis);
          if (r < radius && std::abs(t) < half) volume.at({x, y, z}) = r > radius - skin ? kSkin : kFlesh;
        }
  }
};

glm::dmat3 turned() { return glm::mat3_cast(glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2))); }

}  // namespace

TEST_CASE("measure: distances, angles and tapes of plain shapes") {
  using P = std::vector<glm::dvec3>;
  CHECK(measure(MeasureKind::Distance, P{{1, 2, 3}, {4, 6, 3}}) == doctest::Approx(5));
  CHECK(measure(MeasureKind::Thickness, P{{0, 0, 0}, {0, 0, -2}}) == doctest::Approx(2));
  for (const double degrees : {0.0, 1e-4, 30.0, 90.0, 179.9999, 180.0}) {
    const double a = glm::radians(degrees);
    CHECK(measure(MeasureKind::Angle, P{{7, 0, 0}, {0, 0, 0}, {3 * std::cos(a), 3 * std::sin(a), 0}}) ==
          doctest::Approx(degrees).epsilon(1e-9));
  }
  CHECK(measure(MeasureKind::Girth, P{{0, 0, 0}, {3, 0, 0}, {3, 4, 0}}) == doctest::Approx(12));
  CHECK(text_of_measure(MeasureKind::Distance, 12.345) == "12.3 mm");
  CHECK(text_of_measure(MeasureKind::Angle, 61.25) == "61.2\u00b0");
  CHECK(is_complete(MeasureKind::Angle, 3));
  CHECK_FALSE(is_complete(MeasureKind::Angle, 2));
  CHECK_FALSE(is_complete(MeasureKind::Girth, kMostTapeCorners + 1));
}

TEST_CASE("girth: a tape around a cylinder has its circumference, however grid and cylinder lie") {
  for (const auto& [along, spacing, direction] :
       {std::tuple{glm::dvec3(0, 0, 1), glm::dvec3(2), glm::dmat3(1)},
        std::tuple{glm::dvec3(1, 2, 3), glm::dvec3(2), glm::dmat3(1)},
        std::tuple{glm::dvec3(1, -1, 0.4), glm::dvec3(1.5, 2, 3), turned()}}) {
    const Cylinder arm(30, 60, 4, along, spacing, direction);
    const double wanted = 2 * std::numbers::pi * 30;
    const auto tape = girth_tape(arm.volume, arm.centre, arm.axis);
    CHECK(measure(MeasureKind::Girth, tape) == doctest::Approx(wanted).epsilon(0.01));
    for (const glm::dvec3& corner : tape) CHECK(std::abs(glm::dot(corner - arm.centre, arm.axis)) < 1e-6);
    // A point at the surface, where a user clicks, gives the same girth.
    const glm::dvec3 side = glm::normalize(glm::cross(arm.axis, glm::dvec3(0.3, 0.5, -0.2)));
    CHECK(measure(MeasureKind::Girth, girth_tape(arm.volume, arm.centre + 30.5 * side, arm.axis)) ==
          doctest::Approx(wanted).epsilon(0.01));
    // An oblique girth is the perimeter of an ellipse, here by Ramanujan's formula.
    const double a = 30 / std::cos(glm::radians(30.0)), b = 30;
    const double ellipse = std::numbers::pi * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
    const glm::dvec3 oblique = std::cos(glm::radians(30.0)) * arm.axis + std::sin(glm::radians(30.0)) * side;
    CHECK(measure(MeasureKind::Girth, girth_tape(arm.volume, arm.centre, oblique)) ==
          doctest::Approx(ellipse).epsilon(0.01));
    CHECK(std::abs(glm::dot(least_girth_normal(arm.volume, arm.centre), arm.axis)) > std::cos(glm::radians(6.0)));
    // From a click on the surface, the middle is found along the line of sight.
    const glm::dvec3 middle = middle_along(arm.volume, arm.centre + 31.0 * side, -side);
    CHECK(glm::distance(middle, arm.centre) < 2);
    CHECK(std::abs(glm::dot(least_girth_normal(arm.volume, middle), arm.axis)) > std::cos(glm::radians(6.0)));
  }
}

TEST_CASE("girth: a tape bridges hollows, and takes no part that is not connected to the point") {
  Cylinder legs(20, 40, 3, {0, 0, 1}, glm::dvec3(2));
  const double one = measure(MeasureKind::Girth, girth_tape(legs.volume, legs.centre, legs.axis));
  // Cuts a groove along the leg, and adds a bar beside the leg that does not touch it.
  for (int z = 0; z < legs.volume.grid.size.z; ++z)
    for (int y = 0; y < legs.volume.grid.size.y; ++y)
      for (int x = 0; x < legs.volume.grid.size.x; ++x) {
        const glm::dvec3 off = world_from_voxel(legs.volume.grid) * glm::dvec3(x, y, z) - legs.centre;
        if (std::abs(off.y) < 4 && off.x > 8) legs.volume.at({x, y, z}) = 0;
        if (off.x > 28 && off.x < 34 && std::abs(off.z) < 30) legs.volume.at({x, y, z}) = kFlesh;
      }
  CHECK(measure(MeasureKind::Girth, girth_tape(legs.volume, legs.centre - glm::dvec3(8, 0, 0), legs.axis)) ==
        doctest::Approx(one).epsilon(0.01));
}

TEST_CASE("girth: where the body is cut off, or where there is none, it is one clear line") {
  Cylinder arm(10, 20, 2, {0, 0, 1}, glm::dvec3(2));
  const auto what = [&](const glm::dvec3& point, const glm::dvec3& normal) {
    try {
      girth_tape(arm.volume, point, normal);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  CHECK(what(arm.centre + glm::dvec3(20, 0, 0), arm.axis).find("there is no tissue at this point") == 0);
  for (int x = 0; x < arm.volume.grid.size.x; ++x)
    for (int z = 0; z < arm.volume.grid.size.z; ++z)
      if (arm.volume.at({x, arm.volume.grid.size.y / 2, z}))
        for (int y = 0; y < arm.volume.grid.size.y; ++y) arm.volume.at({x, y, z}) = kFlesh;
  CHECK(what(arm.centre, arm.axis).find("the girth cannot be measured across the border of the volume") == 0);
}

TEST_CASE("thickness: the shortest line through a layer, a rod and a slab") {
  for (const auto& [spacing, direction] :
       {std::pair{glm::dvec3(1), glm::dmat3(1)}, std::pair{glm::dvec3(1, 1.2, 0.8), turned()}}) {
    const Cylinder arm(24, 40, 5, {1, 2, 3}, spacing, direction);
    const glm::dvec3 side = glm::normalize(glm::cross(arm.axis, glm::dvec3(0.3, 0.5, -0.2)));
    const auto skin = thickness_line(arm.volume, arm.voxel_at(arm.centre + 21.5 * side));
    CHECK(glm::distance(skin[0], skin[1]) == doctest::Approx(5).epsilon(0.12));  // within 0.6 mm
    CHECK(std::abs(glm::dot(glm::normalize(skin[1] - skin[0]), side)) > std::cos(glm::radians(15.0)));
    const auto flesh = thickness_line(arm.volume, arm.voxel_at(arm.centre));
    CHECK(glm::distance(flesh[0], flesh[1]) == doctest::Approx(38).epsilon(0.03));
    CHECK(std::abs(glm::dot(glm::normalize(flesh[1] - flesh[0]), arm.axis)) < 0.35);
  }
  LabelVolume slab;
  slab.grid.size = {40, 40, 40};
  slab.voxels.assign(slab.grid.voxel_count(), 0);
  for (int z = 18; z < 21; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) slab.at({x, y, z}) = kSkin;
  const auto line = thickness_line(slab, {20, 20, 19});
  CHECK(glm::distance(line[0], line[1]) == doctest::Approx(3).epsilon(1e-4));
  CHECK_THROWS_AS(thickness_line(slab, {20, 20, 3}), Error);
  // At the border of the volume a thickness is refused, since the tissue may go on outside.
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) slab.at({x, y, 0}) = slab.at({x, y, 1}) = kFlesh;
  CHECK_THROWS_AS(thickness_line(slab, {20, 20, 1}), Error);
}
