// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests strips, which play clips: strips of one track play one after another, and upper tracks play over lower ones.
#include "core/motion/strips.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/clip_speed.h"
#include "core/motion/mirror_clip.h"
#include "core/motion/motion_edit.h"
#include "core/motion/moved_strips.h"
#include "core/motion/recorded_clip.h"
#include "core/motion/strip_edits.h"
#include "core/motion/strips_on_rig.h"
#include "core/rig/mirror.h"
#include "tests/support/strip_takes.h"

namespace limber::test {

TEST_CASE("strips: one strip with full influence is its clip, bit for bit, and holds its ends") {
  const SharedClip clip = take("walk", 40, 1);
  const Strips strips = one_strip(clip, 100);
  for (int frame = 100; frame <= 139; ++frame) CHECK(at(strips, frame) == at(clip, frame - 100));
  CHECK(end_of(strips.tracks[0].strips[0], 30) == 139);
  CHECK(at(strips, -50) == at(clip, 0));
  CHECK(at(strips, 9000) == at(clip, 39));
  Strips let_go = strips;
  only(let_go).holds = false;
  CHECK(at(let_go, 99) == rest_pose(*rig()));
  CHECK(at(let_go, 140) == rest_pose(*rig()));
  CHECK(at(Strips{}, 7) == rest_pose(*rig()));
}

TEST_CASE("strips: a clip with strips plays them below its keys and constraints, and bakes to the same poses") {
  const SharedClip source = take("walk", 30, 2);
  Clip clip{.name = "Strips", .range_end = 29};
  clip.strips = std::make_shared<const Strips>(one_strip(source, 0));
  const glm::dquat raised = glm::angleAxis(1.0, glm::dvec3(1, 0, 0));
  clip.keys.bones["LeftArm"] = {{10, raised}};
  const auto shared = std::make_shared<const Clip>(clip);
  const ClipOnRig on_rig(shared, rig());
  CHECK(on_rig.problem().empty());
  CHECK(on_rig.has_base());
  const int arm = *rig()->find("LeftArm"), other = *rig()->find("RightArm");
  CHECK(on_rig.at(10).rotation[arm] == raised);
  CHECK(on_rig.base_at(20) == at(source, 20));
  // A key on top of strips corrects the rotation that they play, as it corrects that of a motion.
  const glm::dquat turn = raised * glm::conjugate(at(source, 10).rotation[arm]);
  const glm::dquat wanted = glm::normalize(glm::normalize(turn) * at(source, 20).rotation[arm]);
  CHECK(std::abs(glm::dot(on_rig.at(20).rotation[arm], wanted)) == doctest::Approx(1).epsilon(1e-12));
  CHECK(on_rig.at(20).rotation[other] == at(source, 20).rotation[other]);
  const auto baked = std::make_shared<const Clip>(baked_clip(shared, rig()));
  CHECK(!baked->strips);
  for (int frame = 0; frame < 30; ++frame) CHECK(far(at(baked, frame), on_rig.at(frame)) < 1e-4);
}

TEST_CASE("strips: strips that overlap cross-fade, and the fade's ends are exact") {
  const SharedClip first = take("walk", 40, 1), second = take("sit", 40, 3);
  Strips strips = one_strip(first, 0);
  insert_strip(strips.tracks[0], strip_of(second, strips, 30));
  CHECK(runs_of(strips.tracks[0], 30)[1].fade_in == 9);  // from 30 to 39, where the first strip ends
  CHECK(at(strips, 30) == at(first, 30));
  CHECK(at(strips, 39) == at(second, 9));
  CHECK(at(strips, 45) == at(second, 15));
  for (int frame = 31; frame < 39; ++frame) {
    const double part = (frame - 30) / 9.0, share = part * part * (3 - 2 * part);
    const Pose a = at(first, frame), b = at(second, frame - 30), mixed = at(strips, frame);
    for (std::size_t bone = 0; bone < a.rotation.size(); ++bone)
      CHECK(std::abs(glm::dot(mixed.rotation[bone], glm::slerp(a.rotation[bone], b.rotation[bone], share))) ==
            doctest::Approx(1).epsilon(1e-12));
    CHECK(glm::distance(mixed.root_translation, glm::mix(a.root_translation, b.root_translation, share)) < 1e-9);
  }
  // A strip may have a fade that is longer than its overlap. A muted strip does not play.
  strips.tracks[0].strips[1].blend_in = 20;
  CHECK(at(strips, 40) != at(second, 10));
  // While the second strip still fades in, the first one's last pose is held although it has ended.
  CHECK(far(at(strips, 39), at(strips, 40)) < 0.5 * far(at(first, 39), rest_pose(*rig())));
  CHECK(at(strips, 50) == at(second, 20));
  strips.tracks[0].strips[1].muted = true;
  CHECK(at(strips, 35) == at(first, 35));
}

TEST_CASE("strips: a strip fades out to what lies below it") {
  const SharedClip below = take("walk", 60, 1), above = take("wave", 21, 4);
  Strips strips = one_strip(below, 0);
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(above, strips, 20)}});
  Strip& over = strips.tracks[1].strips[0];
  over.holds = false;
  over.blend_in = over.blend_out = 5;
  CHECK(at(strips, 20) == at(below, 20));
  CHECK(at(strips, 25) == at(above, 5));
  CHECK(at(strips, 35) == at(above, 15));
  CHECK(at(strips, 40) == at(below, 40));
  CHECK(at(strips, 41) == at(below, 41));
  over.influence = 0;
  CHECK(at(strips, 30) == at(below, 30));
}

