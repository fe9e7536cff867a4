// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/least_shift.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/rigid_transform.h"

using namespace limber;

namespace {

using Inside = std::function<bool(const glm::dvec3&)>;

// Returns the voxels whose centres lie in a shape, given in mm along the grid's axes.
std::vector<glm::ivec3> voxels_of(const Inside& inside, const glm::dvec3& spacing, const glm::dvec3& size) {
  std::vector<glm::ivec3> voxels;
  const glm::ivec3 end(size / spacing);
  for (int z = 0; z <= end.z; ++z)
    for (int y = 0; y <= end.y; ++y)
      for (int x = 0; x <= end.x; ++x)
        if (inside(glm::dvec3(x, y, z) * spacing)) voxels.push_back({x, y, z});
  return voxels;
}

AffineTransform affine(const RigidTransform& rigid) { return {glm::mat3_cast(rigid.rotation), rigid.translation}; }

// Returns the path of a turn about an axis through a point, in steps of ten degrees.
std::vector<AffineTransform> turn(const glm::dvec3& about, const glm::dvec3& axis, double degrees) {
  std::vector<AffineTransform> path;
  const int steps = static_cast<int>(std::ceil(degrees / 10));
  for (int i = 1; i <= steps; ++i)
    path.push_back(affine(rotation_about(about, glm::angleAxis(degrees * std::numbers::pi / 180 * i / steps, axis))));
  return path;
}

std::vector<AffineTransform> slide(const glm::dvec3& way) {
  std::vector<AffineTransform> path;
  for (int i = 1; i <= 8; ++i) path.push_back({glm::dmat3(1), way * (i / 8.0)});
  return path;
}

LeastShift least(const Inside& fixed, const Inside& turning, const std::vector<AffineTransform>& path, double most,
                 const glm::dvec3& spacing = glm::dvec3(1), const glm::dvec3& size = glm::dvec3(60)) {
  const VoxelBox box{-glm::ivec3(30.0 / spacing), glm::ivec3((size + 60.0) / spacing)};
  const BoneDistance from_fixed(spacing, voxels_of(fixed, spacing, size), box);
  const BoneDistance from_turning(spacing, voxels_of(turning, spacing, size), box);
  return least_shift({from_fixed, from_turning, spacing}, path, {.most_mm = most});
}

Inside ball(const glm::dvec3& centre, double radius) {
  return [=](const glm::dvec3& p) { return glm::distance(p, centre) <= radius; };
}
Inside block(const glm::dvec3& low, const glm::dvec3& high) {
  return [=](const glm::dvec3& p) { return glm::all(glm::greaterThan(p, low)) && glm::all(glm::lessThan(p, high)); };
}

}  // namespace

TEST_CASE("least shift: a ball that is led into another one is pushed back along the line between their middles") {
  const Inside one = ball({20, 25, 25}, 10), other = ball({46, 25, 25}, 10);
  // The middles end 14 mm apart, which is 6 mm less than two radii. Half a voxel of overlap is allowed.
  const glm::dvec3 line(0.8, 0.6, 0);
  const LeastShift found = least(one, other, slide(glm::dvec3(20, 25, 25) + 14.0 * line - glm::dvec3(46, 25, 25)), 10);
  CHECK(found.free);
  CHECK(std::abs(found.depth_before - 5.5) < 0.5);
  CHECK(found.depth_after <= 0.05);
  // A shift that ends a voxel to the side is hardly longer, so its direction is not exact.
  CHECK(std::abs(glm::length(found.shift) - 5.5) < 0.3);
  CHECK(std::abs(glm::length(14.0 * line + found.shift) - 19.5) < 0.3);
}

TEST_CASE("least shift: bones that do not overlap are not shifted at all") {
  const LeastShift found = least(ball({20, 25, 25}, 10), ball({46, 25, 25}, 10), slide({-5.9, 0, 0}), 10);
  CHECK(found.free);
  CHECK(found.shift == glm::dvec3(0));
  CHECK(found.depth_before == 0);
}

TEST_CASE("least shift: stops at the longest shift, as near to free as it comes there, and says so") {
  const Inside one = ball({20, 25, 25}, 10), other = ball({46, 25, 25}, 10);
  const LeastShift found = least(one, other, slide({-12, 0, 0}), 2);
  CHECK_FALSE(found.free);
  CHECK(glm::length(found.shift) <= 2 + 1e-9);
  CHECK(found.shift.x > 1.95);
  CHECK(found.depth_after == doctest::Approx(found.depth_before - 2).epsilon(0.1));
}

TEST_CASE("least shift: what the fixed bone was carried along by counts where both together are bounded") {
  const Inside one = ball({20, 25, 25}, 10), other = ball({46, 25, 25}, 10);
  const VoxelBox box{glm::ivec3(0), glm::ivec3(60, 50, 50)};
  const BoneDistance from_one(glm::dvec3(1), voxels_of(one, glm::dvec3(1), glm::dvec3(60)), box),
      from_other(glm::dvec3(1), voxels_of(other, glm::dvec3(1), glm::dvec3(60)), box);
  const JointBones bones{from_one, from_other, glm::dvec3(1)};
  for (const glm::dvec3 carried :
       {glm::dvec3(3, 0, 0), glm::dvec3(0, -3, 1), glm::dvec3(-4, 0, 0), glm::dvec3(4, 0, 0)}) {
    const LeastShift found = least_shift(bones, slide({-12, 0, 0}), {.most_mm = 10, .whole_mm = 4, .carried = carried});
    CAPTURE(carried.x);
    // A shift of about 5.5 mm along +x is needed, but carried + shift may be at most 4 mm long.
    CHECK(found.free == (carried.x < 0));
    CHECK(glm::length(carried + found.shift) <= 4 + 1e-9);
    CHECK(found.depth_after <= found.depth_before);
  }
  CHECK(least_shift(bones, slide({-12, 0, 0}), {.most_mm = 10, .whole_mm = 12, .carried = {-4, 0, 0}}).free);
}

