// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/transform_settings.h"

#include "editor/context/view_projection.h"

namespace limber::editor {

const char* name_of(Space space) {
  constexpr const char* kNames[] = {"Global", "Local", "Parent", "View"};
  return kNames[static_cast<int>(space)];
}

glm::dmat3 posed_axes(const Armature& armature, const Pose& pose, int bone) {
  return glm::mat3_cast(posed_from_rest(armature, pose)[bone].rotation) * rest_axes(armature.bones[bone]);
}

glm::dmat3 axes_of(Space space, const Armature& armature, const Pose& pose, int bone, const ViewProjection& view) {
  const int parent = armature.bones[bone].parent;
  switch (space) {
    case Space::Global: break;
    case Space::Local: return posed_axes(armature, pose, bone);
    case Space::Parent: return parent < 0 ? glm::dmat3(1) : posed_axes(armature, pose, parent);
    case Space::View: return {view.right, view.up, view.towards_eye};
  }
  return glm::dmat3(1);
}

}  // namespace limber::editor
