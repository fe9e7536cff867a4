// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/shown_pose.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "editor/shown/test_pose.h"

namespace limber::editor {

Pose pose_of(const Document& document) { return document.pose ? *document.pose : rest_pose(*document.armature); }

Pose shown_pose(const Editor& editor) {
  if (editor.views->preview_pose) return *editor.views->preview_pose;
  return editor.workspace == Workspace::Skin ? test_pose(editor) : pose_of(editor.document());
}

void show_pose(Editor& editor, Pose pose) {
  editor.views->preview_pose = std::make_shared<const Pose>(std::move(pose));
  editor.touch();
}

void drop_shown_pose(Editor& editor) {
  editor.views->preview_pose.reset();
  editor.touch();
}

std::vector<int> chosen_bones(const Editor& editor) {
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  if (!armature) return {};
  std::vector<int> bones(editor.selection.bones.begin(), editor.selection.bones.end());
  std::erase_if(bones, [&](int bone) { return bone >= std::ssize(armature->bones); });
  if (bones.empty()) {
    bones.resize(armature->bones.size());
    std::iota(bones.begin(), bones.end(), 0);
  }
  return bones;
}

std::vector<int> topmost(const Armature& armature, const std::vector<int>& bones) {
  std::vector<bool> chosen(armature.bones.size(), false), below(armature.bones.size(), false);
  for (int bone : bones) chosen[bone] = true;
  std::vector<int> top;
  for (int bone = 0; bone < std::ssize(armature.bones); ++bone) {
    const int parent = armature.bones[bone].parent;
    below[bone] = parent >= 0 && (below[parent] || chosen[parent]);
    if (chosen[bone] && !below[bone]) top.push_back(bone);
  }
  return top;
}

}  // namespace limber::editor
