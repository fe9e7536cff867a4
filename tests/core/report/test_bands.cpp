// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/bands.h"

#include <random>
#include <set>

#include <doctest/doctest.h>
#include <Eigen/SVD>

#include "core/rig/pose.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
// A bar of muscle of which one part is stretched along z by a factor. The map is known analytically.
struct PulledBar {
  LabelVolume rest, posed;
  ZeroedVector<glm::vec3> displacement;
  TissueTable tissues = muscle_and_bone();
  Armature armature;
  std::vector<RigidTransform> motions;

  JudgedPose judged() const {
    JudgedPose pose{rest, posed, tissues, {displacement.data(), displacement.size()}, &armature};
    pose.asked = pose.applied = motions;
    return pose;
  }
};

// Makes a bar along z with a rig of two bones that meet at `joint`.
//   begin, length  start and length of the stretched part along z, mm; all above it moves up rigidly
//   factor         factor by which this part becomes longer
PulledBar pulled_bar(double begin, double length, double factor, const glm::dvec3& joint) {
  PulledBar bar;
  const double lift = length * (factor - 1);
  bar.rest.grid = {.size = {16, 16, 100}, .spacing = glm::dvec3(2)};
  bar.posed.grid = {.size = {16, 16, 160}, .spacing = glm::dvec3(2)};
  for (LabelVolume* volume : {&bar.rest, &bar.posed}) volume->voxels.assign(volume->grid.voxel_count(), 0);
  bar.displacement.resize(bar.posed.voxels.size());
  for (int y = 3; y < 13; ++y)
    for (int x = 3; x < 13; ++x) {
      for (int z = 2; z < 98; ++z) bar.rest.at({x, y, z}) = kMuscle;
      for (int z = 2; 2 * z < 196 + lift; ++z) {
        const double at = 2 * z, rest = at < begin                     ? at
                                        : at < begin + length * factor ? begin + (at - begin) / factor
                                                                       : at - lift;
        bar.posed.at({x, y, z}) = kMuscle;
        bar.displacement[bar.posed.grid.index({x, y, z})] = glm::vec3(0, 0, at - rest);
      }
    }
  bar.armature.bones = {bone_between("Lower", -1, {15, 15, 4}, joint), bone_between("Upper", 0, joint, {15, 15, 196})};
  bar.motions = {RigidTransform{}, RigidTransform{{1, 0, 0, 0}, {0, 0, lift}}};
  return bar;
}

std::vector<Band> bands_of(const PulledBar& bar) {
  const JudgedPose pose = bar.judged();
  return find_bands(pose, air_around(pose));
}
}  // namespace

TEST_CASE("bands: the largest stretch is one over the smallest singular value") {
  std::mt19937 random(2);
  std::normal_distribution<double> number;
  for (int trial = 0; trial < 200; ++trial) {
    glm::dmat3 map(1);
    Eigen::Matrix3d same;
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row) same(row, column) = map[column][row] = number(random);
    const double truth = 1 / Eigen::JacobiSVD<Eigen::Matrix3d>(same).singularValues()[2];
    if (truth < 1e3) CHECK(largest_stretch(map) == doctest::Approx(truth).epsilon(1e-6));
  }
  CHECK(largest_stretch(glm::dmat3(1)) == doctest::Approx(1));
  CHECK(largest_stretch(glm::dmat3(0.5)) == doctest::Approx(2));
  CHECK(largest_stretch(glm::dmat3(0)) > 1e100);
}

TEST_CASE(
    "bands: tissue pulled out threefold far from the joint is a band between the two bones, of its size and place") {
  const auto bands = bands_of(pulled_bar(140, 16, 3, {15, 15, 20}));
  REQUIRE(bands.size() == 1);
  CHECK(bands[0].stretch == doctest::Approx(3).epsilon(0.01));
  // The band has 24 slices of 10 x 10 voxels. At its ends the stretch is only partly seen.
  CHECK(std::abs(bands[0].voxels - 24 * 100) <= 2 * 100);
  CHECK(bands[0].mm3 == doctest::Approx(8.0 * double(bands[0].voxels)));
  CHECK(bands[0].place.z == doctest::Approx(164).epsilon(0.03));
  CHECK(std::set<std::string>{bands[0].between[0], bands[0].between[1]} == std::set<std::string>{"Lower", "Upper"});
}

TEST_CASE("bands: a bone far away is none of the two, though it moves as the pulled tissue does") {
  PulledBar bar = pulled_bar(140, 16, 3, {15, 15, 20});
  const glm::dvec3 far(15, 1500, 20);
  bar.armature.bones.push_back(bone_between("Far", 0, far, far + glm::dvec3(0, 0, 40)));
  // The bone Far moves half as far as the bone Upper, so half of the band's voxels move more like Far than like Upper
  // or Lower.
  bar.motions.push_back({{1, 0, 0, 0}, {0, 0, 16}});
  const auto bands = bands_of(bar);
  REQUIRE(bands.size() == 1);
  CHECK(std::set<std::string>{bands[0].between[0], bands[0].between[1]} == std::set<std::string>{"Lower", "Upper"});
}

TEST_CASE("bands: the same pull around the joint that makes it is none, and neither is a pull of less than twice") {
  CHECK(bands_of(pulled_bar(92, 16, 3, {15, 15, 100})).empty());
  CHECK(bands_of(pulled_bar(140, 16, 1.9, {15, 15, 20})).empty());
  CHECK(bands_of(pulled_bar(140, 16, 1, {15, 15, 20})).empty());
}

TEST_CASE("bands: two skins that met in the pose are no band, however far apart they lay at rest") {
  PulledBar bar = pulled_bar(140, 16, 1, {15, 15, 20});
  // All voxels from slice 60 on come from a position 40 mm aside, so that the map jumps between slices 59 and 60.
  for (std::int64_t at = 0; at < std::ssize(bar.posed.voxels); ++at)
    if (at / 256 >= 60) bar.displacement[at].x += 40;
  bar.motions[1].translation.x = 40;
  CHECK(bands_of(bar).empty());
}
