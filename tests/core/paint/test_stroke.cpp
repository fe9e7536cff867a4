// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/phantom/phantom.h"
#include "tests/core/skin/painted.h"

using namespace limber;
using namespace limber::test;

namespace {

Painted bar() { return Painted(two_bone_bar(12, 40, 6)); }

StrokeSettings brush_of(BrushKind kind, double radius, int bone = 1) {
  StrokeSettings settings;
  settings.brush.kind = kind;
  settings.brush.radius = radius;
  settings.brush.falloff = FalloffShape::Constant;
  settings.bones = {bone};
  return settings;
}

SkinWeights one_dab(const Painted& painted, const StrokeSettings& settings, const glm::dvec3& point) {
  Stroke stroke(painted.weighted_body(), painted.weights, settings);
  stroke.to(point);
  return stroke.finish();
}

Painted two_sided() { return Painted(two_sided_body()); }

}  // namespace

TEST_CASE("stroke: each brush does to the painted bone what it says") {
  Painted painted = bar();
  painted.set([](const glm::ivec3&) { return quantize({{0, 0.6}, {1, 0.4}}); });
  const glm::ivec3 middle(2, 2, 22);
  const glm::dvec3 point(4, 4, 44);
  const auto after = [&](BrushKind kind, double strength, double value) {
    StrokeSettings settings = brush_of(kind, 5);
    settings.brush.strength = strength;
    settings.brush.value = value;
    return at(painted.tissue, one_dab(painted, settings, point), middle).of(1);
  };
  CHECK(after(BrushKind::Add, 0.25, 0) == doctest::Approx(0.65).epsilon(1e-4));
  CHECK(after(BrushKind::Add, 1, 0) == 1);
  CHECK(after(BrushKind::Subtract, 0.25, 0) == doctest::Approx(0.15).epsilon(1e-4));
  CHECK(after(BrushKind::Subtract, 1, 0) == 0);
  CHECK(after(BrushKind::Set, 1, 0.9) == doctest::Approx(0.9).epsilon(1e-4));
  CHECK(after(BrushKind::Set, 0.5, 1) == doctest::Approx(0.7).epsilon(1e-4));
  CHECK(after(BrushKind::Multiply, 1, 0.5) == doctest::Approx(0.2).epsilon(1e-4));
  CHECK(after(BrushKind::Multiply, 0.5, 2) == doctest::Approx(0.6).epsilon(1e-4));
}

