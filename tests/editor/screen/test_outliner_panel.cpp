// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/comparison.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/ui/ui.h"
#include "tests/editor/keyboard.h"
#include "tests/editor/sitting.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// Makes the ball with three bones in a row and two results.
Document body_with_bones() {
  Document document = small_body();
  auto armature = std::make_shared<Armature>();
  for (int b = 0; b < 3; ++b) {
    Bone bone;
    bone.name = "Bone " + std::to_string(b);
    bone.parent = b - 1;
    bone.head = {0, 0, 10.0 * b};
    bone.tail = {0, 0, 10.0 * b + 10};
    armature->bones.push_back(bone);
  }
  document.armature = armature;
  for (const char* name : {"First", "Second"}) {
    auto result = std::make_shared<Result>();
    result->name = name;
    result->method = "dqs";
    result->volume = document.volume;
    result->from_volume = document.volume;
    document.results.push_back(result);
  }
  return document;
}

struct Tree : SmallEditor {
  Tree() : SmallEditor({1600, 900}) {
    editor->history->reset(body_with_bones(), "Open");
    player.settle();
  }
};

}  // namespace

TEST_CASE("outliner: rows fold, eyes hide and show, Ctrl with a click leaves one tissue") {
  Tree test;
  test.play(R"(
    expect "widget:Outliner/bone Bone 2/name"
    click "bone Bone 0/fold"
    expect "widget:Outliner/bone Bone 2/name" absent
    click Outliner/tissues/fold
    click "Outliner/tissue 17/eye"
    expect hidden 1
    click "Outliner/tissue 111/eye" Ctrl
    expect hidden 3
    click "Outliner/tissue 111/eye" Ctrl
    expect hidden 0
    click Outliner/volume/eye
    expect hidden 4
    click Outliner/tissues/eye
    expect hidden 0
    click Outliner/armature/eye
    click "Outliner/result First/eye"
  )");
  CHECK_FALSE(test.editor->views->bones);
  CHECK(test.editor->comparison->b == "First");
}

TEST_CASE(
    "outliner: a tissue and a result are renamed by double click, by F2 and from their menus, Escape keeps the name") {
  Tree test;
  test.play(R"#(
    click Outliner/tissues/fold
    double-click "Outliner/tissue 17/name"
    type "Flesh"
    key Return
    expect edit "Rename Muscle"
    expect text:Flesh
    click "Outliner/tissue 65/name"
    key F2
    type "Nothing"
    key Escape
    expect edit "Rename Muscle"
    click "Outliner/result First/name"
    key F2
    type "Second"
    key Return
    expect edit "Rename First"
    expect "text:Second (2)"
    key Ctrl+Z
    expect text:First
    right-click "Outliner/tissue 111/name"
    click Tissue/Rename
    type "Bone"
    key Return
    expect edit "Rename Cortical bone"
    double-click "sections/Tissues/Blood/65/name"
    type "Vessel"
    key Return
    expect edit "Rename Blood"
  )#");
}

TEST_CASE(
    "outliner: arrows, Home, End, Space, Left and Right do what the mouse does, the keys return to the view with the "
    "pointer") {
  Tree test;
  test.play(R"(
    click Outliner/armature/name
    key Down
    key Down
    key Left
    expect "widget:Outliner/bone Bone 2/name" absent
    key Right
    expect "widget:Outliner/bone Bone 2/name"
    key Left
    key Left
    key Left
    expect "widget:Outliner/bone Bone 1/name" absent
    key Home
    key Down
    key Right
    key Down
    expect tissue 17
    key Space
    expect hidden 1
    key Space
    expect hidden 0
    key Escape
    key Space
    expect hidden 0
  )");
  CHECK(test.editor->ui->list_focus.list.empty());
  test.play("click Outliner/volume/name");
  CHECK_FALSE(test.editor->ui->list_focus.list.empty());
  test.play("move \"3D view/view\"");
  CHECK(test.editor->ui->list_focus.list.empty());
}

TEST_CASE("outliner: the search keeps parents, and finds nothing with a way back") {
  Tree test;
  test.play(R"(
    key Ctrl+F
    type "bone 2"
    expect "widget:Outliner/bone Bone 0/name"
    expect "widget:Outliner/bone Bone 2/name"
    expect "widget:Outliner/volume/name" absent
    key Return
    key End
    expect "widget:Outliner/result First/name" absent
    key Ctrl+F
    type "zebra"
    expect "text:Nothing in the project is named 'zebra'"
    click "Outliner/Clear search"
    expect "widget:Outliner/volume/name"
  )");
  CHECK(test.editor->selection->bone == 2);
}

