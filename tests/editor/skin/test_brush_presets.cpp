// SPDX-License-Identifier: AGPL-3.0-or-later
// Brush presets are kept between sessions and used from the panel. A damaged file neither loses nor adds presets.
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/context/preferences_state.h"
#include "editor/skin/brush_presets.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/file.h"
#include "editor/seams/seam_view.h"
#include "tests/editor/paint_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

Painting& brush_of(SmallEditor& test) { return *test.editor->skin->painting; }

}  // namespace

TEST_CASE("brush presets: one that is saved is there in the next sitting with every setting") {
  const TemporaryFolder folder;
  const Path preferences = folder / "config/preferences.json";
  BrushPreset wanted;
  {
    PaintEditor test;
    test.editor->preferences_state->path = preferences;
    Painting& brush = brush_of(test);
    brush.kind = BrushKind::Smooth;
    brush.radius = 1.0 / 3;
    brush.radius += 12;
    brush.strength = 0.1;
    brush.value = 0.7;
    brush.falloff = FalloffShape::Sharp;
    brush.falloff_curve = {{0, 1}, {0.3, 0.6}, {1, 0}};
    save_brush_preset(*test.editor, "Caf\u00e9 \"fine\"");
    wanted = brush_presets(*test.editor)[0];
  }
  PaintEditor next;
  next.editor->preferences_state->path = preferences;
  REQUIRE(brush_presets(*next.editor).size() == 1);
  CHECK(brush_presets(*next.editor)[0] == wanted);
  use_brush_preset(*next.editor, wanted.name);
  CHECK(brush_of(next).radius == 12 + 1.0 / 3);
  CHECK(brush_of(next).falloff_curve.size() == 3);
  CHECK(brush_preset_in_use(*next.editor) == 0);
  brush_of(next).strength = 0.2;
  CHECK(brush_preset_in_use(*next.editor) == -1);
  save_brush_preset(*next.editor, wanted.name);  // replaces the preset of this name
  REQUIRE(brush_presets(*next.editor).size() == 1);
  CHECK(brush_presets(*next.editor)[0].strength == 0.2);
  delete_brush_preset(*next.editor, wanted.name);
  CHECK(brush_presets_from_json(read_file(folder / "config/brushes.json"), "").empty());
}

TEST_CASE("brush presets: the panel saves, picks and deletes them") {
  PaintEditor test;
  test.play("key N\nwait-idle");
  REQUIRE(test.fact("widget:Brush/Preset/skin.preset_save") == "shown");
  brush_of(test).radius = 33;
  test.play("click Brush/Preset/skin.preset_save\nwait-idle\ntype \"Medium\"\nkey Return\nwait-idle");
  brush_of(test).radius = 5;
  brush_of(test).kind = BrushKind::Average;
  test.play("click Brush/Preset/skin.preset_save\nwait-idle\ntype \"Tiny\"\nkey Return\nwait-idle");
  REQUIRE(brush_presets(*test.editor).size() == 2);
  use_brush_preset(*test.editor, "Medium");
  test.play("wait-idle");
  CHECK(brush_of(test).radius == 33);
  CHECK(brush_of(test).kind == BrushKind::Add);
  test.play("click Brush/Preset/skin.preset_delete\nwait-idle\nkey Return\nwait-idle");
  REQUIRE(brush_presets(*test.editor).size() == 1);
  CHECK(brush_presets(*test.editor)[0].name == "Tiny");
  CHECK(brush_of(test).radius == 33);
}

TEST_CASE("brush presets: a damaged file is said to be so, and wrong numbers never reach the brush") {
  CHECK_THROWS_WITH_AS(brush_presets_from_json("{\"schema\": 1}", "brushes.json"),
                       doctest::Contains("holds no brush presets"), Error);
  const auto read = brush_presets_from_json(
      R"({"schema": "limber-brushes/1", "presets": [7, {"name": "A"}, {"name": "B", "brush": "no such"},
        {"name": "C", "brush": "add", "radius_mm": 1e9, "strength": -4, "falloff": "odd", "curve": [[0, 1], [0, 0]]},
        {"name": "C", "brush": "set"}]})",
      "brushes.json");
  REQUIRE(read.size() == 1);
  CHECK(read[0].radius == Painting::kMostRadius);
  CHECK(read[0].strength == 0);
  CHECK(read[0].falloff == FalloffShape::Smooth);
  CHECK(read[0].falloff_curve.empty());
  const TemporaryFolder folder;
  write_file_atomically(folder / "brushes.json", "no JSON");
  PaintEditor test;
  test.editor->preferences_state->path = folder / "preferences.json";
  CHECK(brush_presets(*test.editor).empty());
  REQUIRE(!test.editor->messages->toasts.empty());
  CHECK(test.editor->messages->toasts.back().line == "The brush presets could not be read");
}

