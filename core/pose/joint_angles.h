// SPDX-License-Identifier: AGPL-3.0-or-later
// The angles of a body's joints in the words of clinicians: "left hip flexion=90", "elbows flexion=20", "spine left
// bending=15". Angles count from the anatomical position: upright, arms and legs straight, arms hanging, palms and feet
// forward. Motions and their order are those of the ISB [Wu et al. 2002, 2005, Journal of Biomechanics], signs are
// those of speech:
//   flexion, abduction, internal rotation, pronation, dorsiflexion, inversion, ulnar deviation and elevation are
//   positive; extension, adduction, external rotation, supination, plantarflexion, eversion, radial deviation and
//   depression turn back. Pronation counts from palms forward: 90 turns the palm to the body. Lateral bending is
//   positive to the right and axial rotation to the left; "left bending", "right rotation" and the like say it in
//   words.
#pragma once

#include <array>
#include <compare>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/joint_names.h"

namespace limber {

enum class BodyJoint {
  Spine,
  Neck,
  Girdle,
  Shoulder,
  Elbow,
  Forearm,
  Wrist,
  Hip,
  Knee,
  Ankle,
  Toes,
  Thumb,
  Index,
  Middle,
  Ring,
  Little,
};

struct SidedJoint {
  BodyJoint joint;
  BodySide side = BodySide::Middle;  // of a joint that the body has twice: not said

  auto operator<=>(const SidedJoint&) const = default;
};

// Degrees of a joint's up to three motions, in the order in which they are applied; none: not said.
//   Spine, Neck   flexion, lateral bending to the right, axial rotation to the left
//   Hip, Shoulder flexion, abduction, internal rotation      Girdle  elevation, protraction, upward rotation
//   Wrist         flexion, ulnar deviation                   Ankle   dorsiflexion, inversion
//   Elbow, Knee   flexion       Forearm  pronation           Toes    extension
//   Thumb .. Little             flexion of the knuckle, the middle joint and the last one (the thumb has two: the first
//   and the last)
using JointMotions = std::array<std::optional<double>, 3>;
using JointAngles = std::map<SidedJoint, JointMotions>;

// Adds what a request says, "left hip flexion=90", over what is there. Words in any case; a plural or "both" means both
// sides. throws Error for a joint, a motion or a number that it does not understand, and lists what is known
void add_joint_request(JointAngles& angles, const std::string& request, const std::string& where);

// "left hip", "neck": for messages.
std::string name_of(const SidedJoint& joint);
// The name of a motion by its place in JointMotions, "internal rotation"; empty where the joint has no such motion.
std::string_view motion_name(BodyJoint joint, std::size_t motion);

// "spine, neck, shoulder girdle, ...", and "hip: flexion, extension, ...": what may be written.
std::string known_joints();
std::string known_motions(BodyJoint joint);

// The part of the body whose bone a joint turns.
BodyPart part_of(BodyJoint joint);
// Whether the body has it on its left and on its right.
bool is_paired(BodyJoint joint);

// A line for each angle beyond what adults usually reach [AAOS, Joint Motion: Method of Measuring and Recording, 1965].
std::vector<std::string> beyond_usual(const JointAngles& angles);

}  // namespace limber