TEST_CASE("strips: only the bones of its group follow a strip") {
  const SharedClip below = take("walk", 60, 1), above = take("wave", 60, 4);
  Strips strips = one_strip(below, 0);
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(above, strips, 0)}});
  strips.tracks[1].strips[0].bones = std::set<std::string>{"LeftArm", "Spine", "no such bone"};
  const Pose pose = at(strips, 30);
  for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone) {
    const std::string& name = rig()->bones[bone].name;
    const bool is_above = name == "LeftArm" || name == "Spine";
    CHECK(pose.rotation[bone] == at(is_above ? above : below, 30).rotation[bone]);
  }
  CHECK(pose.root_translation == at(below, 30).root_translation);
  strips.tracks[1].strips[0].bones = std::set<std::string>{};
  CHECK(at(strips, 30) == at(below, 30));
}

TEST_CASE("strips: a rest pose that is added changes nothing, and rotations add about the bone's own axes") {
  const SharedClip below = take("walk", 60, 1);
  Clip still{.name = "Rest", .range_end = 59};
  still.keys.bones["LeftArm"] = {{0, {1, 0, 0, 0}}};
  const auto rest = std::make_shared<const Clip>(still);
  Strips strips = one_strip(below, 0);
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(rest, strips, 0)}});
  Strip& over = strips.tracks[1].strips[0];
  for (const StripBlend blend : {StripBlend::Add, StripBlend::AddChange})
    for (const double influence : {0.3, 1.0}) {
      over.blend = blend;
      over.influence = influence;
      for (int frame = 0; frame < 60; frame += 7) CHECK(at(strips, frame) == at(below, frame));
    }

  // The clip of the upper strip turns a bone by one degree per frame, starting at ten degrees.
  const auto bent = [](double degrees) { return glm::angleAxis(glm::radians(degrees), glm::dvec3(0, 1, 0)); };
  still.keys.bones["LeftArm"] = {{0, bent(10)}, {50, bent(60)}};
  over.clip = std::make_shared<const Clip>(still);
  const int arm = *rig()->find("LeftArm");
  const auto turned_by = [&](StripBlend blend, double influence) {
    over.blend = blend;
    over.influence = influence;
    const glm::dquat turn = glm::conjugate(at(below, 20).rotation[arm]) * at(strips, 20).rotation[arm];
    CHECK(std::abs(turn.x) < 1e-12);
    CHECK(std::abs(turn.z) < 1e-12);
    return glm::degrees(2 * std::atan2(turn.y, turn.w));
  };
  CHECK(turned_by(StripBlend::Add, 1) == doctest::Approx(30));
  CHECK(turned_by(StripBlend::Add, 0.5) == doctest::Approx(15));
  CHECK(turned_by(StripBlend::AddChange, 1) == doctest::Approx(20));
}

