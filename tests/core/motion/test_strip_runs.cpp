// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests strips that touch, where the second strip continues the clip of the first: they must play like one strip.
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/clip_speed.h"
#include "core/motion/moved_strips.h"
#include "tests/support/strip_takes.h"

namespace limber::test {

namespace {

using Random = std::mt19937;

template <class T>
T any_of(Random& random, const std::vector<T>& choices) {
  return choices[random() % choices.size()];
}

// Returns two tracks of strips that overlap, touch or lie apart, with fades, influences and bones of all kinds.
Strips any_strips(Random& random) {
  static const std::vector<SharedClip> kTakes = {take("walk", 41, 1), take("wave", 61, 2), take("run", 31, 3)};
  Strips strips;
  strips.tracks = {{.name = "Low"}, {.name = "High"}};
  for (int i = 0; i < 5; ++i) {
    Strip strip = strip_of(any_of(random, kTakes), strips, static_cast<int>(random() % 110));
    strip.speed = any_of<double>(random, {1, 1, 2, 0.5});
    strip.repeat = any_of<double>(random, {1, 1, 1.5});
    strip.reversed = random() % 4 == 0;
    strip.holds = random() % 3 != 0;
    strip.blend = any_of<StripBlend>(random, {StripBlend::Replace, StripBlend::Replace, StripBlend::Replace,
                                              StripBlend::Add, StripBlend::AddChange});
    strip.influence = any_of<double>(random, {1, 1, 0.3, 0.8});
    strip.blend_in = any_of<int>(random, {0, 0, 6, 15});
    strip.blend_out = any_of<int>(random, {0, 0, 6, 15});
    strip.muted = random() % 8 == 0;
    if (random() % 4 == 0) strip.bones = std::set<std::string>{"LeftArm", "Hips"};
    insert_strip(strips.tracks[random() % 2], std::move(strip));
  }
  return strips;
}

}  // namespace

TEST_CASE("strips: whatever strip is split, and wherever, all plays as before") {
  Random random(11);
  int splits = 0, inside_fades = 0, below_others = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Strips before = any_strips(random);
    Strips parts = before;
    for (int cut = 0; cut < 3; ++cut) {  // a part may be split again
      StripTrack& track = parts.tracks[random() % 2];
      if (track.strips.empty()) continue;
      const std::size_t index = random() % track.strips.size();
      const Strip strip = track.strips[index];
      const StripRun run = runs_of(track, 30)[index];
      const int end = end_of(strip, 30);
      if (end - strip.start < 2) continue;
      const int frame = strip.start + 1 + static_cast<int>(random() % static_cast<unsigned>(end - strip.start - 1));
      const auto [left, right] = split(strip, frame, 30, unique_strip_name(parts, strip.name));
      track.strips[index] = left;
      insert_strip(track, right);
      ++splits;
      inside_fades += frame < run.start + run.fade_in || frame > run.end - run.fade_out;
      below_others += index + 1 < track.strips.size() - 1 && track.strips[index + 1].start < frame;
    }
    for (int frame = -5; frame < 260; frame += 1 + trial % 3) {
      const double apart = far(at(parts, frame), at(before, frame));
      CHECK_MESSAGE(apart < 1e-6, "trial " << trial << ", frame " << frame);
      if (apart >= 1e-6) return;
    }
  }
  CHECK(splits > 300);
  CHECK(inside_fades > 60);
  CHECK(below_others > 60);
}

TEST_CASE("strips: parts of a strip that are moved apart, faded or changed play on their own") {
  const SharedClip clip = take("walk", 41, 1);
  Strips strips = one_strip(clip, 0);
  only(strips).influence = 0.5;
  auto [left, right] = split(only(strips), 20, 30, "second");
  strips.tracks[0].strips = {left, right};
  CHECK(runs_of(strips.tracks[0], 30)[1].start == 0);
  CHECK(runs_of(strips.tracks[0], 30)[0].end == 40);
  CHECK(runs_of(strips.tracks[0], 30)[0].has_next);
  const auto starts_at = [&](const std::function<void(Strip&)>& change) {
    Strips changed = strips;
    change(changed.tracks[0].strips[1]);
    return runs_of(changed.tracks[0], 30)[1].start;
  };
  CHECK(starts_at([](Strip& strip) { strip.influence = 1; }) == 0);
  CHECK(starts_at([](Strip& strip) { strip.start = 21; }) == 21);
  CHECK(starts_at([](Strip& strip) { strip.blend_in = 3; }) == 20);
  CHECK(starts_at([](Strip& strip) { strip.muted = true; }) == 20);
  CHECK(starts_at([](Strip& strip) { strip.speed = 2; }) == 20);
  CHECK(starts_at([](Strip& strip) { strip.first = 25; }) == 20);
  CHECK(starts_at([](Strip& strip) { strip.bones = std::set<std::string>{"Hips"}; }) == 20);
  CHECK(starts_at([](Strip& strip) { strip.clip = take("other", 41, 2); }) == 20);
}

