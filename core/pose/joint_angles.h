// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and names the angles of a body's joints in clinical terms: "left hip flexion=90", "elbows flexion=20", "spine
// left bending=15". Angles are measured from the anatomical position: upright, arms and legs straight, arms hanging,
// palms and feet forward [neutral zero method: AAOS, Joint Motion: Method of Measuring and Recording, 1965]. Hips,
// knees and ankles turn about the axes of Grood & Suntay [1983], as the ISB recommends [Wu et al. 2002, Journal of
// Biomechanics 35]; elbows, forearms, wrists and fingers about those of the ISB [Wu et al. 2005, Journal of
// Biomechanics 38]. Shoulders turn about the same axes as hips, since clinicians say "flexion" and "abduction"; the ISB
// names a plane of elevation instead. Signs:
//   flexion, abduction, internal rotation, pronation, dorsiflexion, inversion, ulnar deviation and elevation are
//   positive; extension, adduction, external rotation, supination, plantarflexion, eversion, radial deviation and
//   depression are negative. A knee's varus and an elbow's valgus (its carrying angle) are positive. Spreading moves
//   fingers away from the middle finger, the middle finger towards the ring finger, and the thumb out of the palm's
//   plane to the palmar side. Pronation is zero with palms forward; 90 turns the palm to the body. Lateral bending is
//   positive to the right and axial rotation to the left; a request may also say "left bending", "right rotation".
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
  BodySide side = BodySide::Middle;  // Middle: the joint is neither left nor right, or the request gave no side

  auto operator<=>(const SidedJoint&) const = default;
};

// The angles of the motions of one joint, degrees. Entries are empty for angles that were not given. The order of the
// entries is the order in which the motions are applied:
//   Spine, Neck   flexion, lateral bending to the right, axial rotation to the left
//   Hip, Shoulder flexion, abduction, internal rotation      Girdle  elevation, protraction, upward rotation
//   Wrist         flexion, ulnar deviation                   Ankle   dorsiflexion, inversion, internal rotation
//   Elbow         flexion, valgus                            Knee    flexion, varus, internal rotation
//   Forearm       pronation                                  Toes    extension
//   Index .. Little  flexion of the knuckle, the middle joint and the last joint, then spreading at the knuckle
//   Thumb            flexion of the saddle joint, the knuckle and the last joint, then abduction at the saddle joint
constexpr std::size_t kMotionsOfJoint = 4;
constexpr std::size_t kSpread = 3;  // index of a finger's spreading and of the thumb's abduction
using JointMotions = std::array<std::optional<double>, kMotionsOfJoint>;
using JointAngles = std::map<SidedJoint, JointMotions>;

// Adds a request such as "left hip flexion=90" to `angles`, and replaces an earlier angle of the same motion. Words may
// be in upper or lower case; a plural or "both" means both sides. Throws Error for an unknown joint or motion or a bad
// number, and lists the known words.
//   where  names the source of the request in the error message
void add_joint_request(JointAngles& angles, const std::string& request, const std::string& where);

// Adds an angle, degrees, for a request `asked` that has no number: "left hip flexion".
void add_joint_angle(JointAngles& angles, const std::string& asked, double degrees, const std::string& where);

// Returns the joint's name for messages: "left hip", "neck".
std::string name_of(const SidedJoint& joint);
// Returns the name of a motion by its index in JointMotions ("internal rotation"). Empty if the joint has no such
// motion.
std::string_view motion_name(BodyJoint joint, std::size_t motion);
// Returns the name for negative angles of a motion: "external rotation" for internal rotation. Empty if there is no
// such name, as for the joints of fingers.
std::string_view opposite_name(BodyJoint joint, std::size_t motion);

// List the words that a request may use: the joints ("spine, neck, shoulder girdle, ...") and the motions of a joint
// ("flexion, extension, ...").
std::string known_joints();
std::string known_motions(BodyJoint joint);

// Returns the body part whose bone the joint turns.
BodyPart part_of(BodyJoint joint);
// Returns whether the body has this joint on both its left and its right.
bool is_paired(BodyJoint joint);

struct AngleRange {
  double low = 0, high = 0;  // lowest and highest angle, degrees
};
// Returns the range that adults usually reach [AAOS 1965; varus, valgus and axial rotation of elbow, knee and ankle:
// Kapandji, The Physiology of the Joints]. Empty if the joint has no such motion.
std::optional<AngleRange> usual_range(BodyJoint joint, std::size_t motion);
// Returns whether a joint is one of a hand's fingers or its thumb.
constexpr bool is_finger(BodyJoint joint) { return joint >= BodyJoint::Thumb; }

// Returns a warning for each angle beyond its usual range.
std::vector<std::string> beyond_usual(const JointAngles& angles);

}  // namespace limber
