// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/phantom/phantom.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/connected_components.h"

using namespace limber;

namespace {
// Counts the tissue voxels other than skin and nail that touch air by a face, an edge or a corner.
std::int64_t leaks(const Phantom& phantom) {
  const auto kinds = phantom.tissues.kinds();
  const LabelVolume& volume = phantom.volume;
  const glm::ivec3 size = volume.grid.size;
  std::int64_t count = 0;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const Label label = volume.at({x, y, z});
        if (label == 0 || kinds[label] == TissueKind::Skin || kinds[label] == TissueKind::Nail) continue;
        bool air = false;
        for (int k = -1; k <= 1; ++k)
          for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) air |= volume.at_or_air({x + i, y + j, z + k}) == 0;
        count += air;
      }
  return count;
}

std::set<std::string> names_present(const Phantom& phantom) {
  std::set<std::string> names;
  for (const Tissue& tissue : phantom.tissues.tissues) names.insert(tissue.name);
  return names;
}
}  // namespace

TEST_CASE("the arm phantom is closed by skin at every spacing" * doctest::test_suite("slow")) {
  for (double spacing : {1.5, 2.0, 3.0, 4.0, 7.0, 10.0}) {
    CAPTURE(spacing);
    CHECK(leaks(make_arm_phantom(spacing)) == 0);
  }
}

TEST_CASE("the body phantom is closed by skin, its limbs and fingers do not touch" * doctest::test_suite("slow")) {
  for (double spacing : {4.0, 8.0}) {
    CAPTURE(spacing);
    const Phantom body = make_body_phantom(spacing);
    CHECK(leaks(body) == 0);
    CHECK_NOTHROW(check_armature(body.armature, "phantom"));
    // Below the crotch the legs are two pieces. At the wrists there are two hands and the trunk.
    const auto pieces_at = [&](double z) {
      Grid grid = body.volume.grid;
      LabelVolume slice{grid, {}};
      slice.grid.size.z = 1;
      const int k = static_cast<int>((z - grid.origin.z) / grid.spacing.z + 0.5);
      const std::int64_t area = std::int64_t{grid.size.x} * grid.size.y;
      slice.voxels.assign(body.volume.voxels.begin() + k * area, body.volume.voxels.begin() + (k + 1) * area);
      for (Label& label : slice.voxels) label = label != 0;
      return connected_components(slice).voxels.size();
    };
    CHECK(pieces_at(400) == 2);
    CHECK(pieces_at(800) == 2);
    CHECK(pieces_at(1150) == 3);
  }
}

TEST_CASE("every bone of the body phantom is a piece of its own, with marrow cores in the long ones" *
          doctest::test_suite("slow")) {
  const Phantom body = make_body_phantom(3);
  const auto kinds = body.tissues.kinds();
  LabelVolume bone = body.volume, marrow = body.volume;
  for (Label& label : bone.voxels) label = is_bone(kinds[label]);
  for (Label& label : marrow.voxels) label = kinds[label] == TissueKind::Marrow;
  const auto large = [](const LabelVolume& volume, std::int64_t least) {
    const auto sizes = connected_components(volume).voxels;
    return std::count_if(sizes.begin(), sizes.end(), [&](std::int64_t size) { return size >= least; });
  };
  // The phantom has 118 bone parts, but the smallest toe bones may vanish in voxels of 3 mm.
  CHECK(large(bone, 4) >= 90);
  CHECK(large(marrow, 30) >= 12);  // humeri, radii, ulnae, femora, tibiae, fibulae
}

TEST_CASE(
    "a phantom's motion is its own rig's: at rest each joint lies on its bone's head, feet alternate, and it is read "
    "as it is written") {
  for (const Phantom& phantom : {make_arm_phantom(6), make_body_phantom(10)}) {
    CHECK(phantom.motion.frame_count == 60);
    REQUIRE(phantom.motion.joints.size() == phantom.armature.bones.size());
    const auto rest = forward_kinematics(phantom.motion, -1);
    double worst = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      CHECK(phantom.motion.joints[i].name == phantom.armature.bones[i].name);
      const glm::dvec3 p = rest[i].translation;
      worst = std::max(worst, glm::length(glm::dvec3(p.x, -p.z, p.y) - phantom.armature.bones[i].head));
    }
    CHECK(worst < 1e-9);
  }
  const Phantom body = make_body_phantom(10);
  const Motion read = parse_bvh(bvh_text(body.motion), "walk.bvh");
  const auto rest = forward_kinematics(body.motion, 30), again = forward_kinematics(read, 30);
  double worst = 0;
  for (std::size_t i = 0; i < read.joints.size(); ++i)
    worst = std::max(
        worst, glm::length(again[i].translation - rest[require_bone(body.armature, read.joints[i].name)].translation));
  CHECK(read.joints.size() == rest.size());
  CHECK(worst < 1e-9);

  const auto ahead = [&](int frame) {  // how far the left ankle is in front of the right one, mm
    const auto pose = forward_kinematics(body.motion, frame);
    const auto at = [&](const char* name) { return pose[require_bone(body.armature, name)].translation.z; };
    return at("LeftFoot") - at("RightFoot");
  };
  CHECK(ahead(0) > 300);
  CHECK(ahead(30) < -300);
}

