// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/exposure.h"

#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {
constexpr Label kSkin = 1, kFlesh = 2, kBone = 3;

TissueTable skin_flesh_bone() {
  TissueTable table;
  table.tissues.push_back({.label = kSkin, .file_value = 1, .name = "Skin", .kind = TissueKind::Skin});
  table.tissues.push_back({.label = kFlesh, .file_value = 2, .name = "Flesh", .kind = TissueKind::Muscle});
  table.tissues.push_back({.label = kBone, .file_value = 3, .name = "Bone", .kind = TissueKind::Bone});
  return table;
}

// A block of flesh with a skin of one voxel and a bone in its middle.
LabelVolume block(const glm::dvec3& spacing) {
  LabelVolume volume{{.size = {24, 20, 22}, .spacing = spacing, .origin = {5, -7, 30}},
                     ZeroedVector<Label>(24 * 20 * 22)};
  for (int z = 3; z < 19; ++z)
    for (int y = 2; y < 18; ++y)
      for (int x = 4; x < 21; ++x) {
        const bool skin = z == 3 || z == 18 || y == 2 || y == 17 || x == 4 || x == 20;
        const bool bone = x > 10 && x < 14 && y > 8 && y < 12 && z > 8 && z < 14;
        volume.at({x, y, z}) = skin ? kSkin : bone ? kBone : kFlesh;
      }
  return volume;
}

// Returns the distance from every voxel to the nearest outside air, by brute force. Outside air is flooded from all
// faces.
std::vector<double> depth_by_asking(const LabelVolume& volume) {
  const glm::ivec3 size = volume.grid.size;
  std::vector<char> outside(volume.voxels.size(), 0);
  for (bool more = true; more;) {
    more = false;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          const std::int64_t at = volume.grid.index({x, y, z});
          if (volume.voxels[at] || outside[at]) continue;
          bool open = x == 0 || y == 0 || z == 0 || x == size.x - 1 || y == size.y - 1 || z == size.z - 1;
          for (int axis = 0; axis < 3 && !open; ++axis)
            for (const int side : {-1, 1}) {
              glm::ivec3 n(x, y, z);
              n[axis] += side;
              open |= outside[volume.grid.index(n)] != 0;
            }
          if (open) outside[at] = 1, more = true;
        }
  }
  std::vector<double> depth(volume.voxels.size(), 1e9);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        for (int w = -1; w <= size.z; ++w)
          for (int v = -1; v <= size.y; ++v)
            for (int u = -1; u <= size.x; ++u)
              if (const glm::ivec3 n(u, v, w); !volume.grid.contains(n) || outside[volume.grid.index(n)]) {
                double& own = depth[volume.grid.index({x, y, z})];
                own = std::min(own, glm::length(glm::dvec3(u - x, v - y, w - z) * volume.grid.spacing));
              }
  return depth;
}
}  // namespace

TEST_CASE("exposure: a body at rest exposes nothing and closes no air in") {
  const TissueTable tissues = skin_flesh_bone();
  const LabelVolume rest = block({2, 2, 3});
  const ZeroedVector<glm::vec3> still(rest.voxels.size());
  const JudgedPose pose{rest, rest, tissues, {still.data(), still.size()}};
  const AirAround air = air_around(pose);
  const Exposure exposure = measure_exposure(pose, air);
  CHECK(exposure.voxels == 0);
  CHECK_FALSE(exposure.worst);
  CHECK(exposure.surface_voxels == 16 * 16 * 17 - 14 * 14 * 15);
  CHECK_FALSE(largest_air_pocket(pose, air));
}

