// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/label_stroke.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

namespace {

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  double least = 1e300;  // least distance to points of the segment, by brute force
  for (int i = 0; i <= 4000; ++i) least = std::min(least, glm::distance(p, glm::mix(a, b, i / 4000.0)));
  return least;
}

std::shared_ptr<const LabelVolume> shared(LabelVolume volume) {
  return std::make_shared<const LabelVolume>(std::move(volume));
}

}  // namespace

TEST_CASE("label stroke: a dab paints the voxels of a ball in mm, on an oblique grid with unequal spacing") {
  const Grid grid = oblique_grid({30, 24, 18});
  const auto before = shared(random_labels(grid, 3, 2));
  const AffineTransform world = world_from_voxel(grid);
  const glm::dvec3 centre = world * glm::dvec3(14.3, 11.6, 8.9);
  LabelStroke stroke(before, {.label = 7, .radius = 9});
  CHECK(stroke.empty());
  stroke.to(centre);
  std::int64_t painted = 0;
  for_voxels(grid, [&](const glm::ivec3& v) {
    const bool inside = glm::distance(world * glm::dvec3(v), centre) <= 9;
    painted += inside;
    CHECK(stroke.volume()->at(v) == (inside ? 7 : before->at(v)));
  });
  CHECK(painted > 500);
  CHECK(stroke.change().voxel_count() == painted);
  // The stroke's volume is the analytic volume of the ball within 3 %.
  CHECK(static_cast<double>(painted) * grid.voxel_volume() == doctest::Approx(4.0 / 3 * M_PI * 729).epsilon(0.03));
  LabelVolume back = *stroke.volume();
  take_back_change(stroke.change(), back);
  CHECK(back.voxels == before->voxels);
}

TEST_CASE("label stroke: it sweeps a capsule, and has the same voxels however often the pointer was asked") {
  const Grid grid = oblique_grid({40, 30, 14});
  const auto before = shared(random_labels(grid, 2, 4));
  const AffineTransform world = world_from_voxel(grid);
  const glm::dvec3 a = world * glm::dvec3(6, 7, 5), b = world * glm::dvec3(31, 20, 8);
  LabelStroke once(before, {.label = 5, .radius = 5}), often(before, {.label = 5, .radius = 5});
  once.to(a);
  once.to(b);
  for (int i = 0; i <= 10; ++i) often.to(glm::mix(a, b, i / 10.0));
  for_voxels(grid, [&](const glm::ivec3& v) {
    const double away = distance_to_segment(world * glm::dvec3(v), a, b);
    if (std::abs(away - 5) > 1e-3) CHECK((once.volume()->at(v) == 5) == (away < 5));
  });
  for_voxels(grid, [&](const glm::ivec3& v) {
    INFO(v.x, " ", v.y, " ", v.z, " ", distance_to_segment(world * glm::dvec3(v), a, b));
    CHECK(once.volume()->at(v) == often.volume()->at(v));
  });

  LabelStroke lifted(before, {.label = 5, .radius = 5});
  lifted.to(a);
  lifted.lift();
  lifted.to(b);
  CHECK(lifted.volume()->at({18, 13, 6}) != 5);  // between the two balls
  CHECK(once.volume()->at({18, 13, 6}) == 5);
}

TEST_CASE("label stroke: a flat brush paints one layer of voxels, along each voxel axis") {
  const Grid grid = oblique_grid({20, 20, 20});
  const auto before = shared(volume_of(grid, [](const glm::ivec3&) { return Label(0); }));
  const AffineTransform world = world_from_voxel(grid);
  for (int axis = 0; axis < 3; ++axis)
    for (const double off : {-0.49, 0.0, 0.3, 0.5}) {
      glm::dvec3 at(10, 10, 10);
      at[axis] += off;
      LabelStroke stroke(before, {.label = 1, .radius = 6, .flat = grid.direction[axis]});
      stroke.to(world * at);
      const VoxelBox box = bounds_of(stroke.change(), grid);
      CHECK(box.size[axis] == 1);
      CHECK(std::abs(box.lowest[axis] - at[axis]) <= 0.5);
      const double disc = stroke.change().voxel_count() * grid.voxel_volume() / grid.spacing[axis];
      CHECK(disc == doctest::Approx(M_PI * 36).epsilon(0.12));

      // A brush smaller than a voxel still paints the voxel that contains its centre.
      LabelStroke small(before, {.label = 1, .radius = 0.2 * grid.spacing[axis], .flat = grid.direction[axis]});
      small.to(world * at);
      CHECK(small.change().voxel_count() == 1);
      LabelStroke outside(before, {.label = 1, .radius = 6, .flat = grid.direction[axis]});
      at[axis] = off < 0 ? -0.6 : 19.6;
      outside.to(world * at);
      CHECK(outside.empty());
    }
}

