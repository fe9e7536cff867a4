// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/phantom/phantom.h"
#include "core/skin/weight_edits.h"
#include "tests/core/skin/painted.h"

using namespace limber;
using namespace limber::test;

namespace {

Painted random_arm(double spacing, unsigned seed) {
  Phantom arm = make_arm_phantom(spacing);
  const int bones = static_cast<int>(arm.armature.bones.size());
  Painted painted({arm.volume, arm.tissues, arm.armature});
  std::mt19937 random(seed);
  painted.set([&](const glm::ivec3&) {
    std::vector<std::pair<int, double>> some;
    for (int i = 0; i < 1 + static_cast<int>(random() % 4); ++i)
      some.emplace_back((random() % 4 + i * 4) % bones, 1 + random() % 100);
    return quantize(some);
  });
  return painted;
}

// Sets weights that fall exponentially with the distance from each bone, to 1/e at `width` mm.
void blend_along_bones(Painted& painted, double width) {
  const AffineTransform world = world_from_voxel(painted.body.volume.grid);
  painted.set([&](const glm::ivec3& v) {
    std::vector<std::pair<int, double>> some;
    for (int b = 0; b < std::ssize(painted.body.armature.bones); ++b)
      some.emplace_back(b, std::exp(-distance_to_bone(painted.body.armature.bones[b], world * glm::dvec3(v)) / width));
    return quantize(some);
  });
}

double mean_difference(const SkinWeights& a, const SkinWeights& b) {
  double sum = 0;
  for (std::int64_t c = 0; c < a.chunk_count(); ++c)
    for (std::size_t i = 0; i < a.chunk(c).size(); ++i)
      for (int bone = 0; bone < std::ssize(a.bones()); ++bone)
        sum += std::abs(a.chunk(c)[i].of(bone) - b.chunk(c)[i].of(bone)) / 2;
  return sum / double(a.size());
}

}  // namespace

TEST_CASE(
    "weight edits: whatever is done, sums stay exact, locks and bone tissue keep every bit, and counts are true") {
  std::mt19937 random(1);
  const Painted painted = random_arm(6, 1);
  const WeightedBody body = painted.weighted_body();
  const SkinWeights& before = *painted.weights;
  const int bones = static_cast<int>(painted.body.armature.bones.size());
  const std::vector<TissueKind> kinds = painted.body.tissues.kinds();
  for (int round = 0; round < 44; ++round) {
    EditScope scope;
    scope.locked.assign(bones, 0);
    for (auto& lock : scope.locked) lock = random() % 4 == 0;
    if (random() % 2)
      scope.region = region_where(painted.tissue, [](std::int64_t, const glm::ivec3& v) { return v.z % 3 != 0; });
    const std::vector<int> one{static_cast<int>(random() % bones)}, two{one[0], (one[0] + 3) % bones};
    const std::vector<int>& group = random() % 2 ? one : two;
    const double value = 0.01 * double(random() % 101);
    const auto edit = [&]() -> WeightEdit {
      switch (round % 11) {
        case 0: return flooded(body, before, group, static_cast<Flood>(random() % 4), value, 0.7, scope);
        case 1: return with_gradient(body, before, group, {{0, 0, 0}, {20, 30, 200}, random() % 2 == 0}, 0.8, scope);
        case 2: return smoothed(body, before, 2, value, scope);
        case 3: return copied(body, before, two[0], two[1], static_cast<Copy>(random() % 4), scope);
        case 4: return limited(body, before, 1 + random() % 3, scope);
        case 5: return pruned(body, before, value / 2, scope);
        case 6: return in_steps(body, before, 1 + random() % 10, scope);
        case 7: return with_levels(body, before, one[0], {0.1, 0.8, 1.5, 0, 1}, scope);
        case 8: return mirrored(body, before, {{{0, 0, 100}, {0, 0, 1}}, 30}, scope);
        case 9: return transferred(body, before, {body.volume, body.tissue, body.armature, before}, scope);
        default: return flooded(body, before, one, Flood::Set, 1, 1, scope);
      }
    }();
    std::int64_t changed = 0, moved = 0, in_bone = 0, outside = 0, unsound = 0;
    for (std::int64_t b = 0; b < before.chunk_count(); ++b) {
      if (edit.weights.shared_chunk(b) == before.shared_chunk(b)) continue;
      painted.tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
        const std::int64_t i = place - painted.tissue.bricks()[b].first;
        const Influence &was = before.chunk(b)[i], &is = edit.weights.chunk(b)[i];
        changed += was != is;
        in_bone += was != is && is_bone(kinds[body.volume.at(v)]);
        outside += was != is && !scope.region.empty() && !scope.region[place];
        for (int k = 0; k < bones; ++k) moved += scope.locked[k] && was.of(k) != is.of(k);
        unsound += std::accumulate(is.weight.begin(), is.weight.end(), 0) != kFullWeight;
      });
    }
    CHECK(changed == edit.changed);
    CHECK(in_bone + outside + moved + unsound == 0);
    CHECK((edit.blocked > 0) == (edit.blocked_by >= 0));
    if (edit.blocked_by >= 0) CHECK(scope.locked[edit.blocked_by] == 1);
  }
}

