// SPDX-License-Identifier: AGPL-3.0-or-later
#include <numeric>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/skin/transfer_to_volume.h"
#include "core/skin/weight_layers.h"
#include "tests/core/skin/painted.h"

using namespace limber;
using namespace limber::test;

namespace {

WeightLayers on(const Painted& painted) { return with_new_layer({painted.weights, {}}, "Elbow"); }

// Returns the layers with the one at `index` replaced.
WeightLayers with(const WeightLayers& layers, std::size_t index, WeightLayer layer) {
  WeightLayers other = layers;
  other.layers[index] = std::make_shared<const WeightLayer>(std::move(layer));
  return other;
}

WeightLayers painted_at(const Painted& painted, const WeightLayers& layers, std::size_t layer, const glm::dvec3& point,
                        int bone) {
  StrokeSettings settings;
  settings.brush.radius = 9;
  settings.brush.falloff = FalloffShape::Linear;
  settings.bones = {bone};
  const auto before = std::make_shared<const SkinWeights>(canvas(layers, layer));
  Stroke stroke(painted.weighted_body(), before, settings);
  stroke.to(point);
  return with(layers, layer, painted_on(*layers.layers[layer], *before, stroke.finish()));
}

double worst_difference(const SkinWeights& a, const SkinWeights& b) {
  double worst = 0;
  for (std::int64_t c = 0; c < a.chunk_count(); ++c)
    for (std::size_t i = 0; i < a.chunk(c).size(); ++i)
      for (int bone = 0; bone < std::ssize(a.bones()); ++bone)
        worst = std::max(worst, std::abs(a.chunk(c)[i].of(bone) - b.chunk(c)[i].of(bone)));
  return worst;
}

}  // namespace

TEST_CASE("weight layers: an empty layer changes nothing and shares everything") {
  const Painted painted(two_bone_bar());
  const SkinWeights all = composed(on(painted));
  for (std::int64_t b = 0; b < all.chunk_count(); ++b) CHECK(all.shared_chunk(b) == painted.weights->shared_chunk(b));
}

TEST_CASE(
    "weight layers: what is painted on a layer comes out as painted, fades with its opacity, and is gone when hidden") {
  const Painted painted(two_bone_bar());
  const WeightLayers layers = painted_at(painted, on(painted), 0, {6, 6, 40}, 1);
  StrokeSettings settings;
  settings.brush.radius = 9;
  settings.brush.falloff = FalloffShape::Linear;
  settings.bones = {1};
  Stroke direct(painted.weighted_body(), painted.weights, settings);
  direct.to({6, 6, 40});
  const SkinWeights expected = direct.finish();
  CHECK(composed(layers) == expected);
  CHECK(composed(layers) != *painted.weights);

  WeightLayer half = *layers.layers[0];
  half.opacity = 0.5;
  const SkinWeights faded = composed(with(layers, 0, half));
  painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    if (v.z == 20)
      CHECK(at(painted.tissue, faded, v).of(1) ==
            doctest::Approx(at(painted.tissue, expected, v).of(1) / 2).epsilon(1e-3));
  });
  half.visible = false;
  CHECK(composed(with(layers, 0, half)) == *painted.weights);
}

TEST_CASE("weight layers: the base may change below a layer, which keeps what it covers") {
  Painted painted(two_bone_bar());
  WeightLayers layers = painted_at(painted, on(painted), 0, {6, 6, 40}, 1);
  const SkinWeights before = composed(layers);
  layers.base = std::make_shared<const SkinWeights>(
      flooded(painted.weighted_body(), *painted.weights, std::vector<int>{1}, Flood::Set, 0.25).weights);
  const SkinWeights after = composed(layers);
  CHECK(at(painted.tissue, after, {3, 3, 20}) == at(painted.tissue, before, {3, 3, 20}));
  CHECK(at(painted.tissue, after, {3, 3, 40}).of(1) == doctest::Approx(0.25).epsilon(1e-3));
  // While layer 0 is painted, the new base shows where the layer covers nothing.
  CHECK(at(painted.tissue, canvas(layers, 0), {3, 3, 40}).of(1) == doctest::Approx(0.25).epsilon(1e-3));
}

