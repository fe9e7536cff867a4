// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <doctest/doctest.h>

#include "core/skin/falloff.h"
#include "core/skin/normalize.h"
#include "tests/core/skin/small_body.h"

using namespace limber;

namespace {

// Two trees of bones by parent: 0 - 1 - 2 - 3 with the branch 1 - 4 - 5, and 6 - 7.
Armature tree() {
  Armature armature;
  const int parents[] = {-1, 0, 1, 2, 1, 4, -1, 6};
  for (int b = 0; b < 8; ++b) {
    const std::string name = "Bone" + std::to_string(b);
    armature.bones.push_back(
        test::bone_between(name.c_str(), parents[b], glm::dvec3(b, 0, 0), glm::dvec3(b + 1, 0, 0)));
  }
  return armature;
}

Influence any_influence(std::mt19937& random) {
  std::vector<std::pair<int, double>> weights;
  std::vector<int> bones{0, 1, 2, 3, 4, 5, 6, 7};
  std::shuffle(bones.begin(), bones.end(), random);
  const int count = 1 + random() % 4;
  for (int i = 0; i < count; ++i) weights.emplace_back(bones[i], std::pow(10.0, -double(random() % 500) / 100));
  Influence influence = quantize(weights);
  sort_influence(influence);
  return influence;
}

BoneSet any_locks(std::mt19937& random) {
  BoneSet locked(8);
  for (auto& lock : locked) lock = random() % 3 == 0;
  return locked;
}

int weight_of(const Influence& influence, int bone) { return WeightRules::sum_of(influence, std::span(&bone, 1)); }

// Returns true if the weights are in descending order, sum to kFullWeight, name no bone twice, and name bone 0 where
// the weight is 0.
bool is_sound(const Influence& influence) {
  int sum = 0;
  for (int i = 0; i < 4; ++i) {
    sum += influence.weight[i];
    if (influence.weight[i] == 0 && influence.bone[i] != 0) return false;
    if (i > 0 && influence.weight[i] > influence.weight[i - 1]) return false;
    for (int k = 0; k < i; ++k)
      if (influence.weight[i] && influence.bone[k] == influence.bone[i]) return false;
  }
  return sum == kFullWeight;
}

// Changes an influence by a randomly chosen rule with random settings.
WeightChange any_change(std::mt19937& random, const WeightRules& rules, Influence& influence) {
  const int bone = random() % 8,
            weight = random() % 3 == 0 ? (random() % 2) * kFullWeight : static_cast<int>(random() % (kFullWeight + 1));
  switch (random() % 8) {
    case 0: return rules.set(influence, bone, weight);
    case 1: {
      const std::vector<int> group{bone, (bone + 3) % 8, (bone + 5) % 8};
      return rules.set(influence, group, weight);
    }
    case 2: {
      std::vector<std::pair<int, double>> target;
      for (int b = 0; b < 8; ++b)
        if (random() % 2) target.emplace_back(b, double(random() % 1000));
      return rules.blend(influence, target, double(random() % 101) / 100);
    }
    case 3: return rules.divide(influence, bone, (bone + 1) % 8, weight);
    case 4: return rules.limit(influence, 1 + random() % 4);
    case 5: return rules.prune(influence, random() % kFullWeight);
    case 6: return rules.quantize_to(influence, 1 + random() % 20);
    default: return rules.levels(influence, bone, {0.1, 0.9, 0.5 + random() % 3, 0, 1});
  }
}

}  // namespace

TEST_CASE("weight rules: whatever is done, sums stay exact and locked bones keep every bit") {
  std::mt19937 random(1);
  const Armature armature = tree();
  int unsound = 0, moved = 0, mute = 0, lying = 0, changes = 0;
  for (int round = 0; round < 400; ++round) {
    const BoneSet locked = any_locks(random);
    const WeightRules rules(armature, locked, round % 2 ? Normalize::All : Normalize::Unlocked, random() % 8);
    for (int i = 0; i < 200; ++i) {
      const Influence before = any_influence(random);
      Influence after = before;
      const WeightChange change = any_change(random, rules, after);
      unsound += !is_sound(after);
      for (int b = 0; b < 8; ++b) moved += locked[b] && weight_of(before, b) != weight_of(after, b);
      mute += change.changed != (after != before);
      lying += change.blocked_by >= 0 && !locked[change.blocked_by];
      changes += change.changed;
    }
  }
  CHECK(unsound == 0);
  CHECK(moved == 0);
  CHECK(mute == 0);
  CHECK(lying == 0);
  CHECK(changes > 30000);
}

TEST_CASE("weight rules: a bone gets exactly the weight it is set to, and the others keep their proportions") {
  std::mt19937 random(2);
  const WeightRules rules(tree(), {});
  for (int i = 0; i < 20000; ++i) {
    const Influence before = any_influence(random);
    Influence after = before;
    const int bone = random() % 8, weight = random() % (kFullWeight + 1);
    rules.set(after, bone, weight);
    REQUIRE(weight_of(after, bone) == weight);
    const double left_before = kFullWeight - weight_of(before, bone), left = kFullWeight - weight;
    if (left_before == 0 || (before.weight[3] && !weight_of(before, bone))) continue;
    for (int b = 0; b < 8; ++b)
      if (b != bone) REQUIRE(std::abs(weight_of(after, b) - weight_of(before, b) / left_before * left) < 2.5);
  }
}

