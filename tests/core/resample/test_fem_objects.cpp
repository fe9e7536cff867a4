// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests rigid objects that press on an arm: a block, a table that carries the arm's weight, and a cuff.
#include "core/resample/fem_objects.h"

#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtx/quaternion.hpp>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/mesh/surface_shapes.h"
#include "core/phantom/phantom.h"
#include "core/resample/fem_shape.h"
#include "core/resample/resample.h"

using namespace limber;

namespace {

struct Arm {
  Phantom phantom = make_arm_phantom(4);
  SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);
  glm::dvec3 low{INFINITY}, high{-INFINITY};  // bounds of the tissue around the middle of the forearm, world, mm

  Arm() {
    const Bone& forearm = phantom.armature.bones[require_bone(phantom.armature, "Forearm")];
    const glm::dvec3 middle = (forearm.head + forearm.tail) / 2.0;
    const LabelVolume& volume = phantom.volume;
    glm::ivec3 v;
    for (v.z = 0; v.z < volume.grid.size.z; ++v.z)
      for (v.y = 0; v.y < volume.grid.size.y; ++v.y)
        for (v.x = 0; v.x < volume.grid.size.x; ++v.x) {
          const glm::dvec3 p = world_from_voxel(volume.grid) * glm::dvec3(v);
          if (volume.at(v) == 0 || glm::distance(p, middle) > 70) continue;
          low = glm::min(low, p);
          high = glm::max(high, p);
        }
  }

  Posed posed(const Fem& fem) const {
    return resample(phantom.volume, phantom.tissues, phantom.armature, weights, rest_pose(phantom.armature), fem);
  }
};

const Arm& arm() {
  static const Arm arm;
  return arm;
}

TriangleMesh placed(TriangleMesh surface, const glm::dvec3& at) {
  for (glm::dvec3& v : surface.V) v += at;
  return surface;
}

// Returns a block that comes from the side of +x and ends `depth` mm under the skin of the forearm, or where it presses
// with a force of `newton`, if this is not 0.
FemObject block(double depth, double newton = 0) {
  FemObject object{"block", {}, glm::dvec3(1, 0, 0)};
  const glm::dvec3 middle = (arm().low + arm().high) / 2.0;
  object.surface = placed(box_surface({40, 60, 60}), {arm().high.x + 20 - depth, middle.y, middle.z});
  object.force_n = newton;
  return object;
}

Fem pressing(std::vector<FemObject> objects) {
  return {.contact = true, .quality = FemQuality::Draft, .objects = std::move(objects)};
}

double sum_of(const std::vector<PressedNode>& pressed) {
  double newton = 0;
  for (const PressedNode& node : pressed) newton += 1e-3 * node.kpa * node.area_mm2;
  return newton;
}

}  // namespace

TEST_CASE("objects: a block comes to its place and presses the skin in, and no tissue is left inside it") {
  const FemObject object = block(16);
  const Posed posed = arm().posed(pressing({object}));
  REQUIRE(posed.report.objects.size() == 1);
  const ObjectReport& report = posed.report.objects[0];
  CHECK(posed.report.solve->converged);
  CHECK(std::abs(report.away_mm) < 0.1);
  CHECK(report.pressing_n > 1);
  CHECK(report.crossings == 0);
  CHECK(report.gap_mm > 0);
  CHECK(report.gap_mm < 0.5);
  CHECK(posed.report.mesh->inverted == 0);
  std::int64_t inside = 0, before = 0;
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const glm::dvec3& v : object.surface.V) low = glm::min(low, v), high = glm::max(high, v);
  const auto count = [&](const LabelVolume& volume, std::int64_t& sum) {
    glm::ivec3 v;
    for (v.z = 0; v.z < volume.grid.size.z; ++v.z)
      for (v.y = 0; v.y < volume.grid.size.y; ++v.y)
        for (v.x = 0; v.x < volume.grid.size.x; ++v.x) {
          const glm::dvec3 p = world_from_voxel(volume.grid) * glm::dvec3(v);
          if (glm::all(glm::greaterThan(p, low + 2.0)) && glm::all(glm::lessThan(p, high - 2.0)))
            sum += volume.at(v) != 0;
        }
  };
  count(arm().phantom.volume, before);
  count(posed.volume, inside);
  CHECK(before > 20);
  CHECK(inside <= before / 10);
}