TEST_CASE(
    "weight layers: a mask takes a layer back by region, and brings it to where it did not cover without a change") {
  const Painted painted(two_bone_bar());
  const WeightLayers layers = painted_at(painted, on(painted), 0, {6, 6, 40}, 1);
  const TissueRegion upper = region_where(painted.tissue, [](std::int64_t, const glm::ivec3& v) { return v.z >= 20; });
  const SkinWeights cut = composed(with(layers, 0, with_mask(layers, 0, painted.tissue, upper, 0)));
  CHECK(at(painted.tissue, cut, {3, 3, 21}) == at(painted.tissue, *painted.weights, {3, 3, 21}));
  CHECK(at(painted.tissue, cut, {3, 3, 19}) == at(painted.tissue, composed(layers), {3, 3, 19}));
  CHECK(composed(with(layers, 0, with_mask(layers, 0, painted.tissue, {}, 1))) == composed(layers));
}

TEST_CASE(
    "weight layers: merging down changes nothing that comes out, sums stay exact, and hidden layers are refused") {
  std::mt19937 random(1);
  Painted painted(two_bone_bar());
  painted.set([&](const glm::ivec3&) { return quantize({{0, 1 + random() % 5}, {1, random() % 5}}); });
  WeightLayers layers = on(painted);
  layers = painted_at(painted, layers, 0, {6, 6, 40}, 1);
  layers = with_new_layer(layers, "Wrist");
  layers = painted_at(painted, layers, 1, {8, 4, 46}, 0);
  for (const std::size_t l : {0, 1}) {
    const TissueRegion back = region_where(painted.tissue, [](std::int64_t, const glm::ivec3& v) { return v.y > 3; });
    WeightLayer layer = with_mask(layers, l, painted.tissue, back, 0.6);
    layer.opacity = 0.7 + 0.1 * double(l);
    layers = with(layers, l, layer);
  }
  const SkinWeights all = composed(layers);
  for (const std::int64_t brick : {std::int64_t{0}, all.chunk_count() / 2})
    for (const Influence& influence : all.chunk(brick))
      CHECK(std::accumulate(influence.weight.begin(), influence.weight.end(), 0) == kFullWeight);
  const WeightLayers one = merged_down(layers, 1);
  CHECK(one.layers.size() == 1);
  CHECK(worst_difference(composed(one), all) < 1e-4);
  const WeightLayers none = merged_down(one, 0);
  CHECK(none.layers.empty());
  CHECK(worst_difference(*none.base, all) < 1e-4);
  CHECK(composed(none) == *none.base);

  WeightLayer hidden = *layers.layers[0];
  hidden.visible = false;
  CHECK_THROWS_AS(merged_down(with(layers, 0, hidden), 1), Error);
  CHECK_THROWS_AS(merged_down(with(layers, 0, hidden), 0), Error);
}

TEST_CASE("weight layers: what comes out is made anew only where parts changed, and equals what is made from nothing") {
  const Painted painted(two_bone_bar());
  const WeightLayers before = painted_at(painted, with_new_layer(on(painted), "Upper"), 0, {6, 6, 40}, 1);
  const SkinWeights came_out = composed(before);
  CHECK(changed_bricks(before, before).empty());
  CHECK(changed_bricks(before, on(painted)) == changed_bricks(on(painted), before));
  const auto same = [&](const WeightLayers& after, const WeightLayers& was, const SkinWeights& made) {
    const SkinWeights again = recomposed(after, was, made);
    CHECK(again == composed(after));
    std::int64_t own = 0;
    for (std::int64_t b = 0; b < again.chunk_count(); ++b) own += again.shared_chunk(b) != made.shared_chunk(b);
    CHECK(own <= std::ssize(changed_bricks(after, was)));
    CHECK(own < again.chunk_count());
  };
  same(painted_at(painted, before, 1, {6, 6, 30}, 0), before, came_out);
  WeightLayers swapped = before;
  std::swap(swapped.layers[0], swapped.layers[1]);
  // One of the two layers is empty, so their order has no effect.
  CHECK(changed_bricks(swapped, before).empty());
  WeightLayer half = *before.layers[0];
  half.opacity = 0.3;
  same(with(before, 0, half), before, came_out);
  half.visible = false;
  const WeightLayers hidden = with(before, 0, half);
  same(hidden, before, came_out);
  for (std::int64_t b = 0; b < came_out.chunk_count(); ++b)
    CHECK(recomposed(hidden, before, came_out).shared_chunk(b) == painted.weights->shared_chunk(b));
}

