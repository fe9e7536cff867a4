// SPDX-License-Identifier: AGPL-3.0-or-later
// Where the rig leaves the tissue: a list of its bones, marks over the views, and the way there. Follows the rig while
// it is dragged; checked again only when the rig or the volume is another.
#pragma once

#include <memory>
#include <vector>

#include "core/autorig/rig_check.h"
#include "core/volume/label_volume.h"

namespace limber::editor {

struct Editor;
struct ViewProjection;

// A bone that is not wholly in tissue.
struct LeavingBone {
  int bone = 0;
  double share = 1;                 // of its length in tissue
  bool head = false, tail = false;  // which of its joints are outside
  glm::dvec3 place{0};              // a joint outside, else the middle of the longest stretch in air
};

struct KnownRigCheck {
  std::shared_ptr<const Armature> rig;
  std::shared_ptr<const LabelVolume> volume;
  RigCheck check;
  std::vector<LeavingBone> bones;  // in the rig's order
};

// Of the rig that is shown; null without a rig or a volume, and outside the Rig workspace.
const KnownRigCheck* rig_check(const Editor& editor);

// Chooses the bone, its joint where that is outside, and brings the place to the middle of every view.
void show_leaving(Editor& editor, const LeavingBone& leaving);
// After the active bone, then from the first again.
void show_next_leaving(Editor& editor);

// Stretches and joints in air, over a view.
void draw_rig_check(Editor& editor, const ViewProjection& view);

}  // namespace limber::editor