TEST_CASE("weight edits: the same for one and two threads, and nothing is copied that does not change") {
  const Painted painted = random_arm(6, 2);
  const auto run = [&](int threads) {
    const ThreadCount count(threads);
    return smoothed(painted.weighted_body(), *painted.weights, 3).weights;
  };
  CHECK(run(1) == run(2));
  const WeightEdit none = flooded(painted.weighted_body(), *painted.weights, std::vector<int>{1}, Flood::Add, 0);
  CHECK(none.changed == 0);
  for (std::int64_t b = 0; b < none.weights.chunk_count(); ++b)
    CHECK(none.weights.shared_chunk(b) == painted.weights->shared_chunk(b));
}

TEST_CASE("weight edits: a flood sets what it says everywhere, a label goes to a bone") {
  Painted painted(two_bone_bar());
  painted.set([](const glm::ivec3&) { return quantize({{0, 0.75}, {1, 0.25}}); });
  const WeightedBody body = painted.weighted_body();
  const std::vector<int> bone{1};
  const glm::ivec3 flesh(2, 2, 20), inner(8, 8, 8);
  const auto flooded_to = [&](Flood kind, double value) {
    return at(painted.tissue, flooded(body, *painted.weights, bone, kind, value).weights, flesh).of(1);
  };
  CHECK(flooded_to(Flood::Set, 0.5) == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(flooded_to(Flood::Add, 0.5) == doctest::Approx(0.75).epsilon(1e-4));
  CHECK(flooded_to(Flood::Subtract, 0.5) == 0);
  CHECK(flooded_to(Flood::Multiply, 2) == doctest::Approx(0.5).epsilon(1e-4));
  EditScope scope;
  scope.region = region_of_label(body.volume, body.tissue, kBone);
  CHECK(flooded(body, *painted.weights, bone, Flood::Set, 1, 1, scope).changed == 0);
  scope.rigid_bone_tissue = false;
  const WeightEdit given = flooded(body, *painted.weights, bone, Flood::Set, 1, 1, scope);
  CHECK(given.changed == std::count(scope.region.begin(), scope.region.end(), 1));
  CHECK(at(painted.tissue, given.weights, inner) == rigid_influence(1));
  CHECK(at(painted.tissue, given.weights, flesh).of(1) == doctest::Approx(0.25).epsilon(1e-4));
  scope.locked = {0, 1};
  const WeightEdit blocked = flooded(body, *painted.weights, bone, Flood::Set, 1, 1, scope);
  CHECK(blocked.changed == 0);
  CHECK(blocked.blocked > 0);
  CHECK(blocked.blocked_by == 1);
}

TEST_CASE("weight edits: gradients fall along a line or from a point outwards") {
  Painted painted(two_bone_bar());
  const WeightedBody body = painted.weighted_body();
  const std::vector<int> bone{1};
  const SkinWeights line = with_gradient(body, *painted.weights, bone, {{0, 0, 20}, {0, 0, 60}, false, 0, 1}).weights;
  for (int z = 2; z < 42; ++z)
    CHECK(at(painted.tissue, line, {3, 2, z}).of(1) ==
          doctest::Approx(std::clamp((2.0 * z - 20) / 40, 0.0, 1.0)).epsilon(1e-3));
  const glm::dvec3 from(6, 6, 40);
  const SkinWeights round = with_gradient(body, *painted.weights, bone, {from, {6, 6, 60}, true, 1, 0.1}).weights;
  for (const glm::ivec3 v : {glm::ivec3(3, 3, 20), glm::ivec3(2, 5, 24), glm::ivec3(3, 3, 40)}) {
    const double share = std::min(1.0, glm::length(glm::dvec3(v) * 2.0 - from) / 20);
    CHECK(at(painted.tissue, round, v).of(1) == doctest::Approx(1 - 0.9 * share).epsilon(1e-3));
  }
}

TEST_CASE("weight edits: a part of the tissue hangs together through faces, all of it or of one label") {
  SmallBody body = two_bone_bar();
  const TissueVoxels tissue(body.volume);
  const TissueRegion bone = connected_part(body.volume, tissue, {8, 8, 8}, Part::Label);
  const TissueRegion all = connected_part(body.volume, tissue, {8, 8, 8}, Part::Tissue);
  CHECK(std::count(bone.begin(), bone.end(), 1) == 4 * 4 * 17);
  CHECK(std::count(all.begin(), all.end(), 1) == tissue.size());
  const TissueRegion none = connected_part(body.volume, tissue, {0, 0, 0}, Part::Tissue);
  CHECK(std::count(none.begin(), none.end(), 1) == 0);
}

TEST_CASE("weight edits: weights are copied, moved and swapped between bones, swapped twice they are what they were") {
  const Painted painted = random_arm(6, 3);
  const WeightedBody body = painted.weighted_body();
  EditScope scope;
  scope.rigid_bone_tissue = false;
  const SkinWeights& before = *painted.weights;
  const SkinWeights swapped = copied(body, before, 1, 2, Copy::Swap, scope).weights;
  const SkinWeights moved = copied(body, before, 1, 2, Copy::Move, scope).weights;
  const SkinWeights replaced = copied(body, before, 1, 2, Copy::Replace, scope).weights;
  int wrong = 0;
  for (std::int64_t b = 0; b < before.chunk_count(); ++b)
    for (std::size_t i = 0; i < before.chunk(b).size(); ++i) {
      const Influence& was = before.chunk(b)[i];
      wrong += swapped.chunk(b)[i].of(1) != was.of(2) || swapped.chunk(b)[i].of(2) != was.of(1);
      wrong += moved.chunk(b)[i].of(1) != 0 || std::abs(moved.chunk(b)[i].of(2) - was.of(1) - was.of(2)) > 1e-9;
      wrong += replaced.chunk(b)[i].of(2) != was.of(1);
      for (int k = 3; k < std::ssize(before.bones()); ++k) wrong += swapped.chunk(b)[i].of(k) != was.of(k);
    }
  CHECK(wrong == 0);
  CHECK(mean_difference(copied(body, swapped, 1, 2, Copy::Swap, scope).weights, before) == 0);
}

TEST_CASE("weight edits: one side mirrors the other, on an asymmetric body what has no match stays and is reported") {
  Painted painted(two_sided_body());
  std::mt19937 random(4);
  painted.set([&](const glm::ivec3&) {
    return quantize({{0, 1 + random() % 9}, {1, 1 + random() % 9}, {2, random() % 9}});
  });
  const MirrorPlane plane = mirror_plane(painted.body.armature);
  const double sign = plane.normal.x;
  const MirrorEdit edit = mirrored(painted.weighted_body(), *painted.weights, {plane, 3});
  CHECK(edit.unmatched.empty());
  int wrong = 0;
  painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const Influence &is = at(painted.tissue, edit.weights, v), &was = at(painted.tissue, *painted.weights, v);
    if ((v.x - 15.5) * sign <= 0) {
      wrong += is != was;
      return;
    }
    const Influence& other = at(painted.tissue, *painted.weights, {31 - v.x, v.y, v.z});
    wrong += is.of(0) != other.of(0) || is.of(1) != other.of(2) || is.of(2) != other.of(1);
  });
  CHECK(wrong == 0);

  // Makes the source side four voxels shorter. A voxel without tissue at its mirrored position takes the weights of the
  // nearest tissue within 4.5 mm; two layers of 10 x 10 voxels are further away.
  SmallBody short_arm = two_sided_body();
  const int side = sign > 0 ? 0 : 1;
  for (int z = 0; z < 14; ++z)
    for (int y = 0; y < 14; ++y)
      for (int i = 2; i < 6; ++i) short_arm.volume.at({side == 0 ? i : 31 - i, y, z}) = 0;
  Painted asymmetric(std::move(short_arm));
  asymmetric.set([&](const glm::ivec3&) { return quantize({{0, 1 + random() % 9}, {1, 1 + random() % 9}}); });
  const MirrorEdit partly = mirrored(asymmetric.weighted_body(), *asymmetric.weights, {plane, 4.5});
  CHECK(partly.unmatched.size() == 2 * 10 * 10);
  std::vector<std::uint8_t> is_unmatched(asymmetric.tissue.size(), 0);
  for (const auto place : partly.unmatched) is_unmatched[place] = 1;
  asymmetric.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (is_unmatched[place])
      wrong += at(asymmetric.tissue, partly.weights, v) != at(asymmetric.tissue, *asymmetric.weights, v);
  });
  CHECK(wrong == 0);
}

