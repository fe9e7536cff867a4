// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/grow_shrink.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

namespace {

// Returns the distance in mm from a voxel to the nearest one of the whole grid with label `label` (`with` is true) or
// with another label (false).
double nearest(const LabelVolume& volume, const glm::ivec3& from, Label label, bool with) {
  double least = 1e300;
  for_voxels(volume.grid, [&](const glm::ivec3& v) {
    if ((volume.at(v) == label) == with)
      least = std::min(least, glm::length(glm::dvec3(v - from) * volume.grid.spacing));
  });
  return least;
}

}  // namespace

TEST_CASE("grow: the voxels within the distance get the label, whatever the spacing") {
  const LabelVolume volume = random_labels(oblique_grid({13, 11, 9}), 4, 3);
  for (const double mm : {0.0, 0.9, 1.0, 2.5, 2.7, 4.0}) {
    LabelVolume grown = volume;
    apply_change(grown_label(volume, 1, mm, {}), grown);
    for_voxels(volume.grid, [&](const glm::ivec3& v) {
      const bool in = nearest(volume, v, 1, true) <= mm * (1 + 1e-9);
      CHECK(grown.at(v) == (in ? 1 : volume.at(v)));
    });
  }
}

TEST_CASE("grow: it respects the mask, and a ball grows into a larger ball") {
  const Grid grid = oblique_grid({50, 34, 22});
  const AffineTransform world = world_from_voxel(grid);
  const glm::dvec3 centre = world * glm::dvec3(25, 17, 11);
  const LabelVolume ball = volume_of(grid, [&](const glm::ivec3& v) {
    return Label(glm::distance(world * glm::dvec3(v), centre) <= 10 ? 1 : v.x > 25 ? 2 : 0);
  });
  LabelVolume grown = ball;
  apply_change(grown_label(ball, 1, 6, {}), grown);
  // A voxel's centre is at most half a diagonal away from any point of the ball.
  const double diagonal = glm::length(grid.spacing);
  for_voxels(grid, [&](const glm::ivec3& v) {
    const double away = glm::distance(world * glm::dvec3(v), centre);
    if (away > 16 + 1e-6) CHECK(grown.at(v) != 1);
    if (away < 16 - diagonal) CHECK(grown.at(v) == 1);
  });

  EditMask only_air;
  only_air.labels.assign(65536, 0);
  only_air.labels[0] = 1;
  LabelVolume masked = ball;
  apply_change(grown_label(ball, 1, 6, only_air), masked);
  for_voxels(grid, [&](const glm::ivec3& v) { CHECK(masked.at(v) == (ball.at(v) == 0 ? grown.at(v) : ball.at(v))); });
}

TEST_CASE("shrink: voxels within the distance of another label lose theirs") {
  const LabelVolume volume = random_labels(oblique_grid({13, 11, 9}), 3, 9);
  for (const double mm : {0.9, 1.0, 1.6, 2.5}) {
    LabelVolume air = volume, around = volume;
    apply_change(shrunk_label(volume, 1, mm, Erased::Air), air);
    apply_change(shrunk_label(volume, 1, mm, Erased::Surroundings), around);
    for_voxels(volume.grid, [&](const glm::ivec3& v) {
      const bool out = volume.at(v) == 1 && nearest(volume, v, 1, false) <= mm * (1 + 1e-9);
      CHECK(air.at(v) == (out ? 0 : volume.at(v)));
      if (out) CHECK(around.at(v) != 1);
      else CHECK(around.at(v) == volume.at(v));
    });
  }
}

TEST_CASE("grow and shrink: two threads do the same as one") {
  const LabelVolume volume = random_labels({{60, 50, 40}, {1, 2, 3}}, 3, 2);
  std::vector<LabelChange> changes;
  for (const int count : {1, 2}) {
    const ThreadCount threads(count);
    changes.push_back(grown_label(volume, 1, 3, {}));
    changes.push_back(shrunk_label(volume, 1, 2, Erased::Surroundings));
  }
  CHECK(changes[0] == changes[2]);
  CHECK(changes[1] == changes[3]);
  CHECK(changes[0].voxel_count() > 1000);
  CHECK(changes[1].voxel_count() > 1000);
}
