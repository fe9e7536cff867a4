// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the pose by clinical angles (core/pose/clinical_angles.h), with X-mirror and limits applied.
#pragma once

#include <memory>

#include "core/pose/clinical_angles.h"

namespace limber::editor {

struct Context;

// Cache of the coordinate frames in which the joint angles of a rig are measured. It is valid until the rig changes.
struct KnownBodyFrames {
  std::shared_ptr<const Armature> armature;
  BodyFrames frames;
};
// Returns the coordinate frames in which the joint angles of the document's rig are measured. Needs a document with a
// rig.
const BodyFrames& body_frames_of_rig(const Context& context);

// Returns the document's pose with one angle of a joint changed. With "Keep to joint limits" on, the angle is clamped
// to its range of motion (range_of_motion()), and bones are clamped to the rig's limits.
//   motion   index of the angle in JointMotions
//   degrees  new angle, measured from the anatomical position
Pose pose_at_angle(const Context& context, const SidedJoint& joint, std::size_t motion, double degrees);

enum class HandMotion { Curl, Spread };
// Returns the allowed range of a hand's curl or spread, degrees.
AngleRange range_of_hand(HandMotion motion);
// Returns the document's pose with the fingers of a hand curled or spread by an angle.
Pose pose_of_hand(const Context& context, BodySide side, HandMotion motion, double degrees);

}  // namespace limber::editor