TEST_CASE("brush presets: what another program has saved, and what this one does not understand, is kept") {
  const TemporaryFolder folder;
  const Path file = folder / "brushes.json";
  PaintEditor one;
  one.editor->preferences_state->path = folder / "preferences.json";
  CHECK(disabled_reason(*one.editor, *find_operator(one.editor->operators, "skin.preset_use")) ==
        "Save a brush preset first");
  CHECK(brush_presets(*one.editor).empty());
  // The presets in another running program, which read the file before the file was changed.
  auto of_other = std::make_shared<BrushPresets>();
  const auto other = [&]() -> Editor& {
    std::swap(brush_of(one).presets, of_other);
    return *one.editor;
  };
  write_file_atomically(file, R"({"schema": "limber-brushes/1", "later": 3, "presets": [
    {"name": "Of tomorrow", "brush": "one that this program lacks", "radius_mm": 7}]})");
  save_brush_preset(*one.editor, "One");
  save_brush_preset(other(), "Other");
  other();
  save_brush_preset(*one.editor, "Third");
  delete_brush_preset(other(), "One");
  CHECK(disabled_reason(*one.editor, *find_operator(one.editor->operators, "skin.preset_use")).empty());
  const std::string text = read_file(file);
  for (const char* kept : {"Of tomorrow", "one that this program lacks", "\"later\": 3", "\"Other\"", "\"Third\""})
    CHECK_MESSAGE(text.find(kept) != std::string::npos, kept);
  CHECK(text.find("\"One\"") == std::string::npos);
  REQUIRE(brush_presets(*one.editor).size() == 2);
  CHECK(brush_presets(*one.editor)[1].name == "Third");
  // A file that is not a list of presets is not overwritten.
  write_file_atomically(file, "no JSON");
  CHECK_THROWS_AS(save_brush_preset(*one.editor, "Fourth"), Error);
  CHECK(read_file(file) == "no JSON");
  CHECK(brush_presets(*one.editor).size() == 2);
}

TEST_CASE("brush presets: the joint capsule brush keeps its blend, and names that cannot be are refused") {
  const TemporaryFolder folder;
  PaintEditor test;
  test.editor->preferences_state->path = folder / "preferences.json";
  brush_of(test).kind = BrushKind::JointCapsule;
  brush_of(test).blend_mm = 71;
  save_brush_preset(*test.editor, "Knee");
  brush_of(test).blend_mm = 12;
  CHECK(brush_preset_in_use(*test.editor) == -1);
  use_brush_preset(*test.editor, "Knee");
  CHECK(brush_of(test).blend_mm == 71);
  CHECK(brush_presets_from_json(read_file(folder / "brushes.json"), "")[0].blend == 71);

  for (const std::string& name : {std::string(), std::string("  "), std::string(101, 'n')})
    CHECK_THROWS_AS(save_brush_preset(*test.editor, name), Error);
  std::vector<BrushPreset> full(kMostBrushPresets);
  for (std::size_t i = 0; i < full.size(); ++i) full[i].name = std::to_string(i);
  CHECK_NOTHROW(require_preset_name(full, "7"));
  CHECK_THROWS_WITH_AS(require_preset_name(full, "new"), doctest::Contains("too many"), Error);
  test.play("key N\nwait-idle\nclick Brush/Preset/skin.preset_save\nwait-idle\nkey Ctrl+A\ntype \"" +
            std::string(101, 'n') + "\"\nwait-idle\nkey Return\nwait-idle");
  CHECK(test.editor->dialogs->shown);
  CHECK(brush_presets(*test.editor).size() == 1);
}

TEST_CASE("brush presets: the one in use is not shown as such while the seam brush paints") {
  PaintEditor test;
  save_brush_preset(*test.editor, "Wide");
  test.play("key N\nwait-idle");
  CHECK(test.fact("text:Wide") == "shown");
  test.editor->seams->brush = true;
  test.editor->ui->touch();
  test.play("wait-idle");
  CHECK(test.fact("text:Custom") == "shown");
  use_brush_preset(*test.editor, "Wide");
  test.play("wait-idle");
  CHECK_FALSE(test.editor->seams->brush);
  CHECK(test.fact("text:Wide") == "shown");
}