TEST_CASE("weight edits: weights of the same volume come over as they are, those of a coarser one nearly") {
  Painted fine(two_bone_bar(24, 80, 12, glm::dvec3(1))), coarse(two_bone_bar(12, 40, 6, glm::dvec3(2)));
  // Each voxel of the coarse grid covers eight voxels of the fine one.
  coarse.body.volume.grid.origin = glm::dvec3(-1.5);
  coarse.body.armature = fine.body.armature;
  blend_along_bones(fine, 8);
  EditScope scope;
  scope.rigid_bone_tissue = false;
  const WeightedBody fine_body = fine.weighted_body(), coarse_body = coarse.weighted_body();
  const SkinWeights blank(fine.weights->bones(), fine.tissue);
  const TransferSource of_fine{fine_body.volume, fine_body.tissue, fine_body.armature, *fine.weights};
  const TransferEdit same = transferred(fine_body, blank, of_fine, scope);
  CHECK(same.weights == *fine.weights);
  CHECK(same.missing.empty());

  const SkinWeights down = transferred(coarse_body, *coarse.weights, of_fine, scope).weights;
  const SkinWeights back =
      transferred(fine_body, blank, {coarse_body.volume, coarse_body.tissue, coarse_body.armature, down}, scope)
          .weights;
  const double difference = mean_difference(back, *fine.weights);
  MESSAGE("mean difference after 1 mm -> 2 mm -> 1 mm: ", difference);
  CHECK(difference < 0.01);
  CHECK(difference > 0);
}

TEST_CASE(
    "weight edits: bones that another rig lacks leave their weight to the ancestor that it has, rigs of other names "
    "are refused") {
  Painted to(two_bone_bar()), from(two_bone_bar());
  from.body.armature.bones.push_back(bone_between("Hand", 1, {15, 15, 80}, {15, 15, 90}));
  std::vector<std::string> names{"Upper", "Lower", "Hand"};
  SkinWeights source(names, from.tissue);
  for (std::int64_t b = 0; b < source.chunk_count(); ++b)
    source.set_chunk(b, SkinWeights::Influences(source.chunk(b).size(), quantize({{0, 0.5}, {2, 0.5}})));
  const WeightedBody body = to.weighted_body();
  const TransferEdit edit = transferred(body, *to.weights, {from.body.volume, from.tissue, from.body.armature, source});
  CHECK(edit.missing == std::vector<std::string>{"Hand"});
  CHECK(at(to.tissue, edit.weights, {2, 2, 20}).of(1) == doctest::Approx(0.5).epsilon(1e-4));
  for (Bone& bone : from.body.armature.bones) bone.name += "X";
  CHECK_THROWS_AS(transferred(body, *to.weights, {from.body.volume, from.tissue, from.body.armature, source}), Error);
}
