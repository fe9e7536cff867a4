// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_registry.h"
#include "editor/dialogs/redo_last_operator.h"

#include "core/base/error.h"
#include "editor/pose/pose_edits.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;

namespace {

struct AdjustingEditor : LimbEditor {
  AdjustingEditor() : LimbEditor({820, 540}) { editor->preferences->reduce_motion = true; }

  void choose(const std::string& bone) {
    *editor->selection = {};
    editor->selection->bone = editor->document().armature->find(bone).value();
    editor->selection->bones = {*editor->selection->bone};
    editor->transform_settings->part = TransformSettings::Part::Whole;
  }
  // Changes a field of the last operation to a number, or to the choice with this index.
  void change(const std::string& label, double value) {
    REQUIRE(why_not_redo(*editor) == "");
    std::vector<FormField> fields = editor->last_operation->fields;
    for (FormField& field : fields)
      if (field.label == label)
        (field.kind == FormField::Kind::Choice ? field.chosen = static_cast<int>(value) : field.value = value);
    redo_last_operator(*editor, fields);
  }
  std::int64_t position() const { return editor->history->position(); }
  const Armature& rig() const { return *editor->document().armature; }
};

}  // namespace

TEST_CASE("adjust: what was done with a number is as if it had been done with the other one, in one step") {
  struct Deed {
    const char *ready, *keys, *label;
    double value;
    const char* directly;  // keys that apply this value at once
  };
  AdjustingEditor test;
  test.play("key Num1\nmove \"3D view/view\"\nwait-idle");
  for (const Deed& deed :
       {Deed{"key Ctrl+1", "key G\nkey X\nkey 5\nkey Return", "X", -7, "key G\nkey X\nkey -\nkey 7\nkey Return"},
        {"key Ctrl+1", "key E\nkey Z\nkey 5\nkey Return", "Z", 8, "key E\nkey Z\nkey 8\nkey Return"},
        {"key Ctrl+1", "key Shift+D\nkey X\nkey 5\nkey Return", "X", 9, "key Shift+D\nkey X\nkey 9\nkey Return"},
        {"key Ctrl+1", "key R\nkey Y\nkey 1\nkey 0\nkey Return", "Angle", 90, "key R\nkey Y\nkey 9\nkey 0\nkey Return"},
        {"key Ctrl+1", "key R\nkey Y\nkey 1\nkey 0\nkey Return", "Axis", 1, "key R\nkey X\nkey 1\nkey 0\nkey Return"},
        {"key Ctrl+1", "key S\nkey 2\nkey Return", "Factor", 3, "key S\nkey 3\nkey Return"},
        {"key Ctrl+1", "key Ctrl+R\nkey 2\nkey Return", "Angle", 30, "key Ctrl+R\nkey 3\nkey 0\nkey Return"},
        {"key Ctrl+3", "key R\nkey X\nkey 2\nkey Return", "Angle", 50, "key R\nkey X\nkey 5\nkey 0\nkey Return"},
        {"key Ctrl+3", "key G\nkey Y\nkey -\nkey 1\nkey 0\nkey Return", "Y", -20,
         "key G\nkey Y\nkey -\nkey 2\nkey 0\nkey Return"},
        {"key Ctrl+3\nkey R\nkey X\nkey 4\nkey 0\nkey Return", "key Shift+E\nkey 5\nkey 0\nkey Return", "Amount", 25,
         "key Shift+E\nkey 2\nkey 5\nkey Return"},
        {"key Ctrl+3\nkey R\nkey X\nkey 4\nkey 0\nkey Return", "key Ctrl+E\nkey 5\nkey 0\nkey Return", "Amount", 25,
         "key Ctrl+E\nkey 2\nkey 5\nkey Return"},
        {"key Ctrl+3\nkey R\nkey X\nkey 4\nkey 0\nkey Return", "key Alt+E\nkey 5\nkey 0\nkey Return", "Amount", 25,
         "key Alt+E\nkey 2\nkey 5\nkey Return"}}) {
    CAPTURE(deed.keys);
    CAPTURE(deed.label);
    // The result of applying the value at once, or of adjusting the last operation to it.
    struct Outcome {
      std::string edit;
      Armature rig;
      Pose pose;
      std::set<int> chosen;
    };
    const auto outcome = [&](bool adjusted) {
      test.editor->history->reset(limber::test::small_limb(), "Open limb");
      test.choose("Fore");
      test.play(deed.ready);
      const auto before = test.position();
      test.play(adjusted ? deed.keys : deed.directly);
      REQUIRE(test.position() == before + 1);
      if (adjusted) test.change(deed.label, deed.value);
      CHECK(test.position() == before + 1);
      CHECK(std::ssize(test.editor->history->steps()) == before + 2);
      const Outcome found{test.fact("edit"), test.rig(), pose_of(test.editor->document()),
                          test.editor->selection->bones};
      test.play("key Ctrl+Z");
      CHECK(test.position() == before);
      CHECK(why_not_redo(*test.editor) != "");
      return found;
    };
    const Outcome one = outcome(true), two = outcome(false);
    CHECK(one.edit == two.edit);
    CHECK(one.chosen == two.chosen);
    REQUIRE(one.rig.bones.size() == two.rig.bones.size());
    for (std::size_t bone = 0; bone < one.rig.bones.size(); ++bone) {
      CHECK(one.rig.bones[bone].name == two.rig.bones[bone].name);
      CHECK(glm::distance(one.rig.bones[bone].tail, two.rig.bones[bone].tail) < 1e-9);
      CHECK(one.rig.bones[bone].roll == doctest::Approx(two.rig.bones[bone].roll));
      CHECK(std::abs(glm::dot(one.pose.rotation[bone], two.pose.rotation[bone])) > 1 - 1e-6);
    }
  }
}