TEST_CASE("stroke: relative to locks, what a locked bone leaves counts as the whole, and the lock keeps every bit") {
  SmallBody body = two_bone_bar(12, 40, 6);
  body.armature.bones.push_back(bone_between("Hand", 1, {15, 15, 70}, {15, 15, 84}));
  Painted painted(std::move(body));
  painted.set([](const glm::ivec3&) { return quantize({{0, 0.4}, {1, 0.2}, {2, 0.4}}); });
  const glm::ivec3 middle(2, 2, 22);
  const auto after = [&](BrushKind kind, double strength, double value) {
    StrokeSettings settings = brush_of(kind, 5);
    settings.brush.strength = strength;
    settings.brush.value = value;
    settings.locked = {1, 0, 0};
    settings.relative_to_locks = true;
    const Influence made = at(painted.tissue, one_dab(painted, settings, {4, 4, 44}), middle);
    CHECK(made.of(0) == at(painted.tissue, *painted.weights, middle).of(0));
    return made.of(1);
  };
  CHECK(after(BrushKind::Set, 1, 0.5) == doctest::Approx(0.3).epsilon(1e-4));
  CHECK(after(BrushKind::Set, 1, 1) == doctest::Approx(0.6).epsilon(1e-4));
  CHECK(after(BrushKind::Add, 0.5, 0) == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(after(BrushKind::Subtract, 0.25, 0) == doctest::Approx(0.05).epsilon(1e-4));
  CHECK(after(BrushKind::Multiply, 1, 2) == doctest::Approx(0.4).epsilon(1e-4));
}

TEST_CASE(
    "stroke: whatever is painted, sums stay exact, locks and bone tissue keep every bit, and untouched bricks are "
    "shared") {
  std::mt19937 random(1);
  Phantom arm = make_arm_phantom(6);
  const int bones = static_cast<int>(arm.armature.bones.size());
  Painted painted({arm.volume, arm.tissues, arm.armature});
  painted.set([&](const glm::ivec3&) {
    std::vector<std::pair<int, double>> some;
    for (int i = 0; i < 1 + static_cast<int>(random() % 4); ++i)
      some.emplace_back((random() % 4 + i * 4) % bones, 1 + random() % 100);
    return quantize(some);
  });
  std::int64_t changed = 0, moved = 0, in_bone = 0, shared = 0, unsound = 0;
  const std::vector<TissueKind> kinds = arm.tissues.kinds();
  for (int round = 0; round < 54; ++round) {
    StrokeSettings settings =
        brush_of(static_cast<BrushKind>(round % 9), 15 + random() % 20, 1 + random() % (bones - 1));
    settings.brush.falloff = FalloffShape::Smooth;
    settings.brush.accumulate = random() % 2;
    settings.brush.all_bones = random() % 3;
    settings.brush.strength = 0.3 + 0.01 * double(random() % 71);
    settings.brush.value = 0.01 * double(random() % 150);
    settings.brush.distance = random() % 2 ? BrushDistance::Geodesic : BrushDistance::Euclidean;
    settings.locked.assign(bones, 0);
    for (auto& lock : settings.locked) lock = random() % 4 == 0;
    if (random() % 2) settings.mirror = mirror_plane(arm.armature);
    if (random() % 3 == 0) settings.bones.push_back((settings.bones[0] + 1) % bones);
    Stroke stroke(painted.weighted_body(), painted.weights, settings);
    const Bone& bone = arm.armature.bones[random() % bones];
    stroke.to(bone.head);
    stroke.to(bone.tail, 0.7);
    const SkinWeights after = stroke.finish();
    for (std::int64_t b = 0; b < after.chunk_count(); ++b) {
      if (after.shared_chunk(b) == painted.weights->shared_chunk(b)) {
        ++shared;
        continue;
      }
      painted.tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
        const std::int64_t i = place - painted.tissue.bricks()[b].first;
        const Influence &was = painted.weights->chunk(b)[i], &is = after.chunk(b)[i];
        changed += was != is;
        in_bone += was != is && is_bone(kinds[arm.volume.at(v)]);
        for (int k = 0; k < bones; ++k) moved += settings.locked[k] && was.of(k) != is.of(k);
        int sum = 0;
        for (int k = 0; k < 4; ++k) sum += is.weight[k];
        unsound += sum != kFullWeight;
      });
    }
  }
  CHECK(changed > 10000);
  CHECK(shared > 1000);
  CHECK(unsound == 0);
  CHECK(moved == 0);
  CHECK(in_bone == 0);
}

TEST_CASE("stroke: without accumulation going over a place again changes nothing more, with it, it does") {
  const Painted painted = bar();
  for (const auto kind : {BrushKind::Add, BrushKind::Smooth, BrushKind::Average}) {
    StrokeSettings settings = brush_of(kind, 12, 1);
    settings.brush.falloff = FalloffShape::Smooth;
    settings.brush.strength = 0.3;
    Painted mixed = bar();
    mixed.set([](const glm::ivec3& v) { return v.z < 22 ? rigid_influence(0) : quantize({{0, 0.5}, {1, 0.5}}); });
    const Painted& on = kind == BrushKind::Add ? painted : mixed;
    const SkinWeights once = one_dab(on, settings, {6, 6, 44});
    Stroke stroke(on.weighted_body(), on.weights, settings);
    for (int i = 0; i < 40; ++i) stroke.to({6, 6, 44 + 0.001 * i});
    stroke.to({6, 6, 44});
    for (int i = 0; i < 10; ++i) {
      stroke.to({6, 6, 44 + (i % 2) * 3.01});
      stroke.to({6, 6, 44});
    }
    CHECK(stroke.dab_count() > 10);
    CHECK(at(on.tissue, stroke.weights(), {3, 3, 22}) == at(on.tissue, once, {3, 3, 22}));

    settings.brush.accumulate = true;
    Stroke growing(on.weighted_body(), on.weights, settings);
    for (int i = 0; i < 10; ++i) {
      growing.to({6, 6, 44 + (i % 2) * 3.01});
      growing.to({6, 6, 44});
    }
    CHECK(at(on.tissue, growing.weights(), {3, 3, 22}) != at(on.tissue, once, {3, 3, 22}));
  }
}

