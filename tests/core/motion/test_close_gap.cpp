// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/close_gap.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"

namespace limber::test {

namespace {

glm::dquat about_x(double radians) { return {std::cos(radians / 2), std::sin(radians / 2), 0, 0}; }
double angle_of(const Pose& pose) { return 2 * std::atan2(pose.rotation[0].x, pose.rotation[0].w); }

std::vector<Pose> swing(int frames) {
  std::vector<Pose> poses;
  for (int frame = 0; frame < frames; ++frame)
    poses.push_back({{about_x(std::sin(0.1 * frame))}, {3.0 * frame, std::cos(0.1 * frame), 0}});
  return poses;
}

}  // namespace

TEST_CASE("closing a gap: the bridge meets the motion with its speeds and follows a smooth one closely") {
  const std::vector<Pose> whole = swing(80);
  std::vector<Pose> bad = whole;
  for (int frame = 30; frame <= 39; ++frame) bad[frame] = {{about_x(2.5)}, {0, 0, 900}};
  const std::vector<Pose> closed = with_gap_closed(bad, 30, 39);
  REQUIRE(closed.size() == whole.size());
  for (int frame = 0; frame < 80; ++frame) {
    if (frame < 30 || frame > 39) {
      CHECK(closed[frame] == whole[frame]);
    } else {
      CHECK(std::abs(angle_of(closed[frame]) - angle_of(whole[frame])) < 0.02);
      CHECK(glm::distance(closed[frame].root_translation, whole[frame].root_translation) < 0.1);
    }
  }
  // At each end of the gap the motion keeps its speed, up to the small change of speed within the bridge.
  const auto step = [&](int frame) { return angle_of(closed[frame + 1]) - angle_of(closed[frame]); };
  CHECK(std::abs(step(29) - step(28)) < 0.01);
  CHECK(std::abs(step(39) - step(40)) < 0.01);
}

TEST_CASE("closing a gap: an even turn and an even walk go on evenly") {
  std::vector<Pose> even;
  for (int frame = 0; frame < 20; ++frame) even.push_back({{about_x(0.05 * frame)}, {2.0 * frame, 0, 0}});
  std::vector<Pose> bad = even;
  for (int frame = 5; frame <= 12; ++frame) bad[frame] = {{about_x(-1)}, {0, 7, 0}};
  const std::vector<Pose> closed = with_gap_closed(bad, 5, 12);
  for (int frame = 0; frame < 20; ++frame) {
    CHECK(std::abs(angle_of(closed[frame]) - 0.05 * frame) < 1e-12);
    CHECK(glm::distance(closed[frame].root_translation, even[frame].root_translation) < 1e-12);
  }
}

TEST_CASE("closing a gap: two frames are needed on either side") {
  CHECK_THROWS_AS(with_gap_closed(swing(20), 1, 5), Error);
  CHECK_THROWS_AS(with_gap_closed(swing(20), 10, 18), Error);
  CHECK_THROWS_AS(with_gap_closed(swing(20), 10, 9), Error);
  CHECK(with_gap_closed(swing(20), 2, 17).size() == 20);
}

}  // namespace limber::test
