// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/gather_parts.h"

#include <queue>
#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {

constexpr int kBones = 16;  // so many that the few cells of one bone do not all touch each other

// A slab of bone, large enough for several blocks of every parallel loop, whose cells follow random rig bones. Cells
// join to pieces of every size and shape.
struct CellSlab {
  SmallBody body;
  TissueVoxels tissue;
  BoneGraph graph;
  NamedBones named;

  explicit CellSlab(unsigned seed) : body(slab()), tissue(body.volume) {
    graph = gather_bone(body.volume, tissue, body.tissues.kinds());
    std::mt19937 random(seed);
    std::vector<int> of_cell(30 * 30 * 10);
    for (int& bone : of_cell) bone = static_cast<int>(random() % kBones);
    named.bone.resize(graph.size());
    named.found_by.resize(graph.size());
    for (std::int64_t i = 0; i < graph.size(); ++i) {
      const glm::ivec3 cell = graph.voxel[i] / glm::ivec3(3 + graph.voxel[i].z / 10, 5, 4);
      const bool is_speck = random() % 500 == 0;
      named.bone[i] = is_speck ? static_cast<int>(random() % kBones) : of_cell[cell.x + 30 * (cell.y + 30 * cell.z)];
      named.found_by[i] = named.bone[i] % 2 ? FoundBy::Name : FoundBy::Map;
    }
  }
  static SmallBody slab() {
    SmallBody body;
    body.volume.grid.size = {90, 100, 40};
    body.volume.voxels.assign(body.volume.grid.voxel_count(), kBone);
    body.tissues = muscle_and_bone();
    for (int b = 0; b < kBones; ++b)
      body.armature.bones.push_back(
          bone_between(("Bone " + std::to_string(b)).c_str(), b - 1, {5 * b, 50, 20}, {5 * b + 5, 50, 20}));
    return body;
  }
  BoneParts parts(int threads) const {
    const ThreadCount limit(threads);
    BoneParts parts;
    parts.part_of.resize(tissue.size());
    gather_parts(graph, Hugging(body.armature, body.volume.grid), named.bone, parts);
    return parts;
  }
};

// Numbers the connected pieces of voxels with the same rig bone, voxel by voxel.
std::vector<int> pieces_by_search(const CellSlab& slab, std::vector<std::int64_t>& sizes) {
  std::vector<int> piece(slab.graph.size(), -1);
  for (std::int32_t start = 0; start < slab.graph.size(); ++start) {
    if (piece[start] >= 0) continue;
    const int number = static_cast<int>(sizes.size());
    sizes.push_back(0);
    std::queue<std::int32_t> open({start});
    piece[start] = number;
    for (; !open.empty(); open.pop(), ++sizes.back())
      for (const std::int32_t n : slab.graph.neighbour[open.front()])
        if (n >= 0 && piece[n] < 0 && slab.named.bone[n] == slab.named.bone[start]) piece[n] = number, open.push(n);
  }
  return piece;
}

}  // namespace

TEST_CASE("bone parts: connected pieces are parts, small ones join the largest of their rig bone") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const CellSlab slab(seed);
    REQUIRE(slab.graph.size() == 360'000);
    std::vector<std::int64_t> sizes;
    const std::vector<int> piece = pieces_by_search(slab, sizes);
    std::vector<int> bone_of(sizes.size());
    for (std::size_t i = 0; i < piece.size(); ++i) bone_of[piece[i]] = slab.named.bone[i];
    std::vector<int> largest(kBones, -1);
    for (int p = 0; p < std::ssize(sizes); ++p)
      if (int& known = largest[bone_of[p]]; known < 0 || sizes[p] > sizes[known]) known = p;

    const BoneParts parts = slab.parts(2);
    REQUIRE(parts.parts.size() > 4 * kBones);  // several pieces are large enough to be parts
    REQUIRE(parts.parts.size() < sizes.size());
    std::map<int, std::uint16_t> part_of_piece;
    std::vector<std::int64_t> counts(parts.parts.size());
    std::vector<glm::dvec3> sums(parts.parts.size());
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const int home = largest[bone_of[piece[i]]];
      const int joined = 100 * sizes[piece[i]] < sizes[home] ? home : piece[i];
      const std::uint16_t part = parts.part_of[slab.graph.place[i]];
      REQUIRE(part > 0);
      REQUIRE(part_of_piece.insert({joined, part}).first->second == part);
      ++counts[part - 1];
      sums[part - 1] += glm::dvec3(slab.graph.voxel[i]);
    }
    REQUIRE(part_of_piece.size() == parts.parts.size());
    for (std::size_t p = 0; p < parts.parts.size(); ++p) {
      CHECK(parts.parts[p].voxel_count == counts[p]);
      CHECK(glm::distance(parts.parts[p].centre, sums[p] / double(counts[p])) < 1e-9);
    }
  }
}

TEST_CASE("bone parts: 1 and 3 threads find the same parts and identities") {
  const CellSlab slab(4);
  const BoneParts one = slab.parts(1), three = slab.parts(3);
  CHECK(one.part_of == three.part_of);
  REQUIRE(one.parts.size() == three.parts.size());
  for (std::size_t p = 0; p < one.parts.size(); ++p) {
    CHECK(one.parts[p].bone == three.parts[p].bone);
    CHECK(one.parts[p].voxel_count == three.parts[p].voxel_count);
    CHECK(one.parts[p].centre == three.parts[p].centre);
  }
  std::vector<std::int64_t> counts(kBones);
  for (const int bone : slab.named.bone) ++counts[bone];
  for (const int threads : {1, 3}) {
    const ThreadCount limit(threads);
    const auto identities = identities_of(slab.graph, slab.body.volume, slab.named, {});
    REQUIRE(identities.size() == kBones);
    for (int bone = 0; bone < kBones; ++bone) {
      CHECK(identities[bone].label == kBone);
      CHECK(identities[bone].bone == bone);
      CHECK(identities[bone].voxel_count == counts[bone]);
      CHECK(identities[bone].found_by == (bone % 2 ? FoundBy::Name : FoundBy::Map));
    }
  }
}