TEST_CASE("stroke: the same for one and two threads") {
  Phantom arm = make_arm_phantom(4);
  Painted painted({arm.volume, arm.tissues, arm.armature});
  std::mt19937 random(2);
  const int bones = static_cast<int>(arm.armature.bones.size());
  painted.set([&](const glm::ivec3&) {
    const int first = static_cast<int>(random() % bones);
    return quantize({{first, 0.5}, {(first + 1) % bones, 0.3}, {(first + 2 + random() % (bones - 2)) % bones, 0.2}});
  });
  for (int kind = 0; kind < 9; ++kind) {
    StrokeSettings settings = brush_of(static_cast<BrushKind>(kind), 40, 2);
    settings.brush.value = 0.5;
    settings.brush.accumulate = kind % 2 == 0;
    settings.locked.assign(bones, 0);
    settings.locked[1] = kind == 4 || kind == 0;
    const auto run = [&](int threads) {
      const ThreadCount count(threads);
      Stroke stroke(painted.weighted_body(), painted.weights, settings);
      stroke.to(arm.armature.bones[2].head);
      stroke.to(arm.armature.bones[2].tail);
      return std::tuple(stroke.weights(), stroke.blocked_count(), stroke.blocked_by());
    };
    const auto one = run(1);
    CHECK(one == run(2));
    CHECK(std::get<0>(one) != *painted.weights);
  }
}

TEST_CASE("stroke: with a mirror both sides of a symmetric body stay mirror images") {
  const Painted painted = two_sided();
  for (const bool accumulate : {false, true})
    for (const auto kind : {BrushKind::Add, BrushKind::Set, BrushKind::Smooth, BrushKind::Smear}) {
      Painted mixed = two_sided();
      mixed.set([](const glm::ivec3& v) {
        const int side = v.x < 16 ? 2 : 1, out = v.x < 16 ? 15 - v.x : v.x - 16;
        return quantize({{0, 1 + (v.y * 7 + v.z * 3 + out) % 5}, {side, 1 + out % 3}});
      });
      StrokeSettings settings = brush_of(kind, 9, 1);
      settings.brush.falloff = FalloffShape::Smooth;
      settings.brush.strength = 0.6;
      settings.brush.value = 0.8;
      settings.brush.accumulate = accumulate;
      settings.mirror = mirror_plane(mixed.body.armature);
      Stroke stroke(mixed.weighted_body(), mixed.weights, settings);
      stroke.to({50, 14, 14});
      stroke.to({42, 16, 12});
      const SkinWeights after = stroke.finish();
      CHECK(after != *mixed.weights);
      double worst = 0;
      mixed.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
        const Influence &here = at(mixed.tissue, after, v), &there = at(mixed.tissue, after, {31 - v.x, v.y, v.z});
        worst = std::max({worst, std::abs(here.of(1) - there.of(2)), std::abs(here.of(0) - there.of(0))});
      });
      CHECK(worst < 3.0 / kFullWeight);
    }
  // Tests a dab across the mirror plane, and without accumulation.
  StrokeSettings settings = brush_of(BrushKind::Add, 14, 1);
  settings.brush.falloff = FalloffShape::Linear;
  settings.brush.strength = 0.8;
  settings.mirror = mirror_plane(painted.body.armature);
  const SkinWeights after = one_dab(painted, settings, {36, 14, 14});
  double worst = 0;
  painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    worst = std::max(
        worst, std::abs(at(painted.tissue, after, v).of(1) - at(painted.tissue, after, {31 - v.x, v.y, v.z}).of(2)));
  });
  CHECK(worst < 3.0 / kFullWeight);
}