TEST_CASE("weight rules: the short way without locks does what the long way does") {
  std::mt19937 random(3);
  Armature armature = tree();
  const WeightRules rules(armature, {});
  for (int i = 0; i < 20000; ++i) {
    const Influence before = any_influence(random);
    Influence one = before, other = before;
    const int bone = random() % 8, weight = random() % 4 ? random() % (kFullWeight + 1) : (random() % 2) * kFullWeight;
    const WeightChange a = rules.set(one, bone, weight), b = rules.set(other, std::vector<int>{bone}, weight);
    REQUIRE(one == other);
    REQUIRE(a.changed == b.changed);
  }
}

TEST_CASE("weight rules: strength 1 reaches exactly 0 and exactly 1, but for what is locked") {
  const WeightRules rules(tree(), {0, 0, 1, 0, 0, 0, 0, 0});
  Influence influence = quantize({{1, 0.5}, {2, 0.25}, {3, 0.25}});
  const int held = weight_of(influence, 2);
  CHECK(rules.set(influence, 1, kFullWeight).changed);
  CHECK(weight_of(influence, 1) == kFullWeight - held);
  CHECK(weight_of(influence, 2) == held);
  CHECK(weight_of(influence, 3) == 0);
  CHECK(!rules.set(influence, 1, kFullWeight).changed);
  CHECK(rules.set(influence, 1, kFullWeight).blocked_by == 2);
  CHECK(rules.set(influence, 1, 0).changed);
  CHECK(weight_of(influence, 1) == 0);
}

TEST_CASE(
    "weight rules: the only weight goes to the parent, else to a child, else further along the tree, else to what is "
    "near") {
  const Armature armature = tree();
  const auto heir_of_2 = [&](BoneSet locked, int nearby = -1) {
    Influence influence = rigid_influence(2);
    const WeightChange change =
        WeightRules(armature, std::move(locked), Normalize::Unlocked, nearby).set(influence, 2, 0);
    return change.changed ? int{influence.bone[0]} : -1 - change.blocked_by;
  };
  CHECK(heir_of_2({}) == 1);
  CHECK(heir_of_2({0, 1, 0, 0, 0, 0, 0, 0}) == 3);
  CHECK(heir_of_2({0, 1, 0, 1, 0, 0, 0, 0}) == 0);
  CHECK(heir_of_2({1, 1, 0, 1, 1, 0, 0, 0}) == 5);
  CHECK(heir_of_2({1, 1, 0, 1, 1, 1, 0, 0}, 7) == 7);
  CHECK(heir_of_2({1, 1, 0, 1, 1, 1, 0, 0}) == -1 - 1);  // -1 - bone: blocked by bone 1, the parent
  Influence half = rigid_influence(2);
  WeightRules(armature, {}).set(half, 2, 20000);
  CHECK(weight_of(half, 2) == 20000);
  CHECK(weight_of(half, 1) == kFullWeight - 20000);
}

TEST_CASE("weight rules: a fifth bone takes the place of the smallest that is not locked") {
  const Influence four = quantize({{0, 0.4}, {1, 0.3}, {2, 0.2}, {3, 0.1}});
  Influence influence = four;
  WeightRules(tree(), {}).set(influence, 4, 100);
  CHECK(weight_of(influence, 4) == 100);
  CHECK(weight_of(influence, 3) == 0);
  influence = four;
  WeightRules(tree(), {0, 0, 0, 1, 0, 0, 0, 0}).set(influence, 4, 100);
  CHECK(weight_of(influence, 4) == 100);
  CHECK(weight_of(influence, 3) == weight_of(four, 3));
  CHECK(weight_of(influence, 2) == 0);
  influence = four;
  const WeightChange blocked = WeightRules(tree(), {1, 1, 1, 1, 0, 0, 0, 0}).set(influence, 4, 100);
  CHECK(!blocked.changed);
  CHECK(blocked.blocked_by == 0);
  CHECK(lock_message(tree(), 0) == "Bone0 is locked");
}

TEST_CASE("weight rules: several bones are painted as one and keep their proportions") {
  const WeightRules rules(tree(), {});
  Influence influence = quantize({{0, 0.5}, {1, 0.3}, {2, 0.2}});
  const std::vector<int> group{1, 2};
  rules.set(influence, group, kFullWeight);
  CHECK(influence == quantize({{1, 0.6}, {2, 0.4}}));
  rules.set(influence, group, 10000);
  CHECK(WeightRules::sum_of(influence, group) == 10000);
  CHECK(weight_of(influence, 0) == kFullWeight - 10000);
  CHECK(weight_of(influence, 1) == doctest::Approx(6000).epsilon(0.001));
}

