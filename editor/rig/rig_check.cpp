// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/rig_check.h"

#include <algorithm>

#include "editor/context/transform_settings.h"
#include "editor/rig/rig_edits.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

std::vector<LeavingBone> leaving_bones(const RigCheck& check) {
  std::vector<LeavingBone> bones(check.share.size());
  std::vector<double> longest(check.share.size(), 0);
  for (std::size_t bone = 0; bone < bones.size(); ++bone)
    bones[bone] = {.bone = static_cast<int>(bone), .share = check.share[bone]};
  for (const RigCheck::Leaving& stretch : check.leaving) {
    if (stretch.to - stretch.from <= longest[stretch.bone]) continue;
    longest[stretch.bone] = stretch.to - stretch.from;
    bones[stretch.bone].place = stretch.place;
  }
  for (const RigCheck::Joint& joint : check.outside) {
    (joint.tail ? bones[joint.bone].tail : bones[joint.bone].head) = true;
    bones[joint.bone].place = joint.place;
  }
  std::erase_if(bones, [](const LeavingBone& bone) { return bone.share >= 1 && !bone.head && !bone.tail; });
  return bones;
}

}  // namespace

const KnownRigCheck* rig_check(const Editor& editor) {
  const std::shared_ptr<const Armature> rig = shown_rig(editor);
  const std::shared_ptr<const LabelVolume> volume = editor.document().volume;
  if (editor.workspace != Workspace::Rig || !rig || !volume) return nullptr;
  if (!editor.transform_settings->rig_check) editor.transform_settings->rig_check = std::make_shared<KnownRigCheck>();
  KnownRigCheck& known = *editor.transform_settings->rig_check;
  if (known.rig == rig && known.volume == volume) return &known;
  known = {rig, volume, check_rig(*volume, *rig), {}};
  known.bones = leaving_bones(known.check);
  return &known;
}

void show_leaving(Editor& editor, const LeavingBone& leaving) {
  editor.selection = {};
  editor.selection.bone = leaving.bone;
  editor.selection.bones = {leaving.bone};
  editor.transform_settings->part = leaving.tail   ? TransformSettings::Part::Tail
                                    : leaving.head ? TransformSettings::Part::Head
                                                   : TransformSettings::Part::Whole;
  Views& views = *editor.views;
  render::Camera camera = views.body.move ? views.body.move->to : views.body.camera;
  camera.centre = leaving.place;
  if (editor.preferences.reduce_motion) views.body.camera = camera;
  else views.body.move = CameraMove{views.body.camera, camera, editor.now};
  const Box box = world_box(editor.document());
  views.cross_hair = glm::clamp(leaving.place, box.low, box.high);
  for (SliceState& slice : views.slices) slice.camera.centre = leaving.place;
  editor.touch();
}

void show_next_leaving(Editor& editor) {
  const KnownRigCheck* known = rig_check(editor);
  if (!known || known->bones.empty()) return;
  const int active = editor.selection.bone.value_or(-1);
  const auto next =
      std::find_if(known->bones.begin(), known->bones.end(), [&](const LeavingBone& one) { return one.bone > active; });
  show_leaving(editor, next == known->bones.end() ? known->bones.front() : *next);
}

void draw_rig_check(Editor& editor, const ViewProjection& view) {
  const KnownRigCheck* known =
      editor.views->bones && editor.transform_settings->rig_check_marks ? rig_check(editor) : nullptr;
  if (!known) return;
  const GizmoPainter painter(editor, view);
  const Colour colour = kViewError;
  for (const RigCheck::Leaving& stretch : known->check.leaving) {
    const Bone& bone = known->rig->bones[stretch.bone];
    painter.line(glm::mix(bone.head, bone.tail, stretch.from), glm::mix(bone.head, bone.tail, stretch.to),
                 with_alpha(colour, view.shows(stretch.place) ? 0.9f : 0.3f), 3);
  }
  for (const RigCheck::Joint& joint : known->check.outside)
    if (view.shows(joint.place)) painter.circle(joint.place, colour, 8, 2);
}

}  // namespace limber::editor