TEST_CASE("strips: at half the speed a strip plays the frames between its clip's by slerp") {
  const SharedClip clip = take("walk", 21, 1);
  Strips strips = one_strip(clip, 10);
  only(strips).speed = 0.5;
  CHECK(end_of(only(strips), 30) == 50);
  for (int frame = 0; frame <= 20; ++frame) CHECK(at(strips, 10 + 2 * frame) == at(clip, frame));
  const Pose a = at(clip, 4), b = at(clip, 5), between = at(strips, 19);
  for (std::size_t bone = 0; bone < a.rotation.size(); ++bone)
    CHECK(std::abs(glm::dot(between.rotation[bone], glm::slerp(a.rotation[bone], b.rotation[bone], 0.5))) ==
          doctest::Approx(1).epsilon(1e-12));
  CHECK(glm::distance(between.root_translation, (a.root_translation + b.root_translation) / 2.0) < 1e-9);
  // A clip with another frame rate keeps its speed: its 120 steps at 120 frames a second fill 30 frames of the strips.
  const SharedClip fast = take("fast", 121, 1, 120);
  strips = one_strip(fast, 0);
  CHECK(end_of(only(strips), 30) == 30);
  CHECK(at(strips, 30) == at(fast, 120));
  CHECK(at(strips, 7) == at(fast, 28));
}

TEST_CASE("strips: backwards and mirrored, a strip plays its clip backwards and mirrored") {
  const SharedClip clip = take("walk", 21, 1);
  Strips strips = one_strip(clip, 0);
  only(strips).reversed = true;
  for (int frame = 0; frame <= 20; ++frame) CHECK(at(strips, frame) == at(clip, 20 - frame));
  only(strips).reversed = false;
  only(strips).mirrored = true;
  for (int frame = 0; frame <= 20; ++frame) CHECK(at(strips, frame) == flipped(at(clip, frame), *rig()));

  // Mirroring a clip of several strips mirrors the pose that they play together.
  const SharedClip over = take("wave", 21, 5);
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(over, strips, 3)}});
  strips.tracks[1].strips[0].bones = std::set<std::string>{"LeftArm", "Hips"};
  strips.tracks[1].strips[0].influence = 0.6;
  strips.tracks[1].strips[0].place = {0.4, {10, 20, 0}, {-30, 5, 0}};
  Clip whole{.name = "Strips", .range_end = 20};
  whole.strips = std::make_shared<const Strips>(strips);
  const auto shared = std::make_shared<const Clip>(whole);
  const auto mirrored = std::make_shared<const Clip>(mirrored_clip(shared, rig()));
  for (int frame = 0; frame <= 24; ++frame) CHECK(far(at(mirrored, frame), flipped(at(shared, frame), *rig())) < 1e-9);
  const Strips twice = *mirrored_clip(mirrored, rig()).strips;
  CHECK(twice.tracks[0].strips[0].mirrored == strips.tracks[0].strips[0].mirrored);
  CHECK(twice.tracks[1].strips[0].bones == strips.tracks[1].strips[0].bones);
  CHECK(mirrored->strips->tracks[1].strips[0].bones == std::set<std::string>{"Hips", "RightArm"});
}

