// SPDX-License-Identifier: AGPL-3.0-or-later
// Clips and what they do to the rig: coming in, being chosen, matched and cut.
#pragma once

#include <string>
#include <vector>

#include "core/motion/retarget_confidence.h"
#include "editor/motion/timeline.h"

namespace limber::editor {

// How much of the rig a clip moves.
struct Matching {
  int bones = 0, joints = 0;  // moved ones, and the joints that move them
  int sure = 0;               // bones whose names leave no doubt
};
Matching matching_of(const ClipOnRig& clip);
int moved_bones(const ClipOnRig& clip);
// The map that is in use: the clip's own, or the one by names; empty where nothing matches.
RetargetMap map_in_use(const ClipOnRig& clip);

// The motion as a clip at its own rate. One that was written for the document's rig travels as it was written.
Clip clip_for(const Document& document, std::shared_ptr<const Motion> motion, const std::string& name, int start = 0);

void choose_clip(Editor& editor, int clip);
// Asks how the motion of that file shall come in: its scale, axes, first frame and rate.
void import_motion(Editor& editor, const Path& path);
// The list of bones and the joints that move them.
void open_map(Editor& editor);

}  // namespace limber::editor
