// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/seam_edits.h"

#include <random>

#include <doctest/doctest.h>

#include "core/seams/seam_pairs.h"
#include "tests/support/glued_arm.h"

using namespace limber;

namespace {

constexpr Label kFlesh = 1, kBone = 2;

TissueTable two_tissues() {
  TissueTable tissues;
  tissues.tissues.resize(2);
  tissues.tissues[0].label = kFlesh;
  tissues.tissues[0].kind = TissueKind::Muscle;
  tissues.tissues[1].label = kBone;
  tissues.tissues[1].kind = TissueKind::Bone;
  return tissues;
}

// A block of flesh with a rod of bone along y, in air, on an oblique and mirrored grid.
LabelVolume block() {
  LabelVolume volume{{{20, 16, 18}, {2, 3, 2.5}, {10, -20, 30}, glm::dmat3(1)}, {}};
  const double c = std::cos(0.4), s = std::sin(0.4);
  volume.grid.direction = glm::dmat3(glm::dvec3(c, s, 0), glm::dvec3(s, -c, 0), glm::dvec3(0, 0, 1));
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  for (int z = 2; z < 16; ++z)
    for (int y = 2; y < 14; ++y)
      for (int x = 2; x < 18; ++x) volume.at({x, y, z}) = std::abs(x - 12) < 2 && std::abs(z - 8) < 2 ? kBone : kFlesh;
  return volume;
}

// Counts the voxels that are connected to `start` through faces that are not cut.
std::int64_t reached_from(const LabelVolume& volume, const Seams& seams, const glm::ivec3& start) {
  std::vector<bool> seen(volume.voxels.size(), false);
  std::vector<glm::ivec3> waiting{start};
  seen[volume.grid.index(start)] = true;
  std::int64_t count = 0;
  while (!waiting.empty()) {
    const glm::ivec3 v = waiting.back();
    waiting.pop_back();
    ++count;
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 w = v;
      w[direction >> 1] += direction & 1 ? 1 : -1;
      if (volume.at_or_air(w) == 0 || seams.is_cut_towards(v, direction) || seen[volume.grid.index(w)]) continue;
      seen[volume.grid.index(w)] = true;
      waiting.push_back(w);
    }
  }
  return count;
}

}  // namespace

TEST_CASE(
    "seam edits: a knife through a block parts it in two, along planes, bends and slants, and leaves bone whole") {
  const LabelVolume volume = block();
  const AffineTransform world = world_from_voxel(volume.grid);
  const LabelSet soft = soft_labels(two_tissues());
  const std::int64_t all = 14 * 12 * 16;
  // Paths of the knife in voxels (x, z), from below the block to above it, left of the bone. The blade extends through
  // all of y.
  const std::vector<std::vector<glm::dvec2>> ways = {
      {{6, 0}, {6, 17}}, {{5.5, 0}, {5.5, 17}}, {{4, 0}, {8, 17}}, {{3, 0}, {9, 7.3}, {4, 11}, {8.5, 17}}};
  for (const auto& way : ways) {
    Seams seams(volume.grid.size);
    std::int64_t cut = 0;
    for (std::size_t i = 1; i < way.size(); ++i) {
      const auto blade = [&](const glm::dvec2& at) {
        return Blade{world * glm::dvec3(at.x, -1, at.y), world * glm::dvec3(at.x, 17, at.y)};
      };
      cut += cut_between(seams, volume, soft, blade(way[i - 1]), blade(way[i]));
    }
    CHECK(cut == seams.size());
    const std::int64_t left = reached_from(volume, seams, {2, 5, 5}), right = reached_from(volume, seams, {17, 5, 5});
    CHECK(left + right == all);
    CHECK(left > all / 8);
    seams.for_each([&](const glm::ivec3& lower, int axis) {
      glm::ivec3 upper = lower;
      ++upper[axis];
      CHECK(volume.at(lower) == kFlesh);
      CHECK(volume.at(upper) == kFlesh);
    });
  }
}

TEST_CASE("seam edits: through bone nothing is cut, and the same cut twice changes nothing") {
  const LabelVolume volume = block();
  const AffineTransform world = world_from_voxel(volume.grid);
  const LabelSet soft = soft_labels(two_tissues());
  Seams seams(volume.grid.size);
  const Blade first{world * glm::dvec3(12, -1, 0), world * glm::dvec3(12, 17, 0)},
      second{world * glm::dvec3(12, -1, 17), world * glm::dvec3(12, 17, 17)};
  CHECK(cut_between(seams, volume, soft, first, second) > 0);
  CHECK(cut_between(seams, volume, soft, first, second) == 0);
  CHECK(reached_from(volume, seams, {2, 5, 5}) == 14 * 12 * 16);  // still connected through the bone
  // A blade that lies far away, or is infinitely long, cuts nothing and does no harm.
  CHECK(cut_between(seams, volume, soft, {{1e300, 0, 0}, {0, 0, 0}}, second) == 0);
  CHECK(cut_between(seams, volume, soft, {glm::dvec3(1e4), glm::dvec3(2e4)},
                    {glm::dvec3(1e4, 0, 1e4), glm::dvec3(3e4)}) == 0);
}

TEST_CASE("seam edits: a ball joins the faces within it and no others") {
  const LabelVolume volume = block();
  const AffineTransform world = world_from_voxel(volume.grid);
  Seams seams(volume.grid.size);
  std::mt19937 random(5);
  for (int z = 2; z < 15; ++z)
    for (int y = 2; y < 13; ++y)
      for (int x = 2; x < 17; ++x)
        for (int axis = 0; axis < 3; ++axis)
          if (random() % 3 == 0) seams.cut({x, y, z}, axis);
  const Seams before = seams;
  const glm::dvec3 centre = world * glm::dvec3(9.2, 7.1, 8.4);
  const std::int64_t joined = join_within(seams, volume.grid, centre, 7);
  CHECK(joined > 50);
  CHECK(before.size() - seams.size() == joined);
  before.for_each([&](const glm::ivec3& lower, int axis) {
    glm::dvec3 face(lower);
    face[axis] += 0.5;
    CHECK(seams.is_cut(lower, axis) == (glm::distance(world * face, centre) > 7));
  });
  CHECK(join_within(seams, volume.grid, glm::dvec3(1e6), 3) == 0);
}

TEST_CASE("seam pairs: the seam of an arm grown to the trunk is said to lie between them, every face once") {
  const test::GluedArm body(-3);
  const Seams seams = body.seams();
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.rig);
  const std::vector<SeamPair> pairs = seam_pairs(seams, body.volume, tissue, body.rig, parts);
  std::int64_t faces = 0, elsewhere = 0;
  for (const SeamPair& pair : pairs) {
    faces += pair.faces;
    // A few faces at the seam's end lie between other bones, since a path around the end connects these.
    if (pair.second != "trunk") {
      elsewhere += pair.faces;
      continue;
    }
    CHECK((pair.first == "left upper arm" || pair.first == "left forearm"));
    CHECK(std::abs(pair.middle.x - test::GluedArm::kTrunk) < 16);
  }
  CHECK(pairs.size() >= 2);
  CHECK(elsewhere < 0.05 * double(faces));
  CHECK(faces == seams.size());
  CHECK(seam_pairs(Seams(body.volume.grid.size), body.volume, tissue, body.rig, parts).empty());
}