TEST_CASE("strips: each cycle begins where the one before ended, and its seam is as close as the clip's ends") {
  // A closed cycle of 20 steps. In each frame the body travels by 30 mm and turns by 0.02 radians, so it walks along a
  // circle.
  const auto pose_at = [](int frame) {
    Pose pose = rest_pose(*rig());
    const double phase = 2 * 3.14159265358979 * frame / 20;
    for (std::size_t bone = 1; bone < pose.rotation.size(); ++bone)
      pose.rotation[bone] = glm::angleAxis(0.5 * std::sin(phase + double(bone)), glm::dvec3(1, 0, 0));
    pose.rotation[0] = glm::angleAxis(0.02 * frame, glm::dvec3(0, 0, 1));
    const double radius = 1500;
    pose.root_translation = {radius * (1 - std::cos(0.02 * frame)), -radius * std::sin(0.02 * frame),
                             5 * std::sin(phase)};
    return pose;
  };
  Clip cycle = clip_of(std::make_shared<const Motion>(motion_of_poses(*rig(), 21, 30, pose_at)), "cycle");
  cycle.retarget.travel = Travel::Free;
  const auto clip = std::make_shared<const Clip>(cycle);
  Strips strips = one_strip(clip, 0);
  only(strips).repeat = 3.5;
  CHECK(end_of(only(strips), 30) == 70);
  // The cycles lead the body along its circle: in each frame the body has the pose that the formula gives.
  for (int frame = 0; frame <= 70; ++frame) CHECK(far(at(strips, frame), pose_at(frame)) < 0.02);
  const double step = far(at(strips, 18), at(strips, 19));
  for (const int seam : {20, 40, 60}) CHECK(far(at(strips, seam - 1), at(strips, seam)) < 1.01 * step);
  // If the cycles do not continue each other's travel, each one repeats the clip exactly.
  only(strips).goes_on = false;
  CHECK(at(strips, 47) == at(clip, 7));
  CHECK(at(strips, 70) == at(clip, 10));
  only(strips).repeat = 3;
  CHECK(at(strips, 60) == at(clip, 20));
  // Played backwards, the cycles lead the body back along the circle.
  only(strips).goes_on = only(strips).reversed = true;
  const Pose begin = at(strips, 0), end = at(strips, 60);
  CHECK(glm::degrees(2 * std::acos(std::min(1.0, std::abs(glm::dot(begin.rotation[0], end.rotation[0]))))) ==
        doctest::Approx(glm::degrees(1.2)).epsilon(1e-4));
}

TEST_CASE("strips: split, or trimmed at either end, a strip plays at the frames that stay as before") {
  const SharedClip clip = take("walk", 41, 1);
  std::mt19937 random(4);
  for (int trial = 0; trial < 60; ++trial) {
    Strips strips = one_strip(clip, 10);
    Strip& strip = only(strips);
    strip.speed = std::vector<double>{1, 2, 0.5, 0.7}[random() % 4];
    strip.repeat = std::vector<double>{1, 2, 1.5}[random() % 3];
    strip.reversed = random() % 2;
    strip.blend = random() % 3 == 0 ? StripBlend::AddChange : StripBlend::Replace;
    const int end = end_of(strip, 30);
    const int cut = strip.start + 1 + static_cast<int>(random() % static_cast<unsigned>(end - strip.start));
    Strips parts = strips;
    const auto [left, right] = split(strip, cut, 30, "second");
    parts.tracks[0].strips = {left, right};
    CHECK(right.start == cut);
    CHECK(end_of(right, 30) == end);
    CHECK(end_of(left, 30) == cut);
    for (int frame = 10; frame <= end; ++frame) CHECK(far(at(parts, frame), at(strips, frame)) < 1e-6);
    Strips late = strips, early = strips;
    only(late) = with_start(strip, std::min(cut, end - 1), 30);
    only(early) = with_end(strip, cut, 30);
    CHECK(end_of(only(early), 30) == cut);
    for (int frame = only(late).start; frame <= end; ++frame) CHECK(far(at(late, frame), at(strips, frame)) < 1e-6);
    for (int frame = 10; frame <= cut; ++frame) CHECK(far(at(early, frame), at(strips, frame)) < 1e-6);
    // If the start is then moved back, the strip plays as it did before.
    only(late) = with_start(only(late), 10, 30);
    for (int frame = 10; frame <= end; ++frame) CHECK(far(at(late, frame), at(strips, frame)) < 1e-6);
  }
  Strips strips = one_strip(clip, 10);
  CHECK_THROWS_AS(split(only(strips), 10, 30, "second"), Error);
  CHECK_THROWS_AS(split(only(strips), 51, 30, "second"), Error);
  // The ends of a strip that plays once cannot be moved beyond the ends of its clip.
  CHECK(with_end(only(strips), 500, 30).last == 40);
  CHECK(with_start(only(strips), -500, 30).start == 10);
}

