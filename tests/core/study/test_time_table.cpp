// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/time_table.h"

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("study times: median and range are over the repeats of bent poses, ratios over the poses") {
  Study study{.spacings = {2.0}};
  study.techniques = techniques_of({"lbs", "fem"}, "");
  const auto cell = [](int pose, int technique, double cpu, std::vector<double> repeats) {
    CellResult result{.cell = {0, pose, technique}, .cpu_seconds = cpu, .cpu_repeats = std::move(repeats)};
    if (pose > 0) result.joints = {{.bone = "Forearm", .degrees = 40}};
    return result;
  };
  const std::vector<CellResult> cells{cell(0, 0, 9, {9}),           cell(0, 1, 9, {9}),
                                      cell(1, 0, 2, {1, 2, 3}),     cell(1, 1, 8, {8, 7, 9}),
                                      cell(2, 0, 4, {4, 4.5, 3.5}), cell(2, 1, 40, {40, 39, 44})};
  const TechniqueTime linear = time_of(study, cells, 0, 0), fem = time_of(study, cells, 0, 1);
  CHECK(linear.seconds->median == 3.25);
  CHECK(linear.seconds->least == 1);
  CHECK(linear.seconds->most == 4.5);
  CHECK(linear.of_linear->median == 1);
  CHECK(fem.seconds->most == 44);
  CHECK(fem.of_linear->least == 4);
  CHECK(fem.of_linear->most == 10);
  CHECK(fem.of_linear->median == 7);
  study.techniques = techniques_of({"dqs", "fem"}, "");
  CHECK_FALSE(time_of(study, cells, 0, 1).of_linear);
  CHECK_FALSE(time_of(study, {}, 0, 1).seconds);
}
