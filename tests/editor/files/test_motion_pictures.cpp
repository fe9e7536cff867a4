// SPDX-License-Identifier: AGPL-3.0-or-later
// The motion that plays as pictures: each shows the body as the 3D view does at rest in that frame.
#include <doctest/doctest.h>

#include "editor/motion/timeline.h"
#include "editor/shown/frame_all.h"
#include "render/image_io.h"
#include "tests/editor/small_clip.h"
#include "tests/editor/weighed_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// The mean difference of two pictures' colours, of 255.
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
  test.editor->history.reset(std::move(document), "Open limb");
  const TemporaryFolder folder;
  test.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
  edit_clip(*test.editor, "Range", PoseThen::FromClip, [](Clip& clip) {
    clip.range_start = 38;
    clip.range_end = 41;
  });
  const Document before = test.editor->document();
  const auto exported = [&](const char* menu, const std::string& file) {
    test.play(std::string("click \"File/Export/") + menu + "\"\n wait-idle\n key Ctrl+A\n type \"" +
              (folder / file).string() + "\"\n key Return\n wait-job\n wait-idle");
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

TEST_CASE("motion pictures: without weights or a clip it is said what is missing") {
  LimbEditor test({900, 640});
  const Operator* op = find_operator(*test.editor, "file.export_motion_pictures");
  REQUIRE(op);
  CHECK(op->disabled_reason(*test.editor) == "Import a motion first, or insert a key");
  Document document = bending_limb();
  document.weights = nullptr;
  test.editor->history.reset(std::move(document), "Open limb");
  CHECK(op->disabled_reason(*test.editor) == "Compute the weights first");
}
