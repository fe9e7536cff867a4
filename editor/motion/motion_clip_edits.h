// SPDX-License-Identifier: AGPL-3.0-or-later
// Imports and selects motion clips, and tells how the joints of a clip's motion are matched to the bones of the rig.
#pragma once

#include <string>
#include <vector>

#include "core/motion/retarget_confidence.h"
#include "core/project/document.h"

namespace limber::editor {

struct Context;

// How many bones of the rig a clip moves, and how many of these bones are matched to joints with certainty.
struct Matching {
  int bones = 0, joints = 0;  // number of bones that the clip moves, and of the motion's joints that move them
  int sure = 0;               // number of bones whose match with a joint is certain
};
Matching matching_of(const ClipOnRig& clip);
int moved_bones(const ClipOnRig& clip);
// Returns the retarget map of the clip: for each bone of the rig, the joint of the motion that moves the bone. The map
// is stored in the clip. If the stored map has no entries, joints and bones are matched by their names. Returns an
// empty map when no name matches.
RetargetMap map_in_use(const ClipOnRig& clip);

// Returns a clip that begins at frame `start` and plays the motion at the motion's own frame rate. If the motion's
// skeleton equals the document's rig in position and size, the clip also moves the body along the ground as the motion
// does. Otherwise the body stays at its rest position.
Clip clip_for(const Document& document, std::shared_ptr<const Motion> motion, const std::string& name, int start = 0);

// Adds a clip that a background task has computed from another clip of the document, or replaces that other clip. Then
// goes to `frame`; without `frame`, stays at the current frame. The frame is clamped to the playing range. Throws Error
// if the document no longer has the source clip, or if its rig is not the one for which the clip was computed.
//   ratio  number of frames of the new clip for each frame of the source. When the source is replaced, strips that
//          played the source then play the same part of the motion from the new clip
void take_in_clip(Context& context, const std::shared_ptr<const Clip>& source,
                  const std::shared_ptr<const Armature>& rig, const std::string& label, Clip clip, bool is_new,
                  std::optional<double> frame = {}, double ratio = 1);

void choose_clip(Context& context, int clip);
// Reads a BVH file and opens a dialog that asks for the scale, up axis, first frame and frame rate of the new clip.
void import_motion(Context& context, const Path& path);
// Opens the dialog of the retarget map, which lists each bone of the rig and the joint of the motion that moves it.
void open_map(Context& context);

}  // namespace limber::editor
