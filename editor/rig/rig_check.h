// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the bones of the rig that lie partly outside the tissue, lists them, marks them over the views and centres the
// views on them. The check runs again when the rig or the volume changes, also while the user drags a bone.
#pragma once

#include <memory>
#include <vector>

#include "core/autorig/rig_check.h"
#include "core/volume/label_volume.h"

namespace limber::editor {

struct Context;
struct ViewProjection;

// A bone that lies partly or wholly outside the tissue.
struct LeavingBone {
  int bone = 0;
  double share = 1;                 // fraction of the bone's length that lies in tissue, [0, 1]
  bool head = false, tail = false;  // true if the bone's head, or its tail, is outside the tissue
  // Position that the views centre on, world, mm: an end outside the tissue or, if both ends are inside, the middle of
  // the longest stretch outside.
  glm::dvec3 place{0};
};

struct KnownRigCheck {
  std::shared_ptr<const Armature> rig;
  std::shared_ptr<const LabelVolume> volume;
  RigCheck check;
  std::vector<LeavingBone> bones;  // bones that leave the tissue, in the rig's order
};

// Returns the result of the rig check for the rig that the views show; null without a rig or a volume, and outside the
// Rig workspace.
const KnownRigCheck* rig_check(const Context& context);

// Selects the bone, or its end that lies outside the tissue, and centres every view on `leaving.place`.
void show_leaving(Context& context, const LeavingBone& leaving);
// Selects and shows the next bone outside the tissue: the first one after the active bone in the rig's order. After the
// rig's last bone the search starts again at the first.
void show_next_leaving(Context& context);

// Draws marks over a view on the stretches and ends of bones that lie outside the tissue.
void draw_rig_check(Context& context, const ViewProjection& view);

}  // namespace limber::editor