TEST_CASE("adjust: a bone is cut into more parts, and made one again by undo") {
  AdjustingEditor test;
  test.play("key Ctrl+1\nwait-idle");
  test.choose("Fore");
  test.play("click Edit/Bone/Subdivide");
  CHECK(test.rig().bones.size() == 3);
  for (const int parts : {4, 3}) {
    test.change("Parts", parts);
    REQUIRE(test.rig().bones.size() == 1 + std::size_t(parts));
    for (int part = 1; part <= parts; ++part) {
      CHECK(test.rig().bones[part].tail.z == doctest::Approx(-36.0 * part / parts));
      CHECK(test.rig().bones[part].parent == part - 1);
    }
  }
  CHECK(test.position() == 1);
  test.play("key Ctrl+Z");
  CHECK(test.rig().bones.size() == 2);
}

TEST_CASE("adjust: numbers that come to nothing take the step away, others bring it back") {
  AdjustingEditor test;
  test.play("key Ctrl+3\nkey Num1\nmove \"3D view/view\"\nwait-idle");
  test.choose("Fore");
  test.play("key R\nkey X\nkey 2\nkey 0\nkey Return");
  test.change("Angle", 0);
  CHECK(test.position() == 0);
  test.change("Angle", 30);
  CHECK(test.position() == 1);
  CHECK(glm::degrees(glm::angle(pose_of(test.editor->document()).rotation[1])) == doctest::Approx(30));
  test.play("key Ctrl+Z");
  CHECK(pose_of(test.editor->document()) == rest_pose(test.rig()));
}

TEST_CASE("adjust: what has no numbers says so, and what fails leaves all as it was") {
  AdjustingEditor test;
  CHECK(why_not_redo(*test.editor) == "Nothing has been done yet");
  test.play("key Ctrl+1\nwait-idle");
  test.choose("Fore");
  test.play("key Shift+A");
  CHECK(why_not_redo(*test.editor) == "Add bone has no settings to adjust");

  act_and_allow_redo(*test.editor, {number_of("Bones", "", 1, 0, 9, "%.0f")},
                     [](Context& c, const std::vector<FormField>& fields) {
                       if (fields[0].value > 5) throw Error("too many", "bones", "take fewer");
                       Document next = c.document();
                       next.frame = static_cast<int>(fields[0].value);
                       commit(c, "Step", std::move(next));
                     });
  test.change("Bones", 4);
  CHECK(test.editor->document().frame == 4);
  test.change("Bones", 7);
  CHECK(test.editor->document().frame == 4);
  CHECK(test.editor->last_operation->fields[0].value == 4);
  CHECK(!test.editor->messages->errors.empty());
  test.editor->messages->errors.clear();
  test.change("Bones", 2);
  CHECK(test.editor->document().frame == 2);
  CHECK(test.position() == 2);
}

TEST_CASE("adjust: the box in the view unfolds and its numbers act, and forms hand themselves over") {
  AdjustingEditor test;
  test.play("key Ctrl+1\nkey Num1\nmove \"3D view/view\"\nwait-idle");
  test.choose("Fore");
  CHECK(test.fact("widget:last operation/fold") != "shown");
  test.play("key G\nkey X\nkey 5\nkey Return\nwait-idle\nclick \"last operation/fold\"\nwait-idle");
  test.play("double-click \"last operation/X/value\"\nkey Ctrl+A\ntype 3\nkey Return\nwait-idle");
  CHECK(test.rig().bones[1].tail == glm::dvec3(3, 0, -36));
  CHECK(test.position() == 1);
  test.play("move \"3D view/view\"\nkey F9\nwait-idle\nkey Escape");
  // Opening the form that adjusts the last operation does not replace the last operator.
  CHECK(test.editor->operators->last == "rig.move");
  test.play("key Ctrl+F2\nclick Bones/All\nclick Suffix/text\ntype \".L\"\nwait-idle\nkey Return\nwait-idle");
  REQUIRE(test.rig().bones[1].name == "Fore.L");
  test.play(
      "move \"3D view/view\"\nkey F9\nwait-idle\nclick adjust/Suffix/text\nkey Ctrl+A\ntype \".R\"\nkey "
      "Return\nwait-idle");
  CHECK(test.rig().bones[1].name == "Fore.R");
  CHECK(test.position() == 2);
}
