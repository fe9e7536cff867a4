// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/clinical_angle_edits.h"

#include <algorithm>

#include "core/pose/joint_turns.h"
#include "editor/context/context.h"
#include "editor/context/pose_editing.h"
#include "editor/context/transform_settings.h"
#include "editor/pose/pose_edits.h"

namespace limber::editor {

namespace {

double within(const PoseEditing& posing, double degrees, const AngleRange& range) {
  return posing.keep_limits ? std::clamp(degrees, range.low, range.high) : degrees;
}

// Returns the pose after an edit of clinical angles, with X-mirror and the rig's limits of the moved bones applied.
// Fingers have no rig limits applied: a hinge limit would not let them spread. Their angles are clamped to the
// fingers' own ranges instead.
Pose finished(const Context& context, Pose pose, const JointAngles& moved) {
  const BodyFrames& frames = body_frames_of_rig(context);
  std::vector<int> bones;
  for (const auto& [joint, motions] : moved) {
    if (is_finger(joint.joint)) continue;
    for (const int bone : bones_of_joints(frames, {{joint, motions}})) bones.push_back(bone);
    // Pronation of the forearm also turns the hand, and raising the arm also turns the collarbone, so the limits of
    // these bones apply too.
    std::optional<int> along;
    if (joint.joint == BodyJoint::Forearm) along = pronating_hand(frames, joint.side);
    if (joint.joint == BodyJoint::Shoulder) along = frames.find(BodyPart::Clavicle, joint.side);
    if (along) bones.push_back(*along);
  }
  const Pose before = pose_of(context.document());
  return mirrored_too(context, before, limited(context, std::move(pose), bones));
}

}  // namespace

const BodyFrames& body_frames_of_rig(const Context& context) {
  auto& known = context.transform_settings->body_frames;
  const std::shared_ptr<const Armature>& armature = context.document().armature;
  if (!known || known->armature != armature)
    known = std::make_shared<const KnownBodyFrames>(KnownBodyFrames{armature, body_frames(*armature)});
  return known->frames;
}

Pose pose_at_angle(const Context& context, const SidedJoint& joint, std::size_t motion, double degrees) {
  const Armature& armature = *context.document().armature;
  const BodyFrames& frames = body_frames_of_rig(context);
  const double angle = within(context.posing, degrees, range_of_motion(armature, frames, joint, motion));
  Pose pose = with_clinical_angle(armature, frames, pose_of(context.document()), joint, motion, angle);
  return finished(context, std::move(pose), {{joint, {}}});
}

AngleRange range_of_hand(HandMotion motion) {
  return motion == HandMotion::Curl ? AngleRange{-10, 95} : *usual_range(BodyJoint::Index, kSpread);
}

Pose pose_of_hand(const Context& context, BodySide side, HandMotion motion, double degrees) {
  const Armature& armature = *context.document().armature;
  const BodyFrames& frames = body_frames_of_rig(context);
  JointAngles angles;
  const std::string hand = side == BodySide::Left ? "left hand" : side == BodySide::Right ? "right hand" : "hand";
  add_joint_angle(angles, hand + (motion == HandMotion::Curl ? " curl" : " spread"),
                  within(context.posing, degrees, range_of_hand(motion)), "hand");
  Pose pose = with_joint_angles(armature, frames, pose_of(context.document()), angles);
  return finished(context, std::move(pose), angles);
}

}  // namespace limber::editor
