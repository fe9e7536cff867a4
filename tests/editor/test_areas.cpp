// SPDX-License-Identifier: AGPL-3.0-or-later
// What the pointer is over owns the keys.
#include "tests/editor/keyboard.h"
#include "tests/editor/small_clip.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("areas: a view's keys act over the view alone, those of the whole window everywhere") {
  LimbEditor test;
  test.play(R"(
    move "3D view/view"
    key Num1
    expect view Front
    move Outliner/volume/name
    key Num3
    expect view Front
    key Ctrl+2
    expect workspace skin
    key Ctrl+3
    move Motion/fold
    key Num3
    expect view Front
    move "3D view/view"
    key Num3
    expect view Left
  )");
}

TEST_CASE("areas: a click in a number field types there, Ctrl+A chooses its text, a drag changes it") {
  LimbEditor test;
  test.play("key Ctrl+3\nclick \"Outliner/bone Fore/name\"\nwait-idle");
  test.editor->open_sections["Bone"] = true;
  const Pose bent = [&] {
    Pose pose = rest_pose(*test.editor->document().armature);
    pose.rotation[1] = glm::angleAxis(glm::radians(40.0), glm::dvec3(1, 0, 0));
    return pose;
  }();
  Document next = test.editor->document();
  next.pose = std::make_shared<const Pose>(bent);
  test.editor->history.commit("Bend", next);
  const auto armature = test.editor->document().armature;
  test.play("key Ctrl+1\nwait-idle\nclick \"Bone/Length\"");
  test.host->events.push(KeyChanged{Key::Ctrl, true});
  press_key(*test.host, Key::A);
  test.host->events.push(KeyChanged{Key::Ctrl, false});
  type_keys(*test.host, "42");
  press_key(*test.host, Key::Return);
  test.player.settle();
  const Bone& fore = test.editor->document().armature->bones[1];
  CHECK(glm::distance(fore.head, fore.tail) == doctest::Approx(42));
  test.play("drag \"Bone/Length\" 20 0");
  const Bone& longer = test.editor->document().armature->bones[1];
  CHECK(glm::distance(longer.head, longer.tail) > 43);
  CHECK_FALSE(test.editor->keyboard.typed);
}

TEST_CASE("areas: one Escape closes a menu, wherever it was opened") {
  LimbEditor test;
  for (const char* open : {"click top/File", "click top/Edit", "right-click \"Outliner/bone Fore/name\""}) {
    INFO(open);
    test.play(open);
    CHECK(std::any_of(test.editor->widgets.widgets().begin(), test.editor->widgets.widgets().end(), [](const Widget& widget) { return widget.region == Region::Popup; }));
    test.play("key Escape");
    CHECK(std::none_of(test.editor->widgets.widgets().begin(), test.editor->widgets.widgets().end(), [](const Widget& widget) { return widget.region == Region::Popup; }));
  }
}