TEST_CASE("weight rules: with all weights making room, painted bones share too") {
  const WeightRules rules(tree(), {}, Normalize::All);
  Influence influence = quantize({{0, 0.5}, {1, 0.5}});
  rules.set(influence, 1, kFullWeight);
  CHECK(influence.of(1) == doctest::Approx(1 / 1.5).epsilon(1e-3));
}

TEST_CASE("weight rules: blending goes all the way, none of it, and to what it is already") {
  std::mt19937 random(4);
  const WeightRules rules(tree(), {});
  for (int i = 0; i < 5000; ++i) {
    const Influence from = any_influence(random), to = any_influence(random);
    std::vector<std::pair<int, double>> target;
    for (int k = 0; k < 4; ++k) target.emplace_back(to.bone[k], to.weight[k]);
    Influence influence = from;
    CHECK(!rules.blend(influence, target, 0).changed);
    rules.blend(influence, target, 1);
    REQUIRE(influence == to);
    REQUIRE(!rules.blend(influence, target, 0.37).changed);
  }
}

TEST_CASE("weight rules: blending with the bones that a voxel has is the same in whatever order they are told") {
  std::mt19937 random(5);
  const WeightRules rules(tree(), {});
  int changed = 0;
  for (int round = 0; round < 5000; ++round) {
    const Influence before = any_influence(random);
    std::vector<std::pair<int, double>> target;
    for (int i = 0; i < 4; ++i)
      if (before.weight[i]) target.emplace_back(before.bone[i], 1 + random() % (random() % 2 ? 6 * kFullWeight : 2));
    const double amount = random() % 4 == 0 ? 1 : double(random() % 1001) / 1000;
    Influence one = before, other = before;
    const WeightChange first = rules.blend(one, target, amount);
    std::reverse(target.begin(), target.end());
    const WeightChange second = rules.blend(other, target, amount);
    REQUIRE(one == other);
    REQUIRE(first.changed == second.changed);
    REQUIRE(is_sound(one));
    changed += first.changed;
  }
  CHECK(changed > 2000);
}

TEST_CASE("weight rules: limits, pruning and steps do what they say") {
  std::mt19937 random(5);
  const WeightRules rules(tree(), {});
  for (int i = 0; i < 5000; ++i) {
    const Influence before = any_influence(random);
    Influence influence = before;
    rules.limit(influence, 2);
    REQUIRE(influence.weight[2] == 0);
    influence = before;
    rules.prune(influence, 700);
    for (const int weight : influence.weight) REQUIRE((weight == 0 || weight >= 700));
    influence = before;
    rules.quantize_to(influence, 5);
    for (const int weight : influence.weight) REQUIRE(weight % (kFullWeight / 5) == 0);
    influence = before;
    rules.levels(influence, before.bone[0], {0.25, 0.75, 1, 0, 1});
    const double w = before.of(before.bone[0]);
    REQUIRE(influence.of(before.bone[0]) == doctest::Approx(std::clamp(2 * w - 0.5, 0.0, 1.0)).epsilon(1e-4));
  }
}

TEST_CASE("weight rules: what is shared out adds up, in proportion") {
  std::mt19937 random(6);
  for (int i = 0; i < 20000; ++i) {
    std::vector<double> share(1 + random() % 5);
    for (double& s : share) s = random() % 1000;
    share[0] += 1;
    std::vector<int> out(share.size());
    const int total = i % 2 ? random() % 8 : random() % 70000;
    distribute(share, total, out);
    CHECK(std::accumulate(out.begin(), out.end(), 0) == total);
    const double sum = std::accumulate(share.begin(), share.end(), 0.0);
    for (std::size_t k = 0; k < out.size(); ++k) {
      REQUIRE(out[k] >= 0);
      REQUIRE(std::abs(out[k] - share[k] / sum * total) <= double(share.size()));
    }
  }
}

TEST_CASE(
    "falloff: every shape falls from one to zero, a constant one not at all, and a curve goes through its points") {
  for (const auto shape :
       {FalloffShape::Smooth, FalloffShape::Sphere, FalloffShape::Root, FalloffShape::Sharp, FalloffShape::Linear}) {
    const Falloff falloff(shape);
    CHECK(falloff(0) == 1);
    CHECK(falloff(1) == 0);
    for (int i = 1; i <= 1000; ++i) CHECK(falloff(i / 1000.0f) <= falloff((i - 1) / 1000.0f));
  }
  CHECK(Falloff(FalloffShape::Constant)(1) == 1);
  CHECK(Falloff(FalloffShape::Linear)(0.3f) == doctest::Approx(0.7));
  CHECK(Falloff(FalloffShape::Smooth)(0.5f) == doctest::Approx(0.5));
  const std::vector<glm::dvec2> points{{0.125, 1}, {0.5, 0.2}, {0.75, 0.2}, {1, 0}};
  const Falloff curve(points);
  for (const glm::dvec2& p : points) CHECK(curve(static_cast<float>(p.x)) == doctest::Approx(p.y));
  CHECK(curve(0) == 1);
  for (int i = 0; i <= 100; ++i) CHECK(curve(0.5f + 0.0025f * i) == doctest::Approx(0.2));
}