TEST_CASE("objects: a block presses with the force that was asked for, and the pressures add up to it") {
  for (const double newton : {4.0, 12.0}) {
    const Posed posed = arm().posed(pressing({block(0, newton)}));
    const ObjectReport& report = posed.report.objects.at(0);
    CHECK(posed.report.solve->converged);
    CHECK(report.pressing_n == doctest::Approx(newton).epsilon(0.01));
    CHECK(sum_of(posed.shape->pressed) >= report.pressing_n * 0.999);  // N; pressures on slopes also push sideways
    CHECK(sum_of(posed.shape->pressed) < report.pressing_n * 1.1);
    CHECK(report.crossings == 0);
  }
}

TEST_CASE("objects: a light touch is found, also from a place deep in the bone" * doctest::test_suite("slow")) {
  const Posed posed = arm().posed(pressing({block(45, 5)}));
  CHECK(posed.report.solve->converged);
  CHECK(posed.report.objects.at(0).pressing_n == doctest::Approx(5).epsilon(0.01));
  CHECK(posed.report.objects.at(0).away_mm > 20);
  CHECK(posed.report.objects.at(0).crossings == 0);
}

TEST_CASE("objects: a table carries the weight of the arm" * doctest::test_suite("slow")) {
  FemObject table{"table", {}, glm::dvec3(0, 1, 0)};
  table.surface =
      placed(box_surface({300, 40, 300}), {arm().low.x, arm().high.y + 20, (arm().low.z + arm().high.z) / 2});
  table.share_of_weight = 1;
  Fem fem = pressing({table});
  fem.gravity = {0, 9.80665, 0};
  const Posed posed = arm().posed(fem);
  double kilograms = 0;
  for (const Label label : arm().phantom.volume.voxels)
    if (label)
      kilograms += 1e-6 * arm().phantom.volume.grid.voxel_volume() * arm().phantom.tissues.find(label)->density;
  CHECK(kilograms > 1);
  const ObjectReport& report = posed.report.objects.at(0);
  CHECK(posed.report.solve->converged);
  CHECK(report.force_n.y == doctest::Approx(-9.80665 * kilograms).epsilon(0.02));
  CHECK(report.crossings == 0);
}

TEST_CASE("objects: a cuff of nine tenths of the girth tightens around the upper arm" * doctest::test_suite("slow")) {
  const Armature& rig = arm().phantom.armature;
  const Bone& bone = rig.bones[require_bone(rig, "UpperArm")];
  // The cuff lies around the axis of the upper arm. Its radius is nine tenths of the arm's mean radius there.
  const glm::dvec3 middle = bone.head + 0.55 * (bone.tail - bone.head), axis = glm::normalize(bone.tail - bone.head);
  double area = 0;
  const LabelVolume& volume = arm().phantom.volume;
  glm::ivec3 v;
  for (v.z = 0; v.z < volume.grid.size.z; ++v.z)
    for (v.y = 0; v.y < volume.grid.size.y; ++v.y)
      for (v.x = 0; v.x < volume.grid.size.x; ++v.x) {
        const glm::dvec3 off = world_from_voxel(volume.grid) * glm::dvec3(v) - middle;
        if (volume.at(v) && std::abs(glm::dot(off, axis)) < 10 && glm::length(off) < 100)
          area += volume.grid.voxel_volume() / 20;
      }
  const double radius = 0.9 * std::sqrt(area / 3.14159265);
  FemObject cuff{"cuff", cylinder_surface(radius, 40, CylinderEnds::Open)};
  const glm::dquat turn = glm::rotation(glm::dvec3(0, 0, 1), axis);
  for (glm::dvec3& p : cuff.surface.V) p = middle + turn * p;
  cuff.tightens = true;
  const Posed posed = arm().posed(pressing({cuff}));
  const ObjectReport& report = posed.report.objects.at(0);
  CAPTURE(posed.report.solve->blocked_by);
  CHECK(posed.report.solve->converged);
  CHECK(std::abs(report.away_mm) < 0.1);
  CHECK(report.crossings == 0);
  CHECK(report.pressing_n > 1);
  CHECK(report.area_mm2 > 0.3 * 2 * 3.14159265 * radius * 40);
  CHECK(posed.report.mesh->inverted == 0);
}

