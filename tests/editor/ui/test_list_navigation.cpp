// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests lists in which the arrow keys move the selection after a click.
#include "editor/context/operator.h"
#include "editor/resample/results.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("lists: arrows go through the history") {
  LimbEditor test({1240, 750});
  test.editor->ui->open_sections = {
      {"Steps", false}, {"Outliner", false}, {"Tissues", false}, {"Fit check", false}, {"History", true}};
  for (int i = 0; i < 3; ++i) {
    Document next = test.editor->document();
    Armature rig = *next.armature;
    rig.bones[0].name += "x";
    next.armature = std::make_shared<const Armature>(rig);
    test.editor->history->commit("Edit", next);
  }
  test.play("wait-idle\n click \"History/step 3\"\n key Up\n key Up\n wait-idle");
  CHECK(test.editor->history->position() == 1);
  test.play("key Home\n wait-idle");
  CHECK(test.editor->history->position() == 0);
  test.play("key End\n wait-idle");
  CHECK(test.editor->history->position() == 3);
  // Outside the list, the arrow keys are shortcuts again.
  test.play("move \"3D view/view\"\n key Escape\n key Up\n wait-idle");
  CHECK(test.editor->history->position() == 3);
}

TEST_CASE("lists: arrows go through results and the console, Return shows an error again") {
  LimbEditor test;
  Document next = test.editor->document();
  for (const char* name : {"One", "Two"}) {
    Result result;
    result.name = name;
    result.volume = std::make_shared<const LabelVolume>(*next.volume);
    result.from_volume = next.volume;
    result.from_armature = next.armature;
    result.from_tissues = next.tissues;
    next.results.push_back(std::make_shared<const Result>(result));
  }
  test.editor->history->commit("Results", next);
  const auto shown = [&] { return test.editor->views->scene.volume.get(); };
  test.play("key Ctrl+4\n wait-idle\n click \"At rest/row\"\n key Down\n wait-idle");
  CHECK(shown() == test.editor->document().results[1]->volume.get());
  test.play("key Down\n wait-idle");
  CHECK(shown() == test.editor->document().results[0]->volume.get());
  test.play("key Home\n wait-idle");
  CHECK(shown() == test.editor->document().volume.get());

  test.editor->messages->toast_failure("the file ends: a.mha: copy it again", "Open");
  test.editor->messages->info("A note");
  run(*test.editor, "view.console");
  const auto last = std::to_string(test.editor->messages->log.size());
  test.play("wait-idle\n click \"line " + last + "\"\n key Up\n key Return\n wait-idle");
  CHECK(test.editor->messages->errors.size() == 1);
}