TEST_CASE("stroke: a joint capsule blends the two bones over the width asked for, and needs a joint") {
  Painted painted = bar();
  painted.set([](const glm::ivec3& v) { return rigid_influence(v.z < 22 ? 0 : 1); });
  StrokeSettings settings = brush_of(BrushKind::JointCapsule, 60);
  settings.brush.blend_mm = 24;
  settings.brush.distance = BrushDistance::Euclidean;
  const SkinWeights after = one_dab(painted, settings, painted.body.armature.bones[1].head);
  const double joint = painted.body.armature.bones[1].head.z;
  double worst = 0;
  for (int z = 2; z < 42; ++z) {
    const double t = std::clamp((2.0 * z - joint) / 24 + 0.5, 0.0, 1.0);
    worst = std::max(worst, std::abs(at(painted.tissue, after, {2, 5, z}).of(1) - t * t * (3 - 2 * t)));
  }
  CHECK(worst < 1e-4);
  settings.bones = {0};
  CHECK_THROWS_AS(Stroke(painted.weighted_body(), painted.weights, settings), Error);
  settings.bones = {1};
  settings.locked = {1, 0};
  Stroke locked(painted.weighted_body(), painted.weights, settings);
  locked.to(painted.body.armature.bones[1].head);
  CHECK(locked.empty());
  CHECK(locked.blocked_by() == 0);
}

TEST_CASE(
    "stroke: smoothing evens weights out, sharpening does the opposite, averaging makes one of all, smearing drags "
    "along") {
  Painted painted = bar();
  painted.set([](const glm::ivec3& v) { return v.z < 22 ? rigid_influence(0) : quantize({{0, 0.2}, {1, 0.8}}); });
  const auto step = [&](const SkinWeights& weights) {
    return at(painted.tissue, weights, {2, 2, 22}).of(1) - at(painted.tissue, weights, {2, 2, 21}).of(1);
  };
  for (const bool all_bones : {true, false}) {
    StrokeSettings settings = brush_of(BrushKind::Smooth, 12);
    settings.brush.all_bones = all_bones;
    const double smooth = step(one_dab(painted, settings, {4, 4, 43}));
    CHECK(smooth < 0.6);
    CHECK(smooth > 0.08);
    settings.brush.kind = BrushKind::Sharpen;
    CHECK(step(one_dab(painted, settings, {4, 4, 43})) > 0.85);
    settings.brush.kind = BrushKind::Average;
    const SkinWeights average = one_dab(painted, settings, {4, 4, 43});
    CHECK(std::abs(step(average)) < 1e-4);
    CHECK(at(painted.tissue, average, {2, 2, 22}).of(1) == doctest::Approx(0.4).epsilon(0.1));
    settings.brush.kind = BrushKind::Smear;
    Stroke smear(painted.weighted_body(), painted.weights, settings);
    smear.to({4, 4, 36});
    smear.to({4, 4, 60});
    CHECK(at(painted.tissue, smear.weights(), {2, 2, 22}).of(1) < 0.01);
    CHECK(at(painted.tissue, smear.weights(), {2, 2, 20}).of(1) == 0);
  }
}