TEST_CASE("strips: a strip is moved to where the body is, so that it goes on from there") {
  const SharedClip first = take("walk", 40, 1), second = take("run", 40, 3);
  Strips strips = one_strip(first, 0);
  insert_strip(strips.tracks[0], strip_of(second, strips, 39));
  Strip& next = strips.tracks[0].strips[1];
  next.place = place_where_body_is(strips, {0, 1}, rig(), 30);
  const Pose before = at(first, 39), after = at(strips, 39);
  CHECK(glm::distance(glm::dvec2(before.root_translation), glm::dvec2(after.root_translation)) < 1e-9);
  // The strip keeps its own height and its own rotation, except for the turn about the vertical.
  CHECK(after.root_translation.z == doctest::Approx(at(second, 0).root_translation.z));
  const glm::dquat turn = before.rotation[0] * glm::conjugate(after.rotation[0]);
  CHECK(std::abs(turn.z) < 1e-9);
  for (std::size_t bone = 1; bone < after.rotation.size(); ++bone)
    CHECK(after.rotation[bone] == at(second, 0).rotation[bone]);
}

TEST_CASE("strips: tracks are muted, and solo leaves the others out") {
  const SharedClip below = take("walk", 30, 1), above = take("wave", 30, 2);
  Strips strips = one_strip(below, 0);
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(above, strips, 0)}});
  CHECK(at(strips, 5) == at(above, 5));
  strips.tracks[0].solo = true;
  CHECK(at(strips, 5) == at(below, 5));
  strips.tracks[0].muted = true;
  CHECK(at(strips, 5) == rest_pose(*rig()));
  strips.tracks[0].solo = false;
  CHECK(at(strips, 5) == at(above, 5));
}

TEST_CASE("strips: another rate keeps what plays at each moment, and another speed its place in the motion") {
  Clip clip{.name = "Strips", .range_end = 120};
  Strips strips = one_strip(take("walk", 61, 1), 0);
  insert_strip(strips.tracks[0], strip_of(take("run", 61, 3), strips, 60));
  strips.tracks[0].strips[0].blend_in = 10;
  clip.strips = std::make_shared<const Strips>(strips);
  const auto shared = std::make_shared<const Clip>(clip);
  const auto doubled = std::make_shared<const Clip>(at_rate(clip, 60));
  const auto faster = std::make_shared<const Clip>(at_speed(clip, 2));
  CHECK(faster->rate == 30);
  for (int frame = 0; frame <= 120; frame += 2) {
    CHECK(far(at(doubled, 2 * frame), at(shared, frame)) < 1e-9);
    CHECK(far(at(faster, frame / 2), at(shared, frame)) < 1e-9);
  }
}

TEST_CASE("strips: a strip that moves stops beside the others, or overlaps them where it may") {
  Strips strips = one_strip(take("a", 11, 1), 0);                          // frames 0 to 10
  insert_strip(strips.tracks[0], strip_of(take("b", 21, 2), strips, 30));  // frames 30 to 50
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(take("c", 6, 3), strips, 100)}});
  const auto fits = [&](int frames, int tracks, Overlaps overlaps = Overlaps::Avoided) {
    return fitting_move(strips, {"a"}, {frames, tracks}, 30, overlaps);
  };
  CHECK(fits(7, 0) == StripMove{7, 0});
  CHECK(fits(20, 0) == StripMove{20, 0});  // strip "a" then touches strip "b"
  CHECK(fits(29, 0) == StripMove{20, 0});
  CHECK(fits(40, 0) == StripMove{50, 0});
  CHECK(fits(29, 0, Overlaps::Allowed) == StripMove{29, 0});
  CHECK(fits(29, 1) == StripMove{29, 1});
  CHECK(fits(29, 9) == StripMove{29, 1});
  CHECK(fits(29, -1) == StripMove{20, 0});
  const Strips moved = moved_strips(strips, {"a"}, {90, 1});
  CHECK(moved.tracks[0].strips.size() == 1);
  REQUIRE(moved.tracks[1].strips.size() == 2);
  CHECK(moved.tracks[1].strips[0].name == "a");
  CHECK(moved.tracks[1].strips[0].start == 90);
  Strips copied = strips;
  CHECK(add_copies(copied, {"a", "c"}) == std::set<std::string>{"a 2", "c 2"});
  CHECK(moved_strips(copied, {"a 2"}, {90, 1}).tracks[1].strips.size() == 3);
}

