// SPDX-License-Identifier: AGPL-3.0-or-later
// Exports a motion as pictures. Each picture must show the body as the 3D view shows it when it has stopped at that
// frame.
#include <doctest/doctest.h>

#include "core/motion/recorded_clip.h"
#include "editor/context/operator.h"
#include "editor/files/picture_files.h"
#include "editor/motion/timeline.h"
#include "editor/pose/live_preview.h"
#include "editor/shown/frame_all.h"
#include "render/image_io.h"
#include "tests/editor/small_clip.h"
#include "tests/editor/weighed_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// Returns the mean difference of two pictures' colours, 0 to 255.
double difference(const render::Image& a, const render::Image& b) {
  if (a.rgba.size() != b.rgba.size()) return 255;
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(int{a.rgba[i]} - int{b.rgba[i]});
  return sum / static_cast<double>(std::max<std::size_t>(1, a.rgba.size()));
}

}  // namespace

TEST_CASE(
    "motion pictures: each frame of the range is drawn as the 3D view shows it at rest, and nothing else changes") {
  LimbEditor test({900, 640});
  Document document = bending_limb();
  document.weights = half_weights(*document.volume);
  test.editor->history->reset(std::move(document), "Open limb");
  const TemporaryFolder folder;
  test.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
  edit_clip(*test.editor, "Range", PoseThen::FromClip, [](Clip& clip) {
    clip.range_start = 38;
    clip.range_end = 41;
  });
  const Document before = test.editor->document();
  const auto exported = [&](const char* menu, const std::string& file) {
    test.play(std::string("click \"File/Export/") + menu + "\"\n wait-idle\n key Ctrl+A\n type \"" +
              (folder / file).string() + "\"\n key Return\n wait-idle\n" + (menu[0] == 'M' ? "key Return\n" : "") +
              "wait-job\n wait-idle");
  };
  exported("Motion as pictures...", "steps.png");
  CHECK(test.editor->document() == before);
  for (int picture = 0; picture < 4; ++picture) {
    CAPTURE(picture);
    const Path file = folder / ("steps-000" + std::to_string(picture) + ".png");
    REQUIRE(std::filesystem::exists(file));
    go_to_frame(*test.editor, 38 + picture);
    test.play("wait-idle\n wait 1\n wait-idle");
    exported("Picture...", "view.png");
    CHECK(difference(render::read_png(file), render::read_png(folder / "view.png")) < 0.05);
    std::filesystem::remove(folder / "view.png");
  }
  CHECK_FALSE(std::filesystem::exists(folder / "steps-0004.png"));
  CHECK(difference(render::read_png(folder / "steps-0000.png"), render::read_png(folder / "steps-0003.png")) > 0.05);
}

TEST_CASE(
    "motion pictures: a method chosen while they are drawn changes none, and a cancelled export leaves no trace") {
  LimbEditor test({900, 640});
  Document document = bending_limb();
  document.weights = half_weights(*document.volume);
  test.editor->history->reset(std::move(document), "Open limb");
  const TemporaryFolder folder;
  test.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle\n click resample.dqs\n wait-job\n wait-idle");
  edit_clip(*test.editor, "Range", PoseThen::FromClip, [](Clip& clip) {
    clip.range_start = 50;
    clip.range_end = 59;
  });
  go_to_frame(*test.editor, 59);
  test.play("wait-idle\n wait 1\n wait-idle");
  const auto fine = test.editor->live->map();
  REQUIRE(fine);

  export_motion_pictures(*test.editor, folder / "as-set.png");
  CHECK(why_no_motion_pictures(*test.editor) == "The pictures of a motion are being drawn");
  test.play("wait-job\n wait-idle");
  export_motion_pictures(*test.editor, folder / "chosen.png");
  for (int i = 0; i < 3; ++i) test.player.step();
  test.play("click resample.lbs");
  CHECK(test.editor->live->is_lent());  // otherwise the method was changed too late
  test.play("wait-job\n wait-idle");
  for (int picture = 0; picture < 10; ++picture) {
    const std::string number = "-000" + std::to_string(picture) + ".png";
    CHECK(difference(render::read_png(folder / ("as-set" + number)), render::read_png(folder / ("chosen" + number))) ==
          0);
  }
  export_motion_pictures(*test.editor, folder / "linear.png");
  test.play("wait-job\n wait-idle");
  CHECK(difference(render::read_png(folder / "as-set-0009.png"), render::read_png(folder / "linear-0009.png")) > 0.05);

  // After a cancelled export, the 3D view returns to full resolution.
  test.play("click resample.dqs\n wait-job\n wait-idle");
  export_motion_pictures(*test.editor, folder / "cancelled.png");
  test.player.step();
  for (const JobStatus& job : test.editor->jobs->statuses()) test.editor->jobs->cancel(job.id);
  test.play("wait-job\n wait-idle\n wait 1\n wait-idle");
  CHECK(why_no_motion_pictures(*test.editor) == "");
  CHECK_FALSE(std::filesystem::exists(folder / "cancelled-0009.png"));
  REQUIRE(test.editor->live->map());
  CHECK(test.editor->live->map()->step == fine->step);
}

