// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/volume/volume_edits.h"

#include <fstream>
#include <sstream>

#include "core/prepare/prepare.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("prepare: each command is a job and one edit, undone bit for bit") {
  LimbEditor test;
  const std::string before = test.fact("document");
  test.play(R"--(
    key F3
    type "resize voxels"
    key Return
    double-click "Spacing/value"
    type "6"
    key Return
    key Return
    wait-job
    expect edit "Resize voxels to 6 mm"
    click "Edit/Prepare volume/Pad..."
    key Return
    wait-job
    expect edit "Pad by 8 voxels"
    click "Edit/Prepare volume/Crop to tissue"
    wait-job
    expect edit "Crop to tissue"
    click "Edit/Prepare volume/Remove specks..."
    click dialog/Remove
    wait-job
    click "Edit/Prepare volume/Orient..."
    click "Columns (x)/list"
    click "Columns (x)/Right"
    key Return
    wait-job
    expect edit "Orient to RPS"
  )--");
  CHECK(test.fact("document") != before);
  while (test.editor->history->can_undo()) run(*test.editor, "edit.undo");
  CHECK(test.fact("document") == before);
}

TEST_CASE("prepare: results are those of the volume's own functions") {
  LimbEditor test;
  const LabelVolume body = *test.editor->document().volume;
  const auto after = [&](const char* id) {
    run(*test.editor, id);
    test.play("wait-job");
    const LabelVolume volume = *test.editor->document().volume;
    run(*test.editor, "edit.undo");
    return volume;
  };
  CHECK(after("prepare.flip_x").voxels == flip(body, 0).voxels);
  CHECK(after("prepare.flip_z").voxels == flip(body, 2).voxels);
  CHECK(after("prepare.crop").voxels == crop_to_tissue(body).voxels);
}

TEST_CASE("prepare: weights and rig stay only while they fit, and it is said") {
  LimbEditor test;
  run(*test.editor, "skin.rigid");
  test.play("wait-job");
  REQUIRE(test.editor->document().weights);
  const auto weights = test.editor->document().weights;

  // Merging tissues changes no voxel from tissue to air or back, so the weights are kept.
  test.play(R"--(
    click "Edit/Prepare volume/Merge tissues..."
    click "Tissue/list"
    click "Tissue/Blood (65)"
    click "Merge into/list"
    click "Merge into/Muscle (17)"
    key Return
    wait-job
  )--");
  CHECK(test.editor->document().weights == weights);
  CHECK_FALSE(test.editor->document().tissues->find(65));
  CHECK(test.editor->messages->toasts.back().severity == Severity::Ok);

  run(*test.editor, "prepare.crop");
  test.play("wait-job");
  CHECK_FALSE(test.editor->document().weights);
  CHECK(test.editor->document().armature);
  CHECK(test.editor->messages->toasts.back().detail.find("weights") != std::string::npos);
  CHECK(test.editor->messages->toasts.back().severity == Severity::Warning);

  while (test.editor->history->can_undo()) run(*test.editor, "edit.undo");
  run(*test.editor, "prepare.flip_y");
  test.play("wait-job");
  CHECK_FALSE(test.editor->document().armature);
}

TEST_CASE("prepare: crop to the clip box keeps what is seen, a form says what is wrong and waits") {
  LimbEditor test;
  CHECK_FALSE(
      disabled_reason(*test.editor, *find_operator(test.editor->operators, "prepare.crop_to_clip_box")).empty());
  run(*test.editor, "view.clip_box");
  const ClipBox box = test.editor->document().visibility->clip_box;
  const LabelVolume expected =
      crop(*test.editor->document().volume, glm::ivec3(glm::ceil(box.low)), glm::ivec3(glm::floor(box.high)));
  run(*test.editor, "prepare.crop_to_clip_box");
  test.play("wait-job");
  CHECK(test.editor->document().volume->grid == expected.grid);
  CHECK(test.editor->document().volume->voxels == expected.voxels);

  test.play(R"--(
    click "Edit/Prepare volume/Orient..."
    click "Rows (y)/list"
    click "Rows (y)/Right"
    expect "text:two voxel axes point along the same body axis" shown
    key Return
    expect dialog yes
    key Escape
    expect dialog no
  )--");
}

TEST_CASE("prepare: statistics count each tissue, are copied and exported") {
  const TemporaryFolder folder;
  LimbEditor test;
  test.play(R"--(
    click "Edit/Prepare volume/Statistics"
    wait-job
    expect "text:Cortical bone" shown
    click dialog/Copy
    click "Export CSV"
    key Escape
    expect "text:Cortical bone" shown
    click "Export CSV"
  )--");
  test.play("type \"" + (folder / "s").string() +
            "\"\nkey Return\nexpect error none\nexpect \"text:Cortical bone\" shown\nclick \"Export CSV\"");
  test.play("type \"" + (folder / "s.csv").string() +
            "\"\nkey Return\nexpect \"text:s.csv already exists\"\nclick \"Keep file\"\nkey Escape");
  const std::string expected =
      to_csv(label_statistics(*test.editor->document().volume), *test.editor->document().tissues);
  CHECK(test.host->clipboard() == expected);
  std::ifstream in(folder / "s.csv");
  std::stringstream text;
  text << in.rdbuf();
  CHECK(text.str() == expected);
}

TEST_CASE("prepare: a volume that was changed meanwhile is not overwritten") {
  LimbEditor test;
  start_preparation(*test.editor, {"Slow", [](const LabelVolume& v, Progress&) { return pad(v, 2); }});
  Document other = test.editor->document();
  other.volume = std::make_shared<const LabelVolume>(pad(*other.volume, 1));
  test.editor->history->commit("Other", other);
  test.play("wait-job");
  CHECK(test.editor->document().volume == other.volume);
  CHECK(test.fact("toast") == "The volume was changed meanwhile");
}