TEST_CASE("weight layers: a brick is seen while it is painted as it comes out afterwards, below other layers too") {
  const Painted painted(two_bone_bar());
  WeightLayers layers = painted_at(painted, with_new_layer(on(painted), "Upper"), 1, {6, 6, 40}, 1);
  WeightLayer upper = *layers.layers[1];
  upper.opacity = 0.4;
  layers = with(layers, 1, upper);
  const SkinWeights before = canvas(layers, 0);
  SkinWeights after = before;
  for (std::int64_t b = 0; b < after.chunk_count(); ++b) {
    SkinWeights::Influences chunk = after.chunk(b);
    for (std::size_t i = 0; i < chunk.size(); i += 3) chunk[i] = quantize({{0, 0.25}, {1, 0.75}});
    after.set_chunk(b, chunk);
  }
  const SkinWeights all = composed(with(layers, 0, painted_on(*layers.layers[0], before, after)));
  for (std::int64_t b = 0; b < all.chunk_count(); ++b)
    CHECK(composed_while_painted(layers, 0, b, before.chunk(b), after.chunk(b)) == all.chunk(b));
}

TEST_CASE("weight layers: a mask is painted like weights, to the last step of 1/65535") {
  const Painted painted(two_bone_bar());
  WeightLayers layers = painted_at(painted, on(painted), 0, {6, 6, 40}, 1);
  const SkinWeights before = mask_as_weights(*layers.layers[0]);
  // Without a change, the mask remains the same.
  CHECK(mask_painted_on(layers, 0, before, before).mask == layers.layers[0]->mask);
  SkinWeights after = before;
  for (std::int64_t b = 0; b < after.chunk_count(); ++b) {
    SkinWeights::Influences chunk = after.chunk(b);
    for (std::size_t i = 0; i < chunk.size(); ++i)
      chunk[i] =
          i % 2 ? rigid_influence(kNotCovering)
                : Influence{{kNotCovering, kCovering, 0, 0},
                            {static_cast<std::uint16_t>(kFullWeight - int(i)), static_cast<std::uint16_t>(i), 0, 0}};
    after.set_chunk(b, chunk);
  }
  const SkinWeights shown = canvas(layers, 0);
  const WeightLayer masked = mask_painted_on(layers, 0, before, after);
  for (std::int64_t b = 0; b < after.chunk_count(); ++b)
    for (std::size_t i = 0; i < after.chunk(b).size(); ++i) {
      CHECK((*masked.mask[b])[i] == (i % 2 ? 0 : i));
      CHECK(masked.weights.chunk(b)[i] == shown.chunk(b)[i]);
    }
  const SkinWeights out = composed(with(layers, 0, masked));
  for (std::int64_t b = 0; b < out.chunk_count(); ++b)
    CHECK(composed_while_masked(layers, 0, b, after.chunk(b)) == out.chunk(b));
  // If the mask is painted away in a whole brick, the layer no longer contains this brick.
  SkinWeights nothing = after;
  for (std::int64_t b = 0; b < nothing.chunk_count(); ++b)
    nothing.set_chunk(b, SkinWeights::Influences(nothing.chunk(b).size(), rigid_influence(kNotCovering)));
  for (const auto& mask : mask_painted_on(with(layers, 0, masked), 0, after, nothing).mask) CHECK(!mask);
}