TEST_CASE("objects: an object without a way comes by the shortest one, and one that the body encloses is refused") {
  FemObject object = block(6);
  object.from.reset();
  const Posed posed = arm().posed(pressing({object}));
  CHECK(posed.report.objects.at(0).force_n.x < 0);
  FemObject none{"nothing", {}};
  CHECK_THROWS_AS(arm().posed(pressing({none})), Error);
}

TEST_CASE("objects: one that is not near the skin is refused, also when the body lies inside it") {
  CHECK_THROWS_WITH_AS(arm().posed(pressing({block(-200)})), doctest::Contains("not near any skin"), Error);
  FemObject around = block(0);
  for (glm::dvec3& v : around.surface.V) v *= 50;
  CHECK_THROWS_WITH_AS(arm().posed(pressing({around})), doctest::Contains("not near any skin"), Error);
}

TEST_CASE("objects: two that press from two sides both get their forces, and the pressures belong to the right one") {
  FemObject other = block(0, 6);
  for (glm::dvec3& v : other.surface.V) v.x = arm().low.x + arm().high.x - v.x;
  for (glm::ivec3& f : other.surface.F) std::swap(f.x, f.y);
  other.name = "other";
  other.from = glm::dvec3(-1, 0, 0);
  const Posed posed = arm().posed(pressing({block(0, 9), other}));
  CHECK(posed.report.solve->converged);
  CHECK(posed.report.objects.at(0).pressing_n == doctest::Approx(9).epsilon(0.011));
  CHECK(posed.report.objects.at(1).pressing_n == doctest::Approx(6).epsilon(0.011));
  const double middle = (arm().low.x + arm().high.x) / 2;
  for (const PressedNode& node : posed.shape->pressed) CHECK(node.object == (node.position.x > middle ? 0 : 1));
}

TEST_CASE("objects: two objects that pass through each other do not press each other") {
  FemObject across = block(10);
  for (glm::dvec3& v : across.surface.V) v.z += 10;
  const Posed alone = arm().posed(pressing({block(10)})), both = arm().posed(pressing({block(10), across}));
  CHECK(both.report.solve->converged);
  CHECK(both.report.objects.at(0).pressing_n < 2 * alone.report.objects.at(0).pressing_n);
}

TEST_CASE("objects: a bent arm is pressed after it has bent") {
  Pose pose = rest_pose(arm().phantom.armature);
  flex(pose, arm().phantom.armature, require_bone(arm().phantom.armature, "Forearm"), 8);
  FemObject object = block(6);
  const Posed posed = resample(arm().phantom.volume, arm().phantom.tissues, arm().phantom.armature, arm().weights, pose,
                               pressing({object}));
  CHECK(posed.report.solve->reached == 1);
  CHECK(std::abs(posed.report.objects.at(0).away_mm) < 0.1);
  CHECK(posed.report.objects.at(0).crossings == 0);
}

TEST_CASE("objects: one and two threads give the same bytes") {
  std::vector<Posed> posed;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    posed.push_back(arm().posed(pressing({block(0, 5)})));
  }
  CHECK(posed[0].volume.voxels == posed[1].volume.voxels);
  CHECK(posed[0].report.objects[0].pressing_n == posed[1].report.objects[0].pressing_n);
}
