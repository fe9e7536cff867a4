// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/context/selection.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("select: a chain holds the descendants of every selected bone, also of those before the active one") {
  SmallEditor test;
  Armature armature;
  for (const auto& [name, parent, x] :
       {std::tuple{"Root", -1, 0.0}, {"Arm", 0, 10.0}, {"Leg", 0, -10.0}, {"Hand", 1, 20.0}, {"Foot", 2, -20.0}}) {
    Bone bone;
    bone.name = name;
    bone.parent = parent;
    bone.head = {x, 0, 0};
    bone.tail = {x, 0, 10};
    armature.bones.push_back(bone);
  }
  Document next = test.editor->document();
  next.armature = std::make_shared<const Armature>(armature);
  commit(*test.editor, "Add a rig", std::move(next));
  test.player.settle();
  test.editor->selection->bones = {1, 4};
  test.editor->selection->bone = 4;
  run(*test.editor, "select.chain");
  CHECK(test.editor->selection->bones == std::set<int>{1, 3, 4});
}
