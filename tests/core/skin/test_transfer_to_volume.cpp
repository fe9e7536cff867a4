// SPDX-License-Identifier: AGPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/skin/transfer_to_volume.h"

using namespace limber;

namespace {

SkinWeights small_weights() {
  SkinWeights::Influences chunk;
  chunk.push_back(rigid_influence(0));
  chunk.push_back(quantize({{0, 0.2}, {1, 0.5}, {2, 0.3}}));
  return SkinWeights({"A", "B", "C"}, {std::make_shared<const SkinWeights::Chunk>(chunk)});
}

}  // namespace

TEST_CASE("carried weights: new bones at the end cost nothing, and names follow") {
  const SkinWeights weights = small_weights();
  const auto next = carried(weights, {0, 1, 2}, {"A", "Renamed", "C", "New"});
  REQUIRE(next);
  CHECK(next->bones()[1] == "Renamed");
  CHECK(next->shared_chunk(0) == weights.shared_chunk(0));
}

TEST_CASE("carried weights: another order is followed, and a removed bone's weight goes to its heir") {
  const SkinWeights weights = small_weights();
  const auto turned = carried(weights, {2, 1, 0}, {"C", "B", "A"});
  REQUIRE(turned);
  CHECK(turned->chunk(0)[1].of(2) == weights.chunk(0)[1].of(0));
  CHECK(turned->chunk(0)[1].of(0) == weights.chunk(0)[1].of(2));
  const auto merged = carried(weights, {0, 0, 1}, {"A", "C"});
  REQUIRE(merged);
  CHECK(merged->chunk(0)[1].of(0) == weights.chunk(0)[1].of(0) + weights.chunk(0)[1].of(1));
  CHECK(merged->chunk(0)[0] == rigid_influence(0));
}

TEST_CASE("carried weights: none, where a voxel would be left without a bone") {
  CHECK(!carried(small_weights(), {-1, 0, 1}, {"B", "C"}));
}