TEST_CASE("motion pictures: too many are refused before they are listed") {
  LimbEditor test({900, 640});
  Document document = bending_limb();
  document.weights = half_weights(*document.volume);
  test.editor->history->reset(std::move(document), "Open limb");
  const TemporaryFolder folder;
  // Tries two billion frames, and a video of a clip that shows one frame in 100 seconds.
  edit_clip(*test.editor, "Range", PoseThen::FromClip, [](Clip& clip) {
    clip.range_start = -1'000'000'000;
    clip.range_end = 1'000'000'000;
  });
  CHECK_THROWS_WITH_AS(export_motion_pictures(*test.editor, folder / "long.png"),
                       doctest::Contains("2000000001 pictures"), Error);
  edit_clip(*test.editor, "Range", PoseThen::FromClip, [](Clip& clip) {
    clip.range_start = 0;
    clip.range_end = 100;
    clip.rate = 0.01;
  });
  CHECK_THROWS_WITH_AS(export_motion_pictures(*test.editor, folder / "slow.mp4"), doctest::Contains("too many frames"),
                       Error);
}

TEST_CASE("motion pictures: without weights or a clip it is said what is missing") {
  LimbEditor test({900, 640});
  const Operator* op = find_operator(test.editor->operators, "file.export_motion_pictures");
  REQUIRE(op);
  CHECK(op->disabled_reason(*test.editor) == "Import a motion first, or insert a key");
  Document document = bending_limb();
  document.weights = nullptr;
  test.editor->history->reset(std::move(document), "Open limb");
  CHECK(op->disabled_reason(*test.editor) == "Compute the weights first");
}

TEST_CASE("motion pictures: a camera that follows the body keeps it where it is, and the file has the clip's name") {
  LimbEditor test({900, 640});
  Document document = bending_limb();
  document.weights = half_weights(*document.volume);
  std::vector<Pose> poses(4, rest_pose(*document.armature));
  for (int frame = 0; frame < 4; ++frame) poses[frame].root_translation = {8.0 * frame, 0, 3.0 * frame};
  document.clips = {
      std::make_shared<const Clip>(clip_of_poses({.name = "off to/town", .rate = 30}, *document.armature, poses, 0))};
  document.clip = 0;
  document.frame = 0;
  document.pose = nullptr;
  test.editor->history->reset(std::move(document), "Open limb");
  const TemporaryFolder folder;
  test.editor->project->path = folder / "limb.limber";
  test.play(
      "key Ctrl+3\n move \"3D view/view\"\n wait-idle\n click \"File/Export/Motion as pictures...\"\n wait-idle\n key "
      "Return\n wait-idle\n key Return\n wait-job\n wait-idle");
  test.play("click \"File/Export/Motion as pictures...\"\n wait-idle\n key Ctrl+A\n type \"" +
            (folder / "along.png").string() +
            "\"\n key Return\n wait-idle\n click \"Camera/Follow the body\"\n wait-idle\n key Return\n wait-job\n "
            "wait-idle");
  const auto picture = [&](const char* name) { return render::read_png(folder / name); };
  CHECK(difference(picture("off to-town-0000.png"), picture("along-0000.png")) == 0);
  const double still = difference(picture("off to-town-0000.png"), picture("off to-town-0003.png"));
  const double along = difference(picture("along-0000.png"), picture("along-0003.png"));
  CAPTURE(still);
  CAPTURE(along);
  // If the camera follows the body, two frames differ only at edges of voxels, which are sampled at other positions.
  CHECK(still > 10 * along);
  // The motion's own file may lie in the same folder under the clip's name.
  test.play("click \"File/Export/Motion...\"\n wait-idle\n key Return\n wait-job\n wait-idle");
  CHECK(std::filesystem::exists(folder / "off to-town-motion.bvh"));
  CHECK_FALSE(std::filesystem::exists(folder / "off to-town.bvh"));
}

TEST_CASE("motion pictures: a camera follows the body from where it is seen, outside of the range or moved by hand") {
  LimbEditor test({900, 640});
  Document document = bending_limb();
  document.weights = half_weights(*document.volume);
  std::vector<Pose> poses(4, rest_pose(*document.armature));
  for (int frame = 0; frame < 4; ++frame) poses[frame].root_translation = {8.0 * frame, 0, 3.0 * frame};
  Clip clip = clip_of_poses({.name = "walk", .rate = 30}, *document.armature, poses, 0);
  clip.range_end = 1;
  document.clips = {std::make_shared<const Clip>(clip)};
  document.clip = 0;
  const TemporaryFolder folder;
  for (const bool by_hand : {false, true}) {
    CAPTURE(by_hand);
    document.frame = by_hand ? 0 : 3;
    document.pose = std::make_shared<const Pose>(poses[3]);
    test.editor->history->reset(document, "Open limb");
    test.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle\n wait 1\n wait-idle");
    const auto exported = [&](const char* menu, const std::string& file, const char* answer) {
      test.play(std::string("click \"File/Export/") + menu + "\"\n wait-idle\n key Ctrl+A\n type \"" +
                (folder / file).string() + "\"\n key Return\n wait-idle\n" + answer + "wait-job\n wait-idle");
      return folder / file;
    };
    const std::string name = by_hand ? "hand" : "outside";
    const auto seen = render::read_png(exported("Picture...", name + "-seen.png", ""));
    exported("Motion as pictures...", name + ".png", "click \"Camera/Follow the body\"\n wait-idle\n key Return\n");
    exported("Motion as pictures...", name + "-still.png", "key Return\n");
    const double along = difference(render::read_png(folder / (name + "-0000.png")), seen),
                 still = difference(render::read_png(folder / (name + "-still-0000.png")), seen);
    CAPTURE(still);
    CAPTURE(along);
    CHECK(still > 5 * along);
  }
}
