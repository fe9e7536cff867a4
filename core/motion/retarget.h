// SPDX-License-Identifier: AGPL-3.0-or-later
// Retargets the motion of one skeleton to another.
//
// Each matched bone has the same rotation in the world as its source joint, up to a constant offset:
//   posed_from_rest(bone, frame) = source(joint, frame) * rest_offset(bone)
// with `source` the joint's global rotation in LPS axes. The offset is computed once, at a reference frame at which the
// source's pose corresponds to the rig's rest pose: the source's rest pose if it stands there, else the frame at which
// it is nearest to standing. At this frame
//   - arms, thighs, shanks and fingers get the source's *directions*, so arms hang when the actor's hang, whatever pose
//     either skeleton rests in. Each bone takes the shortest turn from its direction under its turned parent. Palms
//     face as the source's palms;
//   - feet keep their pitch to the ground and get the source's heading; pelvis, spine, neck, head and collars, whose
//     bones run differently in every skeleton, keep their rest shape and get the heading of hips and shoulders.
// Where the source's joints do not show its stance, the user can name it (rest_pose_kind.h). Limbs that differ from the
// stance are then turned into it first, and it decides where palms without fingers face. The body faces where the actor
// faces. Unmatched trunk bones between matched ones share the bend; all other unmatched bones follow their parent. The
// rig keeps its bone lengths, and travel is scaled by the lengths of the legs. If the motion was made for this rig
// itself, each bone takes its joint's rotation directly.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/bvh.h"
#include "core/motion/foot_sliding.h"
#include "core/motion/rest_pose_kind.h"
#include "core/rig/pose.h"

namespace limber {

// The stances (kinds of rest pose) of source and rig, as the user named them. The source's stance is its pose at the
// reference frame.
struct RestStances {
  RestStance source = RestStance::AsItLies, rig = RestStance::AsItLies;

  bool operator==(const RestStances&) const = default;
};

struct RetargetMap {
  struct Source {
    std::string joint;
    // The bone's rotation relative to its joint (see the top of this file). Empty: it is computed from the two
    // skeletons.
    std::optional<glm::dquat> rest_offset;

    bool operator==(const Source&) const = default;
  };
  std::map<std::string, Source> sources;  // by name of the rig bone; bones that are not listed follow their parents
  RestStances stances;

  bool operator==(const RetargetMap&) const = default;
  // Returns the name of the bone's source joint, empty when it has none.
  std::string joint_of(const std::string& bone) const;
};

// Matches bones and joints by the body parts that their names mean (core/rig/joint_names.h). Throws Error when nothing
// matches.
RetargetMap match_by_names(const Motion& motion, const Armature& armature);

// Returns a copy of the map without the entries whose joint or bone does not exist.
RetargetMap known_part(const RetargetMap& map, const Motion& motion, const Armature& armature);

// Read and write a map as JSON:
//   {"source joint": "rig bone" | ["rig bone", ...] | {"bone": name, "rest_offset_wxyz": [4]} | null,
//    "@rests": {"motion": "file" | "T" | "A" | "anatomical", "rig": "file" | "T" | "A" | "anatomical"}}
// Throws Error for a joint or bone that does not exist, a bone named twice, or a map that matches nothing.
RetargetMap read_retarget_map(const Path& path, const Motion& motion, const Armature& armature);
RetargetMap parse_retarget_map(const std::string& text, const std::string& where, const Motion& motion,
                               const Armature& armature);
void write_retarget_map(const RetargetMap& map, const Path& path);

// How the body moves with the source's hips.
enum class Travel {
  Locked,   // the body stays where it rests
  InPlace,  // the body moves only up and down, so that feet on the ground are as high as at rest
  // The body also moves along the ground, as far as the source has since frame 0. Thighs, shanks and feet turn by up to
  // 1.95 degrees, so that feet slide no further than the source's (foot_sliding.h).
  Free,
};

// How to choose the reference frame, at which the pose of the source corresponds to the rest pose of the rig.
enum class Reference { Found, RestPose, FirstFrame };

struct RetargetSettings {
  Travel travel = Travel::Locked;
  bool mirror = false;  // swaps left and right
  double scale = 0;     // mm of travel per unit of the file; 0: computed from the lengths of the legs
  Reference reference = Reference::Found;

  bool operator==(const RetargetSettings&) const = default;
};

// A motion retargeted to a rig: prepared once, then evaluated at many frames. Invariant: `motion` and `armature`
// outlive it.
class Retarget {
 public:
  // Throws Error when the motion has no frames.
  Retarget(const Motion& motion, const Armature& armature, const RetargetMap& map,
           const RetargetSettings& settings = {});

  Pose at(int frame) const;                                      // throws Error for a frame the motion lacks
  int joint_of(int bone) const { return joint_of_bone_[bone]; }  // -1: the bone has no joint
  double scale() const { return scale_; }                        // mm per unit of the file
  RetargetMap map() const;                                       // the map in use, with all its rest offsets
  // Returns the source's joints that were turned into the named stance.
  const std::vector<int>& turned_joints() const { return turned_joints_; }

 private:
  // Returns the pose for the source's joints at a frame, without the correction of the feet.
  //   source  global transforms of the source's joints, in the file's axes and units
  Pose carried_over(const std::vector<RigidTransform>& source) const;
  // Returns the rotation of the bone from its rest pose, in world axes.
  //   carried  the parent bone's rotation from its rest pose, in world axes
  glm::dquat turned(int bone, const std::vector<RigidTransform>& source, const glm::dquat& carried) const;
  glm::dvec3 travelled(const std::vector<RigidTransform>& source) const;
  struct Leg {
    int thigh, shank, foot;  // bone indices; a leg without a shank has its foot as shank
    int toes;                // bone index; -1: no toes are matched
  };
  static int bone_of(const Leg& leg, int point);
  std::vector<FootTrack> foot_tracks() const;
  void move_foot(Pose& pose, const Leg& leg, const glm::dvec2& ankle_aside, const glm::dvec2& toes_aside) const;

  const Motion* motion_;
  const Armature* armature_;
  RetargetSettings settings_;
  RestStances stances_;
  // The motion in which limbs were turned into the named stance; motion_ then points to it. Null: no limb was turned.
  std::shared_ptr<const Motion> straight_;
  std::vector<int> turned_joints_;
  std::vector<int> joint_of_bone_;
  std::vector<glm::dquat> rest_offset_;  // for each bone
  struct Between {
    int below = -1, above = -1;  // indices of the nearest matched trunk bones on either side
    double share = 0;            // [0, 1]: 0 takes the rotation of `below`, 1 that of `above`
  };
  std::vector<Between> between_;  // for each bone; below = -1: the bone is matched, or follows its parent
  double scale_ = 1;
  int lead_ = -1;          // the joint whose movement is the body's travel; -1: none
  glm::dvec3 start_{0};    // that joint's position in the start pose, in the file's axes
  std::vector<Leg> legs_;  // legs whose feet are matched
  FootMending feet_;       // corrections of the feet; empty when there are none
};

}  // namespace limber
