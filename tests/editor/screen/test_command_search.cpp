// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/screen/command_search.h"

#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("search: a command is found by letters of its name and run with Return") {
  SmallEditor test;
  test.play(R"(
    key F3
    expect dialog yes
    type "four"
    key Return
    expect dialog no
    expect layout four
    key Ctrl+Shift+P
    type "one v"
    key Return
    expect layout one
    click top/Search
    expect dialog yes
    key Escape
    expect dialog no
  )");
}

TEST_CASE("search: arrows choose, what cannot run now stands behind what can and says why when it is chosen") {
  SmallEditor test({1024, 640}, {}, false);
  auto found = find_commands(*test.editor, "fram");
  // Commands without matched letters were found by their descriptions.
  std::erase_if(found, [](const FoundCommand& c) { return c.letters.empty(); });
  REQUIRE(found.size() >= 2);
  const auto cannot = std::find_if(found.begin(), found.end(), [](const FoundCommand& c) { return !c.reason.empty(); });
  CHECK(std::all_of(cannot, found.end(), [](const FoundCommand& c) { return !c.reason.empty(); }));
  test.play(R"(
    key F3
    type "resize v"
    expect "text:Open a volume first" shown
    key Down
    key Up
    key Return
    expect dialog no
    expect toast "Resize voxels..."
  )");
}

TEST_CASE("search: a command that is named stands before those that only speak of it, even if it cannot run now") {
  SmallEditor test;
  const auto found = find_commands(*test.editor, "label brush");
  REQUIRE(found.size() >= 2);
  CHECK(found.front().op->id == "labels.brush");
  CHECK(std::any_of(found.begin(), found.end(),
                    [](const FoundCommand& c) { return c.op->id == "labels.new_tissue" && c.reason.empty(); }));
  // The message has a button that leads to the workspace in which the command can run.
  test.play(R"(
    key F3
    type "add constraint"
    key Return
    expect "text:Switch to the Pose workspace first"
    click "toast 0/Pose"
    expect workspace pose
  )");
}

TEST_CASE("search: without a query it begins with the last five, then the most used") {
  SmallEditor test;
  for (const char* id :
       {"view.xray", "view.xray", "view.xray", "view.one", "view.split", "view.four", "view.grid", "view.axes"})
    run(*test.editor, id);
  const auto found = find_commands(*test.editor, "");
  REQUIRE(found.size() > 6);
  const char* expected[] = {"view.axes", "view.grid", "view.four", "view.split", "view.one", "view.xray"};
  for (int i = 0; i < 6; ++i) CHECK(found[i].op->id == expected[i]);
  CHECK(static_cast<int>(found.size()) == count_commands(*test.editor));
}

TEST_CASE("search: every command can be found by its own name, first of all") {
  SmallEditor test;
  for (const FoundCommand& command : find_commands(*test.editor, "")) {
    const auto found = find_commands(*test.editor, command.op->label);
    REQUIRE_FALSE(found.empty());
    if (command.reason.empty()) CHECK(found.front().op->label == command.op->label);
  }
}

TEST_CASE("search: what is for the pointer alone is left out, Repeat does the last command again") {
  SmallEditor test;
  for (const FoundCommand& command : find_commands(*test.editor, "")) CHECK(command.op->id != "view.orbit");
  test.play(R"(
    key Alt+Z
    expect display xray
    key Shift+R
    expect display solid
  )");
}

TEST_CASE("search: pages of the guide are found, stand behind the commands that are named, and open by Return") {
  SmallEditor test;
  test.play(R"(
    key F3
    type "limbs that touch"
    expect "text:Guide: Limbs that touch" shown
    key Return
    wait-idle
    expect dialog yes
    expect "text:Guide: Limbs that touch" absent
    expect "text:would be dragged along when one of them moves." shown
    key Escape
    key F3
    type "mirror clip"
    expect "text:Mirror clip" shown
    key Return
    expect dialog no
    expect toast "Mirror clip"
    key F3
    type "xylophone"
    expect "text:Nothing matches 'xylophone'" shown
    key Escape
  )");
}
