// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/dialogs.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/ui/ui.h"

#include "core/motion/motion_edit.h"
#include "editor/motion/motion_clip_edits.h"
#include "tests/editor/small_clip.h"
#include "tests/editor/small_editor.h"
#include "tests/support/walker.h"

namespace limber::test {

using namespace editor;

TEST_CASE("form: what is typed goes into the first number, and a number out of range is refused below its field") {
  SmallEditor test({1280, 720});
  double taken = 0;
  test.editor->dialogs->open(make_form(
      {"Ask",
       "For numbers.",
       "Take",
       {choice_of("Kind", "Which.", {"One", "Two"}), number_of("First", "A number.", 20, 1, 100, "%.6g", "fps"),
        number_of("Second", "Another.", 5, 0, 9, "%.0f")},
       {},
       [&](Context&, const std::vector<FormField>& fields) { taken = fields[1].value; }}));
  test.play(
      "wait-idle\n type \"-5\"\n wait-idle\n expect \"text:Enter a number from 1 to 100 fps.\"\n key Return\n "
      "wait-idle\n expect "
      "dialog yes");
  CHECK(taken == 0);
  test.play("double-click First/value\n type \"101\"\n key Return\n wait-idle\n expect dialog yes");
  test.play(
      "double-click Second/value\n type \"10\"\n wait-idle\n expect \"text:Enter a number from 0 to 9.\"\n key "
      "Return\n double-click "
      "Second/value\n type \"9\"\n key Return\n expect dialog yes");
  test.play("double-click First/value\n type \"30\"\n key Return\n key Return\n wait-idle\n expect dialog no");
  CHECK(taken == 30);
}

TEST_CASE(
    "importing a motion: its dialog shows the take, its rotation orders and its upright axis, and refuses nonsense") {
  const TemporaryFolder folder;
  Motion motion = t_pose_body({{0, 0, 0}, {20, 5, 1}, {30, 5, 1}, {0, 5, 1}, {20, 5, 1}});
  motion = y_up_from_z_up(y_up_from_z_up(y_up_from_z_up(motion)));
  std::swap(motion.joints[2].channels[0], motion.joints[2].channels[2]);
  write_bvh(motion, folder / "take.bvh");
  SmallEditor test({1280, 720}, {}, false);
  test.editor->history->reset(small_limb(), "Open limb");
  import_motion(*test.editor, folder / "take.bvh");
  test.play("wait-job\n wait-idle\n expect dialog yes\n expect \"text:Frame 0 / 4\"");
  bool told = false;
  for (const std::string& text : test.editor->ui->widgets.texts())
    told |= text.find("; differs in 1 joint: " + motion.joints[2].name) != std::string::npos;
  CHECK(told);
  test.play("drag dialog/preview 119 0\n wait-idle\n expect \"text:Frame 4 / 4\"");
  test.play(
      "move \"Frame rate/value\"\n double-click \"Frame rate/value\"\n type \"-5\"\n wait-idle\n expect "
      "\"text:Enter a number from 1 to 1000 fps.\"\n key Return\n wait-idle\n expect dialog yes");
  CHECK(test.editor->document().clips.empty());
  test.play("double-click \"Frame rate/value\"\n type \"25\"\n key Return\n key Return\n wait-idle\n expect dialog no");
  CHECK(shown_clip(test.editor->document())->rate == 25);
}

}  // namespace limber::test
