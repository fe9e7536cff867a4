// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include <doctest/doctest.h>

#include "core/binding/geodesic.h"
#include "core/bones/bone_parts.h"
#include "core/phantom/phantom.h"
#include "core/skin/weight_problems.h"
#include "tests/core/skin/painted.h"

using namespace limber;
using namespace limber::test;

namespace {

using Kind = WeightProblem::Kind;

std::vector<WeightProblem> of_kind(const std::vector<WeightProblem>& problems, Kind kind) {
  std::vector<WeightProblem> some;
  std::copy_if(problems.begin(), problems.end(), std::back_inserter(some),
               [&](const auto& p) { return p.kind == kind; });
  return some;
}

// A bar whose weights change linearly from one bone to the other.
Painted good_bar() {
  Painted painted(two_bone_bar());
  const auto& volume = painted.body.volume;
  painted.set([&](const glm::ivec3& v) {
    if (volume.at(v) == kBone) return rigid_influence(v.z < 22 ? 0 : 1);
    const double t = std::clamp((v.z - 12) / 20.0, 0.0, 1.0);
    return quantize({{0, 1 - t}, {1, t}});
  });
  return painted;
}

Armature chain(int count) {
  Armature armature;
  for (int b = 0; b < count; ++b) {
    const std::string name = "Bone" + std::to_string(b);
    armature.bones.push_back(bone_between(name.c_str(), b - 1, {15, 15, 4 + b * 10}, {15, 15, 14 + b * 10}));
  }
  return armature;
}

}  // namespace

TEST_CASE("weight problems: good weights have none") {
  const Painted painted = good_bar();
  CHECK(find_problems(painted.weighted_body(), *painted.weights).empty());
}

TEST_CASE("weight problems: a piece that no bone reaches follows, repaired, what is nearest to it") {
  SmallBody body = two_bone_bar();
  for (int z = 36; z < 38; ++z) body.volume.at({15, 15, z}) = kMuscle;  // two voxels of tissue beside the lower end
  for (int z = 2; z < 42; ++z)
    body.volume.at({13, 13, z}) = 0, body.volume.at({13, 12, z}) = 0, body.volume.at({12, 13, z}) = 0;
  Painted painted(std::move(body));
  const auto& volume = painted.body.volume;
  painted.set([&](const glm::ivec3& v) {
    if (v.x == 15) return rigid_influence(0);
    return volume.at(v) == kBone || v.z < 20 || v.z > 24 ? rigid_influence(v.z < 22 ? 0 : 1)
                                                         : quantize({{0, 25.0 - v.z}, {1, v.z - 19.0}});
  });
  const auto problems = of_kind(find_problems(painted.weighted_body(), *painted.weights), Kind::Unreached);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].voxels.size() == 2);
  CHECK(problems[0].bone == 0);
  CHECK(problems[0].place.x == doctest::Approx(30));
  CHECK(describe(problems[0], painted.body.armature) == "2 voxels that no bone reaches, assigned to Upper");
  const WeightEdit edit = repaired(painted.weighted_body(), *painted.weights, problems[0]);
  CHECK(edit.changed == 2);
  CHECK(at(painted.tissue, edit.weights, {15, 15, 36}) == rigid_influence(1));
}

TEST_CASE("weight problems: an island is found with its place and filled in from its rim") {
  Painted painted = good_bar();
  const SkinWeights good = *painted.weights;
  painted.set([&](const glm::ivec3& v) {
    const bool island = v.x >= 2 && v.x < 4 && v.y >= 5 && v.y < 9 && v.z >= 5 && v.z < 9;
    return island ? rigid_influence(1) : at(painted.tissue, good, v);
  });
  const auto problems = find_problems(painted.weighted_body(), *painted.weights);
  const auto islands = of_kind(problems, Kind::Island);
  REQUIRE(islands.size() == 1);
  CHECK(islands[0].bone == 1);
  CHECK(islands[0].voxels.size() == 2 * 4 * 4);
  CHECK(glm::length(islands[0].place - glm::dvec3(5, 13, 13)) < 3);
  const WeightEdit edit = repaired(painted.weighted_body(), *painted.weights, islands[0]);
  CHECK(edit.changed == 32);
  CHECK(edit.weights == good);
  CHECK(find_problems(painted.weighted_body(), edit.weights).empty());
  // The bone of the island is locked, which blocks the repair.
  EditScope scope;
  scope.locked = {0, 1};
  const WeightEdit blocked = repaired(painted.weighted_body(), *painted.weights, islands[0], scope);
  CHECK(blocked.changed == 0);
  CHECK(blocked.blocked_by == 1);
}

TEST_CASE("weight problems: bones far apart in the rig are found in pairs, and the lesser goes") {
  SmallBody body = two_bone_bar();
  body.armature = chain(6);
  Painted painted(std::move(body));
  painted.set([](const glm::ivec3& v) {
    if (v.z < 4) return quantize({{0, 0.6}, {5, 0.3}, {1, 0.1}});
    if (v.z < 6) return quantize({{0, 0.985}, {5, 0.015}});
    return v.z == 41 ? quantize({{3, 0.5}, {5, 0.5}}) : rigid_influence(0);
  });
  const auto far = of_kind(find_problems(painted.weighted_body(), *painted.weights), Kind::FarBones);
  REQUIRE(far.size() == 2);  // far from each other: bones 0 and 5, and bones 1 and 5
  for (const WeightProblem& problem : far) CHECK(problem.voxels.size() == 2 * 12 * 12);
  CHECK(far[0].other == 5);
  EditScope scope;
  scope.rigid_bone_tissue = false;
  const WeightEdit edit = repaired(painted.weighted_body(), *painted.weights, far[0], scope);
  CHECK(at(painted.tissue, edit.weights, {5, 5, 2}).of(5) == 0);
  CHECK(of_kind(find_problems(painted.weighted_body(), edit.weights), Kind::FarBones).empty());
}

