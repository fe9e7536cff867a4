// SPDX-License-Identifier: AGPL-3.0-or-later
// The small body with two bones and a hinge between them.
#pragma once

#include "editor/shown/frame_all.h"
#include "tests/editor/small_editor.h"

namespace limber::test {

inline Document small_limb() {
  Document document = small_body();
  Armature armature;
  Bone upper{"Upper", -1, {0, 0, 36}, {0, 0, 0}}, fore{"Fore", 0, {0, 0, 0}, {0, 0, -36}};
  fore.limits.type = JointLimits::Type::Hinge;
  fore.limits.axis = {1, 0, 0};
  fore.limits.maximum = 2.5;
  armature.bones = {upper, fore};
  document.armature = std::make_shared<const Armature>(armature);
  return document;
}

struct LimbEditor : SmallEditor {
  explicit LimbEditor(const glm::ivec2& size = {1280, 720}, const editor::Preferences& preferences = {})
      : SmallEditor(size, preferences, false) {
    editor->history->reset(small_limb(), "Open limb");
    editor->project->name = "limb";
    editor->background->worker_program = LIMBER_PROGRAM;
    editor::frame_all(*editor, false);
    player.settle();
  }
};

}  // namespace limber::test
