// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/influence_chunk.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <doctest/doctest.h>

using namespace limber;

namespace {

// Returns random influences, each of up to `most` of `bones` bones.
std::vector<Influence> random_influences(std::mt19937& random, std::size_t count, int bones, int most) {
  std::vector<Influence> made(count);
  for (Influence& influence : made) {
    std::vector<std::pair<int, double>> weights;
    const int own = 1 + int(random() % unsigned(most));
    for (int k = 0; k < own; ++k) {
      const int bone = int(random() % unsigned(bones));
      if (std::none_of(weights.begin(), weights.end(), [&](const auto& w) { return w.first == bone; }))
        weights.emplace_back(bone, 1 + random() % 1000);
    }
    influence = quantize(weights);
  }
  return made;
}

}  // namespace

TEST_CASE("packed influences: every brick comes back bit for bit, one voxel at a time, in order and as a whole") {
  std::mt19937 random(11);
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{512}})
    for (const int bones : {1, 2, 5, 60, 65535})
      for (int most = 1; most <= 4; ++most) {
        const std::vector<Influence> plain = random_influences(random, count, bones, most);
        const InfluenceChunk packed(plain);
        REQUIRE(packed.size() == count);
        const std::vector<Influence> back = packed;
        CHECK(back == plain);
        CHECK(packed == plain);
        CHECK(std::equal(packed.begin(), packed.end(), plain.begin(), plain.end()));
        bool each = true;
        for (std::size_t i = 0; i < count; ++i) each = each && packed[i] == plain[i];
        CHECK(each);
        CHECK(InfluenceChunk(plain) == packed);
        std::vector<Influence> other = plain;
        other[count / 2] = rigid_influence(65535);
        CHECK_FALSE(InfluenceChunk(other) == packed);
        CHECK_FALSE(packed == other);
        CHECK_FALSE(packed == std::vector<Influence>(count + 1));
      }
}

TEST_CASE("packed influences: some places of every shape") {
  std::mt19937 random(11);
  for (const int bones : {1, 2, 6, 300})
    for (int most = 1; most <= 4; ++most) {
      const std::vector<Influence> influences = random_influences(random, 512, bones, most);
      const InfluenceChunk chunk{std::span(influences)};
      std::vector<std::uint16_t> places;
      for (std::uint16_t i = 0; i < 512; ++i)
        if (random() % 3 || i == 511) places.push_back(i);
      std::vector<Influence> some(places.size());
      chunk.unpack(places, some.data());
      for (std::size_t i = 0; i < places.size(); ++i) REQUIRE(some[i] == influences[places[i]]);
    }
}

TEST_CASE(
    "packed influences: a brick of one bone costs next to nothing, of two bones three bytes a voxel, of any at most "
    "eight") {
  std::mt19937 random(12);
  CHECK(InfluenceChunk(512, rigid_influence(3)).heap_bytes() <= 16);
  std::vector<Influence> two(512);
  for (Influence& influence : two) influence = quantize({{4, 1 + random() % 100}, {9, 1 + random() % 100}});
  CHECK(InfluenceChunk(two).heap_bytes() <= 512 * 3 + 24);
  const InfluenceChunk worst(random_influences(random, 512, 65535, 4));
  CHECK(worst.heap_bytes() <= 512 * (8 + 8) + 8);  // the worst case: each voxel has its own set of bones
}

TEST_CASE("packed influences: what does not sum to one is refused") {
  std::vector<Influence> wrong(8, rigid_influence(1));
  wrong[5].weight[1] = 1;
  CHECK_THROWS_AS(InfluenceChunk{wrong}, std::logic_error);
  CHECK(InfluenceChunk().size() == 0);
  CHECK(InfluenceChunk(std::vector<Influence>{}).empty());
}