TEST_CASE("the arm curl bends the elbow by 100 degrees about its hinge") {
  const Phantom arm = make_arm_phantom(8);
  const int fore = require_bone(arm.armature, "Forearm"), hand = require_bone(arm.armature, "Hand");
  const auto direction = [&](int frame) {
    const auto pose = forward_kinematics(arm.motion, frame);
    return glm::normalize(pose[hand].translation - pose[fore].translation);
  };
  double most = 0;
  for (int frame = 0; frame < 60; ++frame)
    most = std::max(most, glm::degrees(std::acos(std::clamp(glm::dot(direction(0), direction(frame)), -1.0, 1.0))));
  CHECK(most == doctest::Approx(100).epsilon(0.02));
}

TEST_CASE("the arm phantom has the same tissues and volume at 2, 3 and 4 mm" * doctest::test_suite("slow")) {
  const Phantom fine = make_arm_phantom(2), middle = make_arm_phantom(3), coarse = make_arm_phantom(4);
  CHECK(names_present(fine) == names_present(middle));
  CHECK(names_present(fine) == names_present(coarse));
  const auto litres = [](const Phantom& phantom) {
    const auto& voxels = phantom.volume.voxels;
    return (std::ssize(voxels) - std::count(voxels.begin(), voxels.end(), Label{0})) *
           phantom.volume.grid.voxel_volume() / 1e6;
  };
  CHECK(litres(middle) == doctest::Approx(litres(fine)).epsilon(0.01));
  CHECK(litres(coarse) == doctest::Approx(litres(fine)).epsilon(0.01));
}

TEST_CASE("marrow of the phantoms lies inside bone") {
  const Phantom phantom = make_arm_phantom(2);
  const auto kinds = phantom.tissues.kinds();
  const LabelVolume& volume = phantom.volume;
  std::int64_t exposed = 0, marrow = 0;
  const glm::ivec3 size = volume.grid.size;
  for (int z = 1; z + 1 < size.z; ++z)
    for (int y = 1; y + 1 < size.y; ++y)
      for (int x = 1; x + 1 < size.x; ++x) {
        if (kinds[volume.at({x, y, z})] != TissueKind::Marrow) continue;
        ++marrow;
        for (const glm::ivec3& step : {glm::ivec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
          exposed += !is_bone(kinds[volume.at(glm::ivec3(x, y, z) + step)]);
      }
  CHECK(marrow > 1000);
  CHECK(exposed == 0);
}

TEST_CASE("phantoms do not depend on the number of threads") {
  LabelVolume one;
  {
    const ThreadCount limit(1);
    one = make_arm_phantom(4).volume;
  }
  const ThreadCount limit(3);
  const Phantom phantom = make_arm_phantom(4);
  CHECK(phantom.volume.grid == one.grid);
  CHECK(phantom.volume.voxels == one.voxels);
}

TEST_CASE("a phantom's rig is sound and every bone end lies in its tissue") {
  const Phantom phantom = make_arm_phantom(2);
  CHECK_NOTHROW(check_armature(phantom.armature, "phantom"));
  const auto voxel = voxel_from_world(phantom.volume.grid);
  for (const Bone& bone : phantom.armature.bones) {
    CAPTURE(bone.name);
    CHECK(phantom.volume.at_or_air(glm::ivec3(glm::round(voxel * bone.head))) != 0);
    CHECK(phantom.volume.at_or_air(glm::ivec3(glm::round(voxel * (0.1 * bone.head + 0.9 * bone.tail)))) != 0);
  }
}

TEST_CASE("a phantom at a spacing that makes no sense is refused") {
  CHECK_THROWS_AS(make_arm_phantom(0), Error);
  CHECK_THROWS_AS(make_arm_phantom(-1), Error);
  CHECK_THROWS_AS(make_arm_phantom(std::numeric_limits<double>::quiet_NaN()), Error);
  CHECK_THROWS_AS(make_arm_phantom(11), Error);
}
