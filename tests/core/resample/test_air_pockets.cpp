// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/air_pockets.h"

#include <algorithm>
#include <random>
#include <utility>

#include <doctest/doctest.h>

using namespace limber;

namespace {

// A block of flesh (2) in skin (1) with one voxel of air around.
LabelVolume block() {
  LabelVolume volume;
  volume.grid.size = {14, 12, 10};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  for (int z = 1; z < 9; ++z)
    for (int y = 1; y < 11; ++y)
      for (int x = 1; x < 13; ++x)
        volume.at({x, y, z}) = x == 1 || x == 12 || y == 1 || y == 10 || z == 1 || z == 8 ? 1 : 2;
  return volume;
}

LabelSet set_of(std::initializer_list<Label> labels) {
  LabelSet set(65536, 0);
  for (Label label : labels) set[label] = 1;
  return set;
}

const RestPoint kStays = [](const glm::ivec3& v) { return glm::dvec3(v); };

std::vector<glm::ivec3> fill_grown(LabelVolume& posed, const LabelVolume& rest, const LabelSet& flesh,
                                   const LabelSet& soft) {
  const std::vector<AirPocket> now = air_pockets(posed), at_rest = air_pockets(rest);
  return fill_grown_pockets(posed, rest, {now, at_rest}, flesh, soft, kStays);
}

}  // namespace

TEST_CASE("air pockets: a hollow is one, a shaft to the outside is none, and hollows that meet at an edge are two") {
  LabelVolume volume = block();
  CHECK(air_pockets(volume).empty());
  for (int x = 4; x < 7; ++x) volume.at({x, 5, 5}) = 0;
  volume.at({7, 6, 5}) = 0;  // touches the hollow by an edge only
  for (int z = 0; z < 6; ++z) volume.at({10, 8, z}) = 0;
  const auto pockets = air_pockets(volume);
  REQUIRE(pockets.size() == 2);
  CHECK(pockets[0].size() + pockets[1].size() == 4);
}

TEST_CASE("air pockets: in a random sponge they are the air that a flood from the border does not reach") {
  for (const unsigned key : {1u, 2u, 3u}) {
    std::mt19937 random(key);
    LabelVolume volume;
    volume.grid.size = {23, 9, 8};
    volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
    for (Label& label : volume.voxels) label = random() % 100 < 65 ? 3 : 0;
    const glm::ivec3 size = volume.grid.size;
    LabelVolume reached{volume.grid, ZeroedVector<Label>(volume.grid.voxel_count())};
    for (bool changed = true; std::exchange(changed, false);)
      for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
          for (int x = 0; x < size.x; ++x) {
            const glm::ivec3 v(x, y, z);
            if (volume.at(v) || reached.at(v)) continue;
            const bool opens = std::any_of(kFaceNeighbours.begin(), kFaceNeighbours.end(), [&](const glm::ivec3& step) {
              return !volume.grid.contains(v + step) || reached.at(v + step);
            });
            if (opens) reached.at(v) = 1, changed = true;
          }
    std::int64_t enclosed = 0, found = 0;
    for (std::size_t i = 0; i < volume.voxels.size(); ++i) enclosed += !volume.voxels[i] && !reached.voxels[i];
    for (const AirPocket& pocket : air_pockets(volume))
      for (const glm::ivec3& v : pocket) found += !volume.at(v) && !reached.at(v) ? 1 : 1000;
    CHECK(enclosed > 0);
    CHECK(found == enclosed);
  }
}

TEST_CASE(
    "air pockets: what the pose closed is filled with flesh, what was there stays, and what grew shrinks to what it "
    "was") {
  const LabelSet flesh = set_of({2}), soft = set_of({1, 2});
  LabelVolume rest = block();
  for (int x = 3; x < 6; ++x) rest.at({x, 4, 4}) = 0;
  LabelVolume posed = rest;
  CHECK(fill_grown(posed, rest, flesh, soft).empty());
  CHECK(posed.voxels == rest.voxels);

  posed.at({9, 8, 6}) = 0;  // a new pocket
  posed.at({10, 8, 6}) = 0;
  for (int x = 3; x < 6; ++x) posed.at({x, 5, 4}) = 0;  // makes the hollow twice as large
  CHECK(fill_grown(posed, rest, flesh, soft).size() == 5);
  CHECK(posed.at({9, 8, 6}) == 2);
  std::int64_t hollow = 0;
  for (const AirPocket& pocket : air_pockets(posed)) hollow += std::ssize(pocket);
  CHECK(hollow == 3);
}

TEST_CASE("air pockets: a hollow that skin lines is lined again after it was filled, one in flesh is not") {
  const LabelSet flesh = set_of({2}), soft = set_of({1, 2});
  const auto with_hollow = [](int width, bool lined) {
    LabelVolume volume = block();
    for (int z = 3; z < 7; ++z)
      for (int y = 3; y < 8; ++y)
        for (int x = 3; x < 5 + width; ++x) {
          const bool inside = z > 3 && z < 6 && y > 3 && y < 7 && x > 3 && x < 4 + width;
          volume.at({x, y, z}) = inside ? 0 : lined ? 1 : 2;
        }
    return volume;
  };
  for (const bool lined : {true, false}) {
    const LabelVolume rest = with_hollow(2, lined);
    LabelVolume posed = with_hollow(5, lined);
    CHECK(fill_grown(posed, rest, flesh, soft).size() == 18);
    int skin = 0, bare = 0;
    for (const AirPocket& pocket : air_pockets(posed))
      for (const glm::ivec3& v : pocket)
        for (const glm::ivec3& face : kFaceNeighbours) {
          skin += posed.at_or_air(v + face) == 1;
          bare += posed.at_or_air(v + face) == 2;
        }
    CHECK((lined ? bare : skin) == 0);
    CHECK((lined ? skin : bare) > 0);
  }
}