TEST_CASE(
    "exposure: a notch cut into a body bares what lay deep, voxel by voxel as the distance to the outside air says" *
    doctest::test_suite("slow")) {
  const TissueTable tissues = skin_flesh_bone();
  for (const glm::dvec3 spacing : {glm::dvec3(2), glm::dvec3(2, 2, 5)}) {
    const LabelVolume rest = block(spacing);
    LabelVolume posed = rest;
    for (int z = 8; z < 12; ++z)
      for (int y = 8; y < 12; ++y)
        for (int x = 10; x < 24; ++x) posed.at({x, y, z}) = 0;
    const ZeroedVector<glm::vec3> still(rest.voxels.size());
    const JudgedPose pose{rest, posed, tissues, {still.data(), still.size()}};
    const Exposure exposure = measure_exposure(pose, air_around(pose));
    const std::vector<double> deep = depth_by_asking(rest), now = depth_by_asking(posed);
    const double limit = glm::length(spacing) + std::min(spacing.x, spacing.z);
    CHECK(exposure.deeper_than_mm == doctest::Approx(limit));
    std::int64_t expected = 0;
    std::map<Label, std::int64_t> by_label;
    for (int z = 1; z < 21; ++z)
      for (int y = 1; y < 19; ++y)
        for (int x = 1; x < 23; ++x) {
          const Label label = posed.at({x, y, z});
          bool open = false;
          for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1}) {
              glm::ivec3 n(x, y, z);
              n[axis] += side;
              open |= now[posed.grid.index(n)] == 0;
            }
          if (label && label != kSkin && open && deep[rest.grid.index({x, y, z})] > limit)
            ++expected, ++by_label[label];
        }
    CHECK(expected > 20);
    CHECK(exposure.voxels == expected);
    CHECK(exposure.by_label == by_label);
    REQUIRE(exposure.worst);
    CHECK(exposure.worst->voxels == expected);
  }
}

TEST_CASE("exposure: where tissue lay at rest is read from the displacement, on another grid as well") {
  const TissueTable tissues = skin_flesh_bone();
  const LabelVolume rest = block(glm::dvec3(2));
  // The posed body has two voxels of flesh at its surface, which come from the surface at rest or from its middle.
  for (const bool from_the_middle : {false, true}) {
    LabelVolume posed{{.size = {6, 6, 6}, .spacing = glm::dvec3(2)}, ZeroedVector<Label>(216)};
    ZeroedVector<glm::vec3> moved(216);
    const glm::dvec3 source =
        world_from_voxel(rest.grid) * (from_the_middle ? glm::dvec3(8, 8, 8) : glm::dvec3(5, 8, 8));
    for (const glm::ivec3 v : {glm::ivec3(2, 2, 2), glm::ivec3(3, 2, 2)}) {
      posed.at(v) = kFlesh;
      moved[posed.grid.index(v)] = world_from_voxel(posed.grid) * glm::dvec3(v) - source;
    }
    const JudgedPose pose{rest, posed, tissues, {moved.data(), moved.size()}};
    CHECK(measure_exposure(pose, air_around(pose)).voxels == (from_the_middle ? 2 : 0));
  }
}

TEST_CASE("exposure: the largest pocket of air is found, and air that a channel joins to the outside is none") {
  const TissueTable tissues = skin_flesh_bone();
  const LabelVolume rest = block(glm::dvec3(2));
  LabelVolume posed = rest;
  for (const glm::ivec3 v :
       {glm::ivec3(7, 5, 5), glm::ivec3(15, 13, 15), glm::ivec3(16, 13, 15), glm::ivec3(17, 13, 15)})
    posed.at(v) = 0;
  for (int x = 4; x < 9; ++x) posed.at({x, 14, 7}) = 0;
  const JudgedPose pose{rest, posed, tissues};
  const auto pocket = largest_air_pocket(pose, air_around(pose));
  REQUIRE(pocket);
  CHECK(pocket->voxels == 3);
  CHECK(pocket->place == world_from_voxel(posed.grid) * glm::dvec3(16, 13, 15));

  // Air that was enclosed at rest is not new, even if it moved with the tissue around it.
  const JudgedPose twice{posed, posed, tissues};
  CHECK_FALSE(largest_air_pocket(twice, air_around(twice)));
  LabelVolume shifted = posed;
  ZeroedVector<glm::vec3> moved(posed.voxels.size());
  for (int x = 1; x < posed.grid.size.x; ++x)
    for (int z = 0; z < posed.grid.size.z; ++z)
      for (int y = 0; y < posed.grid.size.y; ++y) {
        shifted.at({x, y, z}) = posed.at({x - 1, y, z});
        if (shifted.at({x, y, z})) moved[shifted.grid.index({x, y, z})] = {2, 0, 0};
      }
  const JudgedPose along{posed, shifted, tissues, {moved.data(), moved.size()}};
  CHECK_FALSE(largest_air_pocket(along, air_around(along)));
}