TEST_CASE(
    "weight layers: with normalizing left to the composition a bone takes from what lies below, and the layer's others "
    "keep theirs") {
  SmallBody body = two_bone_bar();
  body.armature.bones.push_back(bone_between("Hand", 1, {15, 15, 70}, {15, 15, 84}));
  const Painted painted(std::move(body));
  WeightLayers layers = with_new_layer({painted.weights, {}}, "Elbow");
  const WeightedBody plain = painted.weighted_body();
  const Armature bones = with_below(plain.armature);
  const WeightedBody with_what_lies_below{plain.volume, plain.tissue, plain.tissues, bones};
  const glm::ivec3 middle(2, 2, 22);
  // Sets a bone's share. The layer's other bones are locked, so the share comes from what lies below.
  const auto set = [&](int bone, double value) {
    StrokeSettings settings;
    settings.brush = {.kind = BrushKind::Set, .radius = 9, .value = value, .falloff = FalloffShape::Constant};
    settings.bones = {bone + 1};
    settings.locked.assign(4, 1);
    settings.locked[kBelow] = settings.locked[bone + 1] = 0;
    const auto before = std::make_shared<const SkinWeights>(shares_as_weights(*layers.layers[0]));
    Stroke stroke(with_what_lies_below, before, settings);
    stroke.to({4, 4, 44});
    const SkinWeights after = stroke.finish();
    const WeightLayers was = layers;
    layers = with(layers, 0, shares_painted_on(*layers.layers[0], *before, after));
    const SkinWeights all = composed(layers);
    for (std::int64_t b = 0; b < all.chunk_count(); ++b)
      CHECK(composed_while_shared(was, 0, b, before->chunk(b), after.chunk(b)) == all.chunk(b));
    return at(painted.tissue, all, middle);
  };
  const Influence below = at(painted.tissue, *painted.weights, middle);
  REQUIRE(below.of(0) == 1);
  // The layer gives 0.3 to one bone and 0.5 to another, and the base shows through the rest.
  Influence made = set(1, 0.3);
  CHECK(made.of(1) == doctest::Approx(0.3).epsilon(1e-4));
  CHECK(made.of(0) == doctest::Approx(0.7).epsilon(1e-4));
  made = set(2, 0.5);
  CHECK(made.of(1) == doctest::Approx(0.3).epsilon(1e-4));
  CHECK(made.of(2) == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(made.of(0) == doctest::Approx(0.2).epsilon(1e-4));
  // A bone gets no more than the rest of the layer. Shares that are set to 0 show the base again.
  made = set(2, 1);
  CHECK(made.of(1) == doctest::Approx(0.3).epsilon(1e-4));
  CHECK(made.of(2) == doctest::Approx(0.7).epsilon(1e-4));
  set(1, 0);
  made = set(2, 0);
  CHECK(made == below);
  for (const auto& mask : layers.layers[0]->mask) CHECK(!mask);
  CHECK(composed(layers) == *painted.weights);
}

TEST_CASE("weight layers: another base shows through where nothing covers, and no old brick of it is kept") {
  const Painted painted(two_bone_bar());
  const WeightLayers layers = painted_at(painted, on(painted), 0, {6, 6, 40}, 1);
  const auto base = std::make_shared<const SkinWeights>(
      flooded(painted.weighted_body(), *painted.weights, std::vector<int>{1}, Flood::Set, 0.25).weights);
  const WeightLayers over = over_base(layers, base);
  CHECK(over.base == base);
  const SkinWeights out = composed(over);
  for (std::int64_t b = 0; b < out.chunk_count(); ++b)
    CHECK(composed_over_base(layers, b, base->chunk(b)) == out.chunk(b));
  for (std::int64_t b = 0; b < base->chunk_count(); ++b)
    CHECK(over.layers[0]->weights.shared_chunk(b) ==
          (layers.layers[0]->mask[b] ? layers.layers[0]->weights.shared_chunk(b) : base->shared_chunk(b)));
}

TEST_CASE("weight layers: they follow the rig's bones as weights do") {
  const Painted painted(two_bone_bar());
  const WeightLayers layers = painted_at(painted, on(painted), 0, {6, 6, 40}, 1);
  const auto next = carried(layers, {1, 0}, {"B", "A"});
  REQUIRE(next);
  CHECK(composed(*next) == *carried(composed(layers), {1, 0}, {"B", "A"}));
  CHECK(!carried(layers, {-1, -1}, {"A"}));
}