TEST_CASE("stroke: no brush reaches the finger beside it, nor tissue that is not allowed") {
  SmallBody hand;
  hand.volume.grid.size = {40, 12, 80};
  hand.volume.voxels.assign(hand.volume.grid.voxel_count(), 0);
  for (int z = 4; z < 76; ++z)
    for (int y = 3; y < 9; ++y)
      for (int x = 6; x < 19; ++x)
        if (x != 12 || z >= 66) hand.volume.at({x, y, z}) = y < 6 ? kMuscle : 3;
  hand.tissues = muscle_and_bone();
  hand.armature.bones = {bone_between("Palm", -1, {12, 6, 76}, {12, 6, 66}),
                         bone_between("Finger", 0, {9, 6, 66}, {9, 6, 4})};
  Painted painted(std::move(hand));
  std::mt19937 random(3);
  painted.set([&](const glm::ivec3&) { return quantize({{0, 1 + random() % 9}, {1, 1 + random() % 9}}); });
  for (int kind = 0; kind < 9; ++kind)
    for (const bool accumulate : {false, true}) {
      StrokeSettings settings = brush_of(static_cast<BrushKind>(kind), 12);
      settings.brush.accumulate = accumulate;
      settings.brush.blend_mm = 300;
      settings.brush.value = 0.5;
      settings.filter.labels.assign(4, 0);
      settings.filter.labels[kMuscle] = 1;
      Stroke stroke(painted.weighted_body(), painted.weights, settings);
      stroke.to({11, 6, 10});
      stroke.to({10, 6, 44});
      stroke.to({11, 6, 30});
      CHECK(!stroke.empty());
      const SkinWeights after = stroke.finish();
      int wrong = 0;
      painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
        if (v.x > 12 || v.y >= 6) wrong += at(painted.tissue, after, v) != at(painted.tissue, *painted.weights, v);
      });
      CHECK(wrong == 0);
    }
}

TEST_CASE("stroke: dabs stand a spacing apart however the way is cut up, and pressure goes with the strength") {
  const Painted painted = bar();
  StrokeSettings settings = brush_of(BrushKind::Add, 8);
  settings.brush.spacing = 0.5;
  settings.brush.strength = 0.4;
  Stroke straight(painted.weighted_body(), painted.weights, settings),
      cut(painted.weighted_body(), painted.weights, settings);
  straight.to({6, 6, 10});
  straight.to({6, 6, 70});
  cut.to({6, 6, 10});
  for (int i = 1; i <= 240; ++i) cut.to({6, 6, 10 + i * 0.25});
  CHECK(straight.dab_count() == 16);
  CHECK(cut.dab_count() == 16);
  CHECK(straight.weights() == cut.weights());
  Stroke pressed(painted.weighted_body(), painted.weights, settings);
  pressed.to({6, 6, 10}, 0.5);
  CHECK(at(painted.tissue, pressed.weights(), {3, 3, 5}).of(1) == doctest::Approx(0.2).epsilon(1e-3));
}

TEST_CASE(
    "stroke: it says which bricks changed, when nothing did, and which lock was in the way, giving up costs nothing") {
  const Painted painted = bar();
  const SkinWeights before = *painted.weights;
  StrokeSettings settings = brush_of(BrushKind::Add, 6);
  Stroke stroke(painted.weighted_body(), painted.weights, settings);
  CHECK(stroke.empty());
  stroke.to({6, 6, 20});
  CHECK(!stroke.empty());
  const std::vector<int> dirty = stroke.take_dirty();
  CHECK(!dirty.empty());
  CHECK(std::is_sorted(dirty.begin(), dirty.end()));
  CHECK(stroke.take_dirty().empty());
  for (std::int64_t b = 0; b < before.chunk_count(); ++b) {
    const bool is_dirty = std::binary_search(dirty.begin(), dirty.end(), static_cast<int>(b));
    CHECK((stroke.chunk(b) != before.chunk(b)) == is_dirty);
    CHECK((stroke.weights().shared_chunk(b) != before.shared_chunk(b)) == is_dirty);
  }
  CHECK(*painted.weights == before);

  settings.brush.kind = BrushKind::Subtract;  // subtracts weight where there is none
  Stroke nothing(painted.weighted_body(), painted.weights, settings);
  nothing.to({6, 6, 20});
  CHECK(nothing.empty());
  CHECK(nothing.blocked_by() == -1);
  CHECK(nothing.take_dirty().empty());
  CHECK(nothing.finish().shared_chunk(0) == before.shared_chunk(0));

  settings.brush.kind = BrushKind::Add;
  settings.locked = {1, 0};
  Stroke blocked(painted.weighted_body(), painted.weights, settings);
  blocked.to({6, 6, 20});
  CHECK(blocked.empty());
  CHECK(blocked.blocked_by() == 0);
  const std::int64_t kept = blocked.blocked_count();
  CHECK(kept > 0);
  // A voxel that several dabs reach is counted once.
  settings.brush.accumulate = true;
  Stroke again(painted.weighted_body(), painted.weights, settings);
  for (int i = 0; i < 3; ++i) again.dab({6, 6, 20});
  CHECK(again.blocked_count() == kept);
  CHECK(lock_message(painted.body.armature, blocked.blocked_by()) == "Upper is locked");

  settings.bones = {2};
  CHECK_THROWS_AS(Stroke(painted.weighted_body(), painted.weights, settings), std::logic_error);
}

