// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/visible_field.h"

#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

LabelSet set_of(std::initializer_list<int> labels) {
  LabelSet set(65536);
  for (const int label : labels) set[static_cast<size_t>(label)] = 1;
  return set;
}

}  // namespace

TEST_CASE("visible field: a change of the set computes only the blocks that it touches") {
  Studio studio;
  const Grid grid = grid_of({200, 60, 60});
  // Label 1 fills a cylinder, and label 2 one end of it.
  const auto volume = painted(grid, [](const glm::dvec3& p) -> Label {
    if (glm::length(glm::dvec2(p.y, p.z) - glm::dvec2(30)) > 20) return 0;
    return p.x < 12 ? 2 : 1;
  });
  const VolumeTexture texture(volume, TextureLimits{.side = 2048});
  VisibleField field(texture, set_of({1, 2}));
  const std::int64_t all = field.blocks_computed();
  field.update(texture, set_of({1}));
  CHECK(field.blocks_computed() > 0);
  CHECK(field.blocks_computed() < all / 2);
  field.update(texture, set_of({}));
  CHECK(field.hull().empty());
}

TEST_CASE("visible field: the hull is closed tightly about the body") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  const auto volume =
      painted(grid, [](const glm::dvec3& p) -> Label { return glm::length(p - glm::dvec3(32)) < 20 ? 1 : 0; });
  const VolumeTexture texture(volume, TextureLimits{.side = 2048});
  const VisibleField field(texture, set_of({1}));
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(field.hull().low()[axis] <= 12 + kPad);
    CHECK(field.hull().low()[axis] >= 12 + kPad - 2 * kBrick);
    CHECK(field.hull().high()[axis] >= 52 + kPad);
    CHECK(field.hull().high()[axis] <= 52 + kPad + 2 * kBrick);
  }
  CHECK(field.hull().face_count() > 300);
  CHECK(field.hull().face_count() < 1500);
}

TEST_CASE("block layout: every tissue voxel lies in a block that is kept, far empty blocks are not") {
  const Grid grid = grid_of({150, 100, 90});
  const auto volume = painted(grid, [](const glm::dvec3& p) -> Label {
    return glm::length(p - glm::dvec3(30, 30, 30)) < 12 || p == glm::dvec3(149, 99, 89) ? 1 : 0;
  });
  BlockLayout layout = block_layout(*volume);
  for (int z = 0; z < 90; ++z)
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 150; ++x)
        if (volume->at({x, y, z}) != 0)
          REQUIRE(
              layout.slot_of_block[static_cast<size_t>(layout.block_index((glm::ivec3(x, y, z) + kPad) / kBlock))] >=
              0);
  CHECK(layout.block_of_slot.size() < layout.slot_of_block.size() / 2);
  REQUIRE(place_slots(layout, 256));
  CHECK(layout.atlases == 1);
  CHECK_FALSE(place_slots(layout, 30));
}

TEST_CASE("block layout: halving keeps the place of the body and its volume") {
  const Grid grid = grid_of({41, 40, 39}, {1, 1.5, 2});
  const auto volume =
      painted(grid, [](const glm::dvec3& p) -> Label { return glm::length(p - glm::dvec3(20, 30, 38)) < 17 ? 5 : 0; });
  const LabelVolume half = halved(*volume);
  const auto measure = [](const LabelVolume& v) {
    glm::dvec3 sum(0);
    std::int64_t count = 0;
    const AffineTransform to_world = world_from_voxel(v.grid);
    for (int z = 0; z < v.grid.size.z; ++z)
      for (int y = 0; y < v.grid.size.y; ++y)
        for (int x = 0; x < v.grid.size.x; ++x)
          if (v.at({x, y, z}) == 5) sum += to_world * glm::dvec3(x, y, z), ++count;
    return std::pair(sum / double(count), double(count) * v.grid.voxel_volume());
  };
  const auto [centre, size] = measure(*volume);
  const auto [half_centre, half_size] = measure(half);
  CHECK(glm::length(centre - half_centre) < 0.4);
  CHECK(half_size == doctest::Approx(size).epsilon(0.1));
}