TEST_CASE("least shift: a ball turned about a point beside its middle goes back into its socket") {
  const glm::dvec3 middle(30, 30, 30), head(30, 26, 33);
  // Makes a socket: a block with a bowl that holds a little more than half of the ball and is 0.5 mm wider.
  const Inside socket = [&](const glm::dvec3& p) {
    return p.z > 28 && p.z < 50 && glm::length(glm::dvec2(p - middle)) < 22 && glm::distance(p, middle) > 11.5;
  };
  const Inside bone = [&](const glm::dvec3& p) {
    return glm::distance(p, middle) <= 11 || (p.z < 30 && glm::length(glm::dvec2(p - middle)) < 5);
  };
  const auto path = turn(head, glm::normalize(glm::dvec3(1, 0.3, 0)), 60);
  const LeastShift found = least(socket, bone, path, 10);
  CHECK(found.free);
  const glm::dvec3 off = path.back() * middle - middle;
  REQUIRE(glm::length(off) > 3.5);
  // The shift may end short of -off by the socket's gap of 0.5 mm and the half voxel of overlap that is allowed.
  CHECK(glm::distance(found.shift, -off) < 1.4);
  CHECK(glm::length(found.shift) < glm::length(off));
}

TEST_CASE("least shift: a ball turned about its middle in a closed socket stays, whatever the voxels" *
          doctest::test_suite("slow")) {
  for (const glm::dvec3 spacing : {glm::dvec3(1), glm::dvec3(3), glm::dvec3(2.1, 2.1, 8)}) {
    const glm::dvec3 middle(61.3, 60.2, 60.7);
    const Inside bone = [&](const glm::dvec3& p) {
      return glm::distance(p, middle) <= 24 || (p.z < 60 && glm::length(glm::dvec2(p - middle)) < 12);
    };
    const Inside socket = [&](const glm::dvec3& p) { return p.z > 62 && glm::distance(p, middle) < 34 && !bone(p); };
    for (const double degrees : {10.0, 20.0, 30.0, 45.0}) {
      CAPTURE(spacing.z);
      CAPTURE(degrees);
      const LeastShift found = least(socket, bone, turn(middle, {1, 0, 0}, degrees), 10, spacing, glm::dvec3(120));
      CHECK(found.free);
      CHECK(glm::length(found.shift) < 0.1 * spacing.z);
    }
  }
}

TEST_CASE("least shift: of two boxes on a hinge, the corner is freed through the nearer face") {
  // Turned by 90 degrees about z at (30, 30), the second box covers x 20 to 40, and y from 30 on. The first box reaches
  // to y = 36 and x = 30, so the corner is freed by 6 mm along y or by 10 mm along x.
  const Inside first = block({9.5, 20, 20}, {29.5, 36, 40}), second = block({29.5, 20, 20}, {49.5, 40, 40});
  const LeastShift found = least(first, second, turn({29.5, 30, 30}, {0, 0, 1}, 90), 15);
  CHECK(found.free);
  CHECK(glm::distance(found.shift, glm::dvec3(0, 5.5, 0)) < 0.6);
  const LeastShift bounded = least(first, second, turn({29.5, 30, 30}, {0, 0, 1}, 90), 3);
  CHECK_FALSE(bounded.free);
  CHECK(glm::length(bounded.shift) <= 3 + 1e-9);
}

TEST_CASE("least shift: a bone is pushed back to the side that it comes from, also where the other one is thin") {
  // A ball moves from x = 17 to 33, beyond a wall of two voxels. Free of the near face at x = 29.5, with half a voxel
  // of overlap, the ball lies at x = 21.
  const Inside wall = block({29.5, 5, 5}, {31.5, 55, 55});
  const LeastShift found = least(wall, ball({17, 30, 30}, 9), slide({16, 0, 0}), 20);
  CHECK(found.free);
  CHECK(found.shift.x == doctest::Approx(-12).epsilon(0.05));
}

TEST_CASE("bone distance: a point is passed over below a limit only where the distance there is no less") {
  const glm::dvec3 spacing(1);
  const auto voxels = voxels_of(ball({20, 20, 20}, 8), spacing, glm::dvec3(40));
  const BoneDistance bone(spacing, voxels, {{5, 5, 5}, {31, 31, 31}});
  int passed = 0, looked_at = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 point(3 + i % 29 * 1.237, 3 + i / 29 % 27 * 1.311, 3 + i / 783 * 1.353);
    const double limit = i % 5 - 2.5;
    const auto at = bone.at(point), below = bone.below(point, limit);
    if (below) CHECK((at && at->mm == below->mm && at->slope == below->slope));
    if (at && !below) CHECK(at->mm >= limit);
    passed += at && !below, looked_at += below.has_value();
  }
  CHECK(passed > 5000);
  CHECK(looked_at > 500);
}
