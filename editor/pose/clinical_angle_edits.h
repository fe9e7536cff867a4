// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the pose by clinical angles (core/pose/clinical_angles.h), with X-mirror and limits applied.
#pragma once

#include <memory>

#include "core/pose/clinical_angles.h"
#include "editor/context/editor.h"

namespace limber::editor {

// The frames by which the angles of a rig are measured, kept until the rig changes.
struct KnownBodyFrames {
  std::shared_ptr<const Armature> armature;
  BodyFrames frames;
};
// Returns the frames of the document's rig. Needs a document with a rig.
const BodyFrames& body_frames_of_rig(const Editor& editor);

// Returns the document's pose with one angle of a joint changed. With Keep to joint limits on, the angle stops at the
// ends of its range (range_of_motion()), and bones at the rig's limits.
//   degrees  from the anatomical position
Pose pose_at_angle(const Editor& editor, const SidedJoint& joint, std::size_t motion, double degrees);

enum class HandMotion { Curl, Spread };
// Returns the range of a hand's curl or spread, degrees.
AngleRange range_of_hand(HandMotion motion);
// Returns the document's pose with the fingers of a hand curled or spread by an angle.
Pose pose_of_hand(const Editor& editor, BodySide side, HandMotion motion, double degrees);

}  // namespace limber::editor