TEST_CASE("strips: a strip whose clip cannot move the rig says so, and the others play") {
  Motion motion;
  motion.joints = {{.name = "xyzzy", .channels = {BvhChannel::Xrotation}, .end_site = glm::dvec3(0, 1, 0)}};
  motion.channel_count = 1;
  motion.frame_count = 5;
  motion.values = {0, 1, 2, 3, 4};
  const SharedClip good = take("walk", 30, 1);
  const auto bad = std::make_shared<const Clip>(clip_of(std::make_shared<const Motion>(motion), "foreign"));
  Strips strips = one_strip(good, 0);
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(bad, strips, 10)}});
  strips.tracks[1].strips[0].holds = false;
  const StripsOnRig on_rig(std::make_shared<const Strips>(strips), rig(), 30);
  CHECK(on_rig.problem().starts_with("the strip \"foreign\" does not move this rig: "));
  CHECK(on_rig.at(5) == at(good, 5));
}

TEST_CASE("strips: those that no project can keep are refused") {
  const SharedClip clip = take("take", 10, 1);
  Strips strips = one_strip(clip, 0);
  require_within_limits(strips);
  const Strip one = strips.tracks[0].strips[0];

  Strips many = strips;
  many.tracks[0].strips.assign(kMostStrips, one);
  require_within_limits(many);
  many.tracks[0].strips.push_back(one);
  CHECK_THROWS_WITH_AS(require_within_limits(many), doctest::Contains("4096 strips"), Error);

  Strips high = strips;
  high.tracks.resize(kMostTracks + 1);
  CHECK_THROWS_AS(require_within_limits(high), Error);
  Strips late = strips;
  late.tracks[0].strips[0].start = kMostStripFrame + 1;
  CHECK_THROWS_AS(require_within_limits(late), Error);
  Strips far = strips;
  far.tracks[0].strips[0].place.to.y = 2 * kFarthestMove;
  CHECK_THROWS_AS(require_within_limits(far), Error);
}

TEST_CASE("strips: two threads evaluate what one does, and a frame of a long take is quick") {
  const SharedClip first = take("walk", 500, 1), second = take("run", 500, 2), over = take("wave", 500, 3);
  Strips strips = one_strip(first, 0);
  insert_strip(strips.tracks[0], strip_of(second, strips, 400));
  strips.tracks.push_back({.name = "Over", .strips = {strip_of(over, strips, 100)}});
  strips.tracks[1].strips[0].speed = 0.9;
  strips.tracks[1].strips[0].influence = 0.5;
  const StripsOnRig on_rig(std::make_shared<const Strips>(strips), rig(), 30);
  std::vector<Pose> alone(900), together(900);
  const auto began = std::chrono::steady_clock::now();
  for (int frame = 0; frame < 900; ++frame) alone[frame] = on_rig.at(frame);
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - began;
  std::vector<std::thread> threads;
  for (const int parity : {0, 1})
    threads.emplace_back([&, parity] {
      for (int frame = parity; frame < 900; frame += 2) together[frame] = on_rig.at(frame);
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(alone == together);
  MESSAGE("a frame of three strips takes " << passed.count() / 900 << " ms");
  CHECK(passed.count() / 900 < 10);  // ms; a loose bound, so that it holds with sanitizers and on loaded machines
}

}  // namespace limber::test
