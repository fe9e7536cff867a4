// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/bone_volumes.h"

#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "core/resample/resample.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

constexpr Label kSpongy = 4, kMarrow = 5;

// Makes a limb with thick bones: marrow inside spongy bone of one voxel inside a shell of two voxels.
test::BentTube layered_tube() {
  test::BentTube tube = test::bent_tube({}, 80);
  for (const auto& [label, name] : {std::pair{kSpongy, "spongy bone"}, {kMarrow, "marrow"}}) {
    Tissue tissue = *tube.tissues.find(test::kBone);
    tissue.label = label;
    tissue.name = name;
    tissue.file_value = label;
    tube.tissues.tissues.push_back(tissue);
  }
  const TissueVoxels tissue(tube.volume);
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    SkinWeights::Influences chunk = tube.weights.chunk(brick);
    auto influence = chunk.begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      Influence& mine = *influence++;
      const double from_end = std::min({std::abs(v.z - 40) - 6, v.z - 6, 73 - v.z}),
                   inside = std::min(6 - std::hypot(v.x - 11, v.y - 12), from_end);
      Label& label = tube.volume.at(v);
      if (label == test::kBone) label = test::kFat;
      if (inside < 0) return;
      label = inside < 2 ? test::kBone : inside < 3 ? kSpongy : kMarrow;
      mine = rigid_influence(v.z > 40);
    });
    tube.weights.set_chunk(brick, std::move(chunk));
  }
  return tube;
}

// Returns the share of each bone tissue in all bone voxels.
std::map<Label, double> shares(const LabelVolume& volume) {
  std::map<Label, double> count;
  double all = 0;
  for (const Label label : volume.voxels)
    if (label == test::kBone || label == kSpongy || label == kMarrow) ++count[label], ++all;
  for (auto& [label, share] : count) share /= all;
  return count;
}

}  // namespace

TEST_CASE("bone volumes: a layer of one voxel keeps its share of a bone that is turned, with every blend") {
  const test::BentTube tube = layered_tube();
  for (const Method& method : {Method(Blend::Linear), Method(Blend::DualQuaternion)})
    for (const double degrees : {17.0, 45.0, 60.0}) {
      CAPTURE(degrees);
      const Pose pose = tube.pose(degrees, 25);
      const Posed posed = resample(tube.volume, tube.tissues, tube.rig, tube.weights, pose, method);
      const auto before = shares(tube.volume), after = shares(posed.volume);
      REQUIRE(after.size() == 3);
      for (const auto& [label, share] : before) CHECK(after.at(label) == doctest::Approx(share).epsilon(0.002));
      for (const auto& bone : posed.report.bones) CHECK(bone.rigid_residual_mm < 0.01);
    }
}

TEST_CASE(
    "bone volumes: only voxels near a border change hands, to the tissue that lost, and none where nothing was lost") {
  LabelVolume rest;
  rest.grid.size = {8, 8, 12};
  rest.voxels.assign(rest.grid.voxel_count(), kMarrow);
  for (int z = 6; z < 12; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) rest.at({x, y, z}) = kSpongy;
  LabelVolume bones = rest;
  for (Label& label : bones.voxels) label = 1;
  LabelSet soft(65536, 1);
  soft[kMarrow] = soft[kSpongy] = 0;

  LabelVolume posed = rest;
  const RestPoint still = [](const glm::ivec3& v) { return glm::dvec3(v); };
  CHECK(keep_bone_volumes(posed, bones, rest, bones, soft, still) == 0);
  CHECK(posed.voxels == rest.voxels);

  // A motion by 0.4 of a voxel keeps the nearest voxels. One voxel beyond the border is set to the wrong label.
  const RestPoint moved = [](const glm::ivec3& v) { return glm::dvec3(v) + glm::dvec3(0, 0, 0.4); };
  CHECK(keep_bone_volumes(posed, bones, rest, bones, soft, moved) == 0);
  posed.at({3, 4, 5}) = kSpongy;
  CHECK(keep_bone_volumes(posed, bones, rest, bones, soft, moved) == 1);
  CHECK(posed.voxels == rest.voxels);
}