TEST_CASE(
    "stroke: weights handed on share the bricks that did not change since, and what was handed on stays as it was") {
  const Phantom phantom = make_body_phantom(8);
  const Painted painted({phantom.volume, phantom.tissues, phantom.armature});
  for (const bool accumulate : {false, true}) {
    StrokeSettings settings = brush_of(BrushKind::Add, 6 * 8.0, 2);
    settings.brush.accumulate = accumulate;
    Stroke stroke(painted.weighted_body(), painted.weights, settings);
    const Bone& bone = phantom.armature.bones[2];
    SkinWeights last = stroke.weights();
    std::size_t all = 0, most = 0;
    for (int i = 0; i < 12; ++i) {
      stroke.dab(glm::mix(bone.head, bone.tail, i / 11.0), 0.5);
      const std::vector<int> dirty = stroke.take_dirty();
      std::vector<SkinWeights::Influences> before;
      for (std::int64_t b = 0; b < last.chunk_count(); ++b) before.push_back(last.chunk(b));
      const SkinWeights next = stroke.weights();
      for (std::int64_t b = 0; b < next.chunk_count(); ++b) {
        const bool is_dirty = std::binary_search(dirty.begin(), dirty.end(), static_cast<int>(b));
        CHECK((next.shared_chunk(b) != last.shared_chunk(b)) == is_dirty);
        CHECK(next.chunk(b) == stroke.chunk(b));
        CHECK(last.chunk(b) == before[b]);
      }
      all += dirty.size();
      most = std::max(most, dirty.size());
      last = next;
    }
    CHECK(most < all / 2);
    CHECK(stroke.finish() == last);
  }
}

TEST_CASE("stroke: on a whole body one of 200 dabs takes less than 5 MB, and leaves all bricks but its own shared" *
          doctest::test_suite("slow")) {
  const Phantom phantom = make_body_phantom(8);
  Painted painted({phantom.volume, phantom.tissues, phantom.armature});
  StrokeSettings settings = brush_of(BrushKind::Add, 16 * 8.0, 2);
  settings.brush.falloff = FalloffShape::Smooth;
  settings.brush.spacing = 0.1;
  Stroke stroke(painted.weighted_body(), painted.weights, settings);
  const Bone& bone = phantom.armature.bones[2];
  for (int i = 0; stroke.dab_count() < 200; ++i) stroke.to(i % 2 ? bone.tail : bone.head);
  MESSAGE("of ", painted.tissue.size(), " voxels of tissue: ", stroke.memory_bytes() / 1000, " kB");
  CHECK(stroke.memory_bytes() < 5'000'000);
  const std::vector<int> dirty = stroke.take_dirty();
  CHECK(dirty.size() > 20);
  const SkinWeights after = stroke.finish();
  std::size_t own = 0;
  for (std::int64_t b = 0; b < after.chunk_count(); ++b)
    own += after.shared_chunk(b) != painted.weights->shared_chunk(b);
  CHECK(own == dirty.size());
  CHECK(own < painted.tissue.bricks().size() / 2);
}
