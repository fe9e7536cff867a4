// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/rig_check.h"

#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/preferences.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/ui.h"
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

const KnownRigCheck* rig_check(const Context& context) {
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  const std::shared_ptr<const LabelVolume> volume = context.document().volume;
  if (context.workspace() != Workspace::Rig || !rig || !volume) return nullptr;
  if (!context.transform_settings->rig_check) context.transform_settings->rig_check = std::make_shared<KnownRigCheck>();
  KnownRigCheck& known = *context.transform_settings->rig_check;
  if (known.rig == rig && known.volume == volume) return &known;
  known = {rig, volume, check_rig(*volume, *rig), {}};
  known.bones = leaving_bones(known.check);
  return &known;
}

void show_leaving(Context& context, const LeavingBone& leaving) {
  *context.selection = {};
  context.selection->bone = leaving.bone;
  context.selection->bones = {leaving.bone};
  context.transform_settings->part = leaving.tail   ? TransformSettings::Part::Tail
                                     : leaving.head ? TransformSettings::Part::Head
                                                    : TransformSettings::Part::Whole;
  Views& views = *context.views;
  render::Camera camera = views.body.move ? views.body.move->to : views.body.camera;
  camera.centre = leaving.place;
  if (context.preferences->reduce_motion) views.body.camera = camera;
  else views.body.move = CameraMove{views.body.camera, camera, context.ui->now};
  const Box box = world_box(context.document());
  views.cross_hair = glm::clamp(leaving.place, box.low, box.high);
  for (SliceState& slice : views.slices) slice.camera.centre = leaving.place;
  context.ui->touch();
}

void show_next_leaving(Context& context) {
  const KnownRigCheck* known = rig_check(context);
  if (!known || known->bones.empty()) return;
  const int active = context.selection->bone.value_or(-1);
  const auto next =
      std::find_if(known->bones.begin(), known->bones.end(), [&](const LeavingBone& one) { return one.bone > active; });
  show_leaving(context, next == known->bones.end() ? known->bones.front() : *next);
}

void draw_rig_check(Context& context, const ViewProjection& view) {
  const KnownRigCheck* known =
      context.views->bones && context.transform_settings->rig_check_marks ? rig_check(context) : nullptr;
  if (!known) return;
  const GizmoPainter painter(context, view);
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