TEST_CASE("weight problems: bone that bends is found and made rigid with what it follows most") {
  Painted painted = good_bar();
  const SkinWeights good = *painted.weights;
  painted.set([&](const glm::ivec3& v) {
    const bool bends = v == glm::ivec3(8, 8, 8) || v == glm::ivec3(8, 8, 9);
    return bends ? quantize({{0, 0.7}, {1, 0.3}}) : at(painted.tissue, good, v);
  });
  const auto soft = of_kind(find_problems(painted.weighted_body(), *painted.weights), Kind::SoftBone);
  REQUIRE(soft.size() == 1);
  CHECK(soft[0].voxels.size() == 2);
  CHECK(soft[0].bone == 0);
  const WeightEdit edit = repaired(painted.weighted_body(), *painted.weights, soft[0]);
  CHECK(edit.weights == good);
}

TEST_CASE(
    "weight problems: bone that is rigid with another bone than it has grown on, or bends mainly with it, goes back to "
    "its own") {
  Painted painted = good_bar();
  const SkinWeights good = *painted.weights;
  const auto patch = [](const glm::ivec3& v) {
    return v.x >= 7 && v.x < 9 && v.y >= 7 && v.y < 9 && v.z >= 8 && v.z < 11;
  };
  for (const Influence& wrong : {rigid_influence(1), quantize({{0, 0.2}, {1, 0.8}})}) {
    painted.set([&](const glm::ivec3& v) { return patch(v) ? wrong : at(painted.tissue, good, v); });
    const auto soft = of_kind(find_problems(painted.weighted_body(), *painted.weights), Kind::SoftBone);
    REQUIRE(soft.size() == 1);
    CHECK(soft[0].voxels.size() == 2 * 2 * 3);
    CHECK(soft[0].bone == 0);
    CHECK(describe(soft[0], painted.body.armature) == "12 voxels of bone not rigid with Upper");
    CHECK(repaired(painted.weighted_body(), *painted.weights, soft[0]).weights == good);
  }
}

TEST_CASE("weight problems: a small bone with air or flesh all around stays with what it follows") {
  Painted painted = good_bar();
  auto& volume = painted.body.volume;
  // Cuts off the end of the lower bone by a slice of flesh.
  for (int y = 0; y < volume.grid.size.y; ++y)
    for (int x = 0; x < volume.grid.size.x; ++x)
      if (volume.at({x, y, 36}) == kBone) volume.at({x, y, 36}) = kMuscle;
  painted.set([&](const glm::ivec3& v) {
    return volume.at(v) == kBone && v.z > 40 ? rigid_influence(0) : rigid_influence(v.z < 22 ? 0 : 1);
  });
  for (int z = 39; z <= 40; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x)
        if (volume.at({x, y, z}) == kBone) volume.at({x, y, z}) = kMuscle;
  CHECK(of_kind(find_problems(painted.weighted_body(), *painted.weights), Kind::SoftBone).empty());
}

TEST_CASE("weight problems: the search can be cancelled") {
  const Painted painted = good_bar();
  Progress stop;
  stop.cancel();
  CHECK_THROWS_AS(find_problems(painted.weighted_body(), *painted.weights, {}, stop), Cancelled);
}

TEST_CASE("weight problems: a clean cut through flesh is steep, and smooth once repaired") {
  Painted painted = good_bar();
  const auto& volume = painted.body.volume;
  painted.set([&](const glm::ivec3& v) { return rigid_influence(v.z < 22 ? 0 : 1); });
  const auto problems = find_problems(painted.weighted_body(), *painted.weights);
  const auto steep = of_kind(problems, Kind::Steep);
  REQUIRE(steep.size() == 1);
  CHECK(steep[0].voxels.size() == 2 * 12 * 12);
  CHECK(steep[0].bone + steep[0].other == 1);
  CHECK(steep[0].place.z == doctest::Approx(43).epsilon(0.03));
  const WeightEdit edit = repaired(painted.weighted_body(), *painted.weights, steep[0]);
  CHECK(edit.changed > 0);
  CHECK(of_kind(find_problems(painted.weighted_body(), edit.weights), Kind::Steep).empty());
  painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    if (volume.at(v) == kBone || v.z < 18 || v.z > 25)
      CHECK(at(painted.tissue, edit.weights, v) == at(painted.tissue, *painted.weights, v));
  });
}

TEST_CASE("weight problems: a whole arm with computed weights has rigid bones and nothing unreached") {
  const Phantom arm = make_arm_phantom(5);
  const TissueVoxels tissue(arm.volume);
  const BoneParts parts = split_bones(arm.volume, tissue, arm.tissues, arm.armature);
  const SkinWeights weights = bind_geodesic(arm.volume, tissue, arm.armature, parts);
  const auto problems = find_problems({arm.volume, tissue, arm.tissues, arm.armature}, weights);
  CHECK(of_kind(problems, Kind::SoftBone).empty());
  CHECK(of_kind(problems, Kind::Unreached).empty());
  for (std::size_t i = 1; i < problems.size(); ++i) CHECK(problems[i - 1].kind <= problems[i].kind);
}