TEST_CASE("label stroke: it changes only labels and image values that the mask allows") {
  const Grid grid = oblique_grid({24, 20, 16});
  const auto before = shared(random_labels(grid, 4, 8));
  Grid other = grid;  // the image has a grid of its own, twice as fine along x
  other.size.x = 48;
  other.spacing.x /= 2;
  std::vector<float> values(static_cast<std::size_t>(other.voxel_count()));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i * 37 % 1000);
  const auto image = std::make_shared<const GreyLevels>(grey_levels(other, values));
  LabelStrokeSettings settings{.label = 9, .radius = 14};
  settings.mask.labels.assign(65536, 0);
  settings.mask.labels[0] = settings.mask.labels[2] = 1;
  settings.mask.image = image;
  settings.mask.low = 300, settings.mask.high = 800;
  LabelStroke stroke(before, settings);
  const AffineTransform world = world_from_voxel(grid);
  const glm::dvec3 centre = world * glm::dvec3(12, 10, 8);
  stroke.to(centre);
  int painted = 0;
  for_voxels(grid, [&](const glm::ivec3& v) {
    const Label was = before->at(v);
    const double value = image->value_at({2 * v.x, v.y, v.z});
    const bool may =
        glm::distance(world * glm::dvec3(v), centre) <= 14 && (was == 0 || was == 2) && value >= 300 && value <= 800;
    painted += may;
    CHECK(stroke.volume()->at(v) == (may ? 9 : was));
  });
  CHECK(painted > 100);
}

TEST_CASE("label stroke: erasing a leak gives it back to the tissue around it") {
  // Bone (1) beside muscle (2). A rod of the bone's label has leaked into the muscle.
  const Grid grid{{40, 30, 30}};
  const auto rod = [](const glm::ivec3& v) {
    return v.x >= 10 && v.x < 24 && std::abs(v.y - 15) < 2 && std::abs(v.z - 15) < 2;
  };
  const auto before = shared(volume_of(grid, [&](const glm::ivec3& v) { return Label(v.x < 10 || rod(v) ? 1 : 2); }));
  LabelStroke stroke(before, {.label = 1, .erases = true, .radius = 4});
  stroke.to({15, 15, 15});
  stroke.to({23, 15, 15});
  for_voxels(grid, [&](const glm::ivec3& v) {
    if (v.x >= 15) CHECK(stroke.volume()->at(v) == 2);
    if (v.x < 10) CHECK(stroke.volume()->at(v) == 1);
  });
  LabelStroke air(before, {.label = 1, .erases = true, .erased = Erased::Air, .radius = 4});
  air.to({18, 15, 15});
  CHECK(air.volume()->at({18, 15, 15}) == 0);
  CHECK(air.volume()->at({18, 19, 15}) == 2);

  // If no other label is near, erased voxels become air.
  LabelStroke inside(shared(volume_of(grid, [](const glm::ivec3&) { return Label(1); })),
                     {.label = 1, .erases = true, .radius = 3});
  inside.to({20, 15, 15});
  CHECK(inside.volume()->at({20, 15, 15}) == 0);
  CHECK(inside.volume()->at({20, 19, 15}) == 1);
}

TEST_CASE("label stroke: beyond the grid nothing is painted, and at its rim only what lies inside") {
  const Grid grid{{10, 10, 10}};
  const auto before = shared(volume_of(grid, [](const glm::ivec3&) { return Label(3); }));
  LabelStroke stroke(before, {.label = 4, .radius = 3});
  stroke.to({50, 5, 5});
  CHECK(stroke.empty());
  CHECK(stroke.last_box().size.x == 0);
  stroke.lift();
  stroke.to({-1, 5, 5});
  CHECK(stroke.volume()->at({0, 5, 5}) == 4);
  CHECK(stroke.volume()->at({2, 5, 5}) == 4);
  CHECK(stroke.volume()->at({3, 5, 5}) == 3);
  CHECK_THROWS_AS(LabelStroke(before, {.label = 4, .radius = 0}), std::logic_error);
}

TEST_CASE("label stroke: with a copy of the volume made ahead it paints the same labels, and leaves the volume alone") {
  const Grid grid = oblique_grid({24, 20, 16});
  const auto before = shared(random_labels(grid, 3, 6));
  const LabelVolume kept = *before;
  const AffineTransform world = world_from_voxel(grid);
  LabelStroke plain(before, {.label = 7, .radius = 6}),
      ahead(before, {.label = 7, .radius = 6}, std::make_shared<LabelVolume>(*before));
  for (LabelStroke* stroke : {&plain, &ahead}) {
    stroke->to(world * glm::dvec3(5, 6, 7));
    stroke->to(world * glm::dvec3(17, 12, 9));
    CHECK_FALSE(stroke->empty());
  }
  CHECK(plain.volume()->voxels == ahead.volume()->voxels);
  CHECK(plain.change().voxel_count() == ahead.change().voxel_count());
  CHECK(before->voxels == kept.voxels);
}
