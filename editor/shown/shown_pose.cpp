// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/shown_pose.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/shown/test_pose.h"
#include "editor/ui/ui.h"

namespace limber::editor {

Pose pose_of(const Document& document) { return document.pose ? *document.pose : rest_pose(*document.armature); }

Pose shown_pose(const Context& context) {
  if (context.views->preview_pose) return *context.views->preview_pose;
  return context.workspace() == Workspace::Skin ? test_pose(context) : pose_of(context.document());
}

void show_pose(Context& context, Pose pose) {
  context.views->preview_pose = std::make_shared<const Pose>(std::move(pose));
  context.ui->touch();
}

void drop_shown_pose(Context& context) {
  context.views->preview_pose.reset();
  context.ui->touch();
}

std::vector<int> chosen_bones(const Context& context) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  if (!armature) return {};
  std::vector<int> bones(context.selection->bones.begin(), context.selection->bones.end());
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