TEST_CASE("strips: a strip inside a longer one of its track fades in and out again") {
  const SharedClip walk = take("walk", 121, 1), wave = take("wave", 41, 3);
  Strips strips = one_strip(walk, 0);
  insert_strip(strips.tracks[0], strip_of(wave, strips, 30));
  CHECK(at(strips, 30) == at(walk, 30));
  CHECK(at(strips, 50) == at(wave, 20));
  CHECK(at(strips, 70) == at(walk, 70));
  CHECK(at(strips, 100) == at(walk, 100));
  // The pose does not jump: its largest change from one frame to the next is small.
  double step = 0;
  for (int frame = 20; frame < 90; ++frame) step = std::max(step, far(at(strips, frame), at(strips, frame + 1)));
  CHECK(step < 0.5 * far(at(wave, 40), at(walk, 71)));
  // If the strip has fades of its own, 4 and 6 frames long, these are used.
  strips.tracks[0].strips[1].blend_in = 4;
  strips.tracks[0].strips[1].blend_out = 6;
  CHECK(at(strips, 34) == at(wave, 4));
  CHECK(at(strips, 64) == at(wave, 34));
  CHECK(at(strips, 70) == at(walk, 70));
}

TEST_CASE("strips: a strip that overlaps another one is moved along it, and not off it") {
  Strips strips = one_strip(take("a", 101, 1), 0);  // 0 to 100
  insert_strip(strips.tracks[0], strip_of(take("b", 21, 2), strips, 40));
  insert_strip(strips.tracks[0], strip_of(take("c", 21, 3), strips, 120));
  const auto fits = [&](int frames) { return fitting_move(strips, {"b"}, {frames, 0}, 30, Overlaps::Avoided).frames; };
  CHECK(fits(3) == 3);
  CHECK(fits(-25) == -25);
  // A move of 70 frames would overlap strip "c", so strip "b" stops after 60 frames, where the two touch.
  CHECK(fits(70) == 60);
}

TEST_CASE("strips: a speed that a strip cannot have is refused") {
  Clip clip{.name = "Strips", .range_end = 40};
  Strips strips = one_strip(take("walk", 41, 1), 0);
  only(strips).speed = 0.1;
  clip.strips = std::make_shared<const Strips>(strips);
  CHECK(at_speed(clip, 0.5).strips->tracks[0].strips[0].speed == doctest::Approx(0.05));
  CHECK_THROWS_WITH_AS(at_speed(clip, 0.4), doctest::Contains("too slowly"), Error);
  only(strips).speed = 10;
  clip.strips = std::make_shared<const Strips>(strips);
  CHECK_THROWS_WITH_AS(at_speed(clip, 3), doctest::Contains("too fast"), Error);
}

TEST_CASE("strips: a beginning behind the strip's end is refused, and edits of far frames stay within their limits") {
  Strips strips = one_strip(take("walk", 41, 1), 0);
  only(strips).skip = 40;
  require_within_limits(strips);
  only(strips).skip = 40.01;
  CHECK_THROWS_AS(require_within_limits(strips), Error);
  only(strips).skip = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(require_within_limits(strips), Error);

  Strip far = only(strips);
  far.first = -(1 << 28);
  far.last = 1 << 28;
  far.repeat = kMostRepeats;
  far.skip = frames_of_cycles(far);
  far.speed = kSlowest;
  far.start = 1 << 28;
  for (const int frame : {-(1 << 28), 0, 1 << 28}) {
    CHECK(std::abs(std::int64_t{with_start(far, frame, 1000).start}) <= kMostStripFrame);
    CHECK(end_of(with_end(far, frame, 1000), 1000) <= kMostStripFrame);
  }
  far.skip = 0;
  far.repeat = 1;
  CHECK(with_start(far, -(1 << 28), 0.01).first >= -(1 << 28));
}

}  // namespace limber::test
