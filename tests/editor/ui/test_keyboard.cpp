// SPDX-License-Identifier: AGPL-3.0-or-later
// Keyboard input belongs to a text field from the moment the field is requested until the user leaves it, whatever
// windows or messages appear meanwhile and however slow the frames are.
#include "editor/context/screen.h"
#include "tests/editor/keyboard.h"
#include "tests/editor/sitting.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

std::string name_of_bone(const Context& editor, int bone) { return editor.document().armature->bones[bone].name; }

// An editor in which the user is typing a bone's new name. The first letters are in the field.
struct RenamedBone : LimbEditor {
  RenamedBone() {
    play(R"(
      click "Outliner/bone Fore/name"
      key F2
    )");
    type_keys(*host, "For");
    player.settle();
  }
  void finish() {
    type_keys(*host, "x");
    press_key(*host, Key::Return);
    player.settle();
    CHECK(editor->document().armature->bones.size() == 2);
    CHECK(name_of_bone(*editor, 1) == "Forx");
  }
};

}  // namespace

TEST_CASE("keyboard: a message that appears while a name is typed takes no letter of it") {
  RenamedBone test;
  test.editor->messages->ok("Weights computed");
  test.player.settle();
  test.finish();
}

TEST_CASE("keyboard: a job that ends or fails while a name is typed takes no letter of it") {
  RenamedBone test;
  bool ended = false;
  start_task(*test.editor, "Counting", [&](Progress&) -> Finish {
    return [&](Context& c) {
      ended = true;
      c.messages->ok("Counted");
      c.screen->arrangement().console = true;
    };
  });
  start_task(*test.editor, "Reading",
             [](Progress&) -> Finish { throw Error("the file is empty", "a.nrrd", "choose another"); });
  test.play("wait-job");
  REQUIRE(ended);
  CHECK(test.fact("error") == "none");
  test.finish();
  // The message waited until the name was entered.
  test.play("expect \"text:The file is empty\"\nkey Return\nexpect error none");
  CHECK(name_of_bone(*test.editor, 1) == "Forx");
}

TEST_CASE("keyboard: letters that follow F3 at once reach the search, those after Return the key map") {
  LimbEditor test;
  press_key(*test.host, Key::F3);
  type_keys(*test.host, "four views");
  press_key(*test.host, Key::Return);
  type_keys(*test.host, "n");
  test.player.settle();
  CHECK(test.fact("dialog") == "no");
  CHECK(test.fact("layout") == "four");
  CHECK(test.fact("sidebar") == "no");
  CHECK(test.editor->document().armature->bones.size() == 2);
}

TEST_CASE("keyboard: letters that follow Ctrl+O at once, and those after a folder was entered, reach the file dialog") {
  const Home home;
  // Each of these folders is the second of its folder's list, so Return without another key would open a different one.
  for (const char* folder : {"a first one", "scans/second", "scans/a first one"})
    std::filesystem::create_directories(home / folder);
  std::filesystem::copy_file(home / "scans/ball.nrrd", home / "scans/second/a first one.nrrd");
  std::filesystem::copy_file(home / "scans/ball.nrrd", home / "scans/second/twin.nrrd");
  Sitting sitting(home.folder.path());
  EventQueue& events = sitting.test.host->events;
  events.push(KeyChanged{Key::Ctrl, true});
  press_key(*sitting.test.host, Key::O);
  events.push(KeyChanged{Key::Ctrl, false});
  for (const char* name : {"scans", "second", "twin"}) {
    type_keys(*sitting.test.host, name);
    press_key(*sitting.test.host, Key::Return);
  }
  sitting.test.player.settle();
  sitting.play("wait-job");
  CHECK(sitting.test.fact("dialog") == "no");
  CHECK(sitting.test.fact("volume") == "yes");
  CHECK(sitting.test.fact("name").starts_with("twin"));
}

TEST_CASE(
    "keyboard: all that was typed during a slow frame stands in the field in the next, with the keys among it in "
    "order") {
  RenamedBone test;
  type_keys(*test.host, "earms");
  press_key(*test.host, Key::Backspace);
  type_keys(*test.host, " of the rig");
  press_key(*test.host, Key::Home);
  test.host->events.push(KeyChanged{Key::Shift, true});
  test.host->events.push(KeyChanged{Key::X, true});
  test.host->events.push(TextTyped{U'X'});
  test.host->events.push(KeyChanged{Key::X, false});
  test.host->events.push(KeyChanged{Key::Shift, false});
  press_key(*test.host, Key::Delete);
  press_key(*test.host, Key::Return);
  test.player.step();
  CHECK(test.host->events.empty());
  test.player.settle();
  CHECK(name_of_bone(*test.editor, 1) == "Xorearm of the rig");
  CHECK(test.editor->document().armature->bones.size() == 2);
}

TEST_CASE("keyboard: a command's key right behind a name's Return is a command again") {
  RenamedBone test;
  press_key(*test.host, Key::Return);
  type_keys(*test.host, "x");
  test.player.settle();
  CHECK(test.editor->document().armature->bones.size() == 1);
}