namespace {

// Makes a body with 60 bones, more than the list can show. The last bone has this name.
Document body_with_many_bones(const std::string& last) {
  Document document = small_body();
  auto armature = std::make_shared<Armature>();
  for (int b = 0; b < 60; ++b) {
    Bone bone;
    bone.name = b == 59 ? last : "Bone " + std::to_string(b);
    bone.parent = b - 1;
    bone.head = {0, 0, 1.0 * b};
    bone.tail = {0, 0, 1.0 * b + 1};
    armature->bones.push_back(bone);
  }
  document.armature = armature;
  return document;
}

}  // namespace

TEST_CASE("outliner: what is found below the fold of the list is scrolled to, and Return goes to it") {
  SmallEditor test({1280, 720});
  test.editor->history->reset(body_with_many_bones("Fingertip"), "Open");
  test.play("key Ctrl+1\n wait-idle\n move \"3D view/view\"\n key Ctrl+F\n type \"finger\"\n wait-idle");
  const Widget* found = test.editor->ui->widgets.find("Outliner/bone Fingertip/name");
  REQUIRE(found);
  CHECK(found->rect.height() > 10 * test.editor->ui->look.scale);
  CHECK(found->rect.high.y <= test.editor->screen->layout.sidebar.high.y);
  test.play("key Return\n wait-idle");
  REQUIRE(test.editor->selection->bone);
  CHECK(*test.editor->selection->bone == 59);
}

TEST_CASE("outliner: a bone found by its name stays in sight when the sections above show it") {
  for (const std::string workspace : {"key Ctrl+3", "key Ctrl+1"}) {
    CAPTURE(workspace);
    SmallEditor test({1280, 640});
    test.editor->history->reset(body_with_bones(), "Open");
    test.play(workspace + "\nwait-idle\nmove \"3D view/view\"\nkey Ctrl+F\n" + "type \"Bone 2\"\nwait-idle");
    const Widget* found = test.editor->ui->widgets.find("Outliner/bone Bone 2/name");
    REQUIRE(found);
    const glm::vec2 before = found->rect.low;
    press_key(*test.host, Key::Return);
    for (int frame = 0; frame < 5; ++frame) {
      test.player.step();
      const Widget* row = test.editor->ui->widgets.find("Outliner/bone Bone 2/name");
      REQUIRE(row);
      CHECK(row->rect.low == before);
    }
    CHECK(test.editor->selection->bone == 2);
    test.player.settle();
    REQUIRE(test.editor->ui->widgets.find("Outliner/bone Bone 2/name"));
    CHECK(test.editor->ui->widgets.find("Outliner/bone Bone 2/name")->rect.low == before);
  }
}

TEST_CASE("outliner: a thousand tissues cost no more than what is seen of them") {
  SmallEditor test({1280, 720});
  Document document = small_body();
  auto tissues = std::make_shared<TissueTable>(*document.tissues);
  for (int label = 1000; label < 3000; ++label) {
    Tissue tissue;
    tissue.label = static_cast<Label>(label);
    tissue.name = "Part " + std::to_string(label);
    tissues->tissues.push_back(tissue);
  }
  document.tissues = tissues;
  test.editor->history->reset(document, "Open");
  test.play("click Outliner/tissues/fold");
  CHECK(test.editor->ui->widgets.widgets().size() < 400);
  test.play("click Outliner/tissues/name\n key End\n wait 0.1");
  CHECK(test.editor->ui->widgets.find("Outliner/tissue 2999/name"));
  CHECK(test.editor->selection->tissue == Label{2999});
}

TEST_CASE("outliner: the search goes to a bone rather than to a heading, and scrolls where the list has no fold") {
  SmallEditor test({1280, 720});
  test.editor->history->reset(body_with_many_bones("LeftArm"), "Open");
  test.play("key Ctrl+3\n wait-idle\n move \"3D view/view\"\n key Ctrl+F\n type \"arm\"\n wait-idle");
  const Widget* found = test.editor->ui->widgets.find("Outliner/bone LeftArm/name");
  REQUIRE(found);
  CHECK(found->rect.low.y >= test.editor->screen->layout.sidebar.low.y);
  CHECK(found->rect.high.y <= test.editor->screen->layout.sidebar.high.y);
  CHECK(found->rect.height() > 10 * test.editor->ui->look.scale);
  test.play("key Return\n wait-idle");
  REQUIRE(test.editor->selection->bone);
  CHECK(*test.editor->selection->bone == 59);
}
