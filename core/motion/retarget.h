// SPDX-License-Identifier: AGPL-3.0-or-later
// Retargets the motion of one skeleton to another.
//
// The source is the motion's skeleton, the rig is the skeleton that the motion is to move. A bone of the rig is matched
// if a joint of the source moves it. It has the same rotation in the world as its joint, up to a constant offset:
//   posed_from_rest(bone, frame) = source(joint, frame) * rest_offset(bone)
// with `source` the joint's global rotation in LPS axes. The offset is computed once, at a reference frame at which the
// source's pose corresponds to the rig's rest pose. This is the source's rest pose if the source stands in it, else the
// frame at which the source is nearest to standing. At this frame
//   - arms, thighs, shanks and fingers get the *directions* of the source's limbs, so arms hang when the actor's arms
//     hang, whatever the rest poses of the skeletons are. Each bone first follows its parent, then takes the shortest
//     rotation to the direction of its joint. Palms face as the source's palms do;
//   - feet keep their pitch to the ground and get the source's heading; pelvis, spine, neck, head and collars, whose
//     bones run differently in every skeleton, keep their rest shape and get the heading of hips and shoulders.
// If the source's joints do not show in which pose it rests, the user can name this pose (rest_pose_kind.h). Limbs that
// differ from the named pose are then turned into it first, and the named pose decides where palms without fingers
// face. Unmatched trunk bones between matched ones share the bend; all other unmatched bones follow their parent. The
// rig keeps its bone lengths, and travel is scaled by the lengths of the legs. If the motion was made for this rig
// itself, each bone takes the rotation of the joint of its name.
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

// The kinds of rest pose (stances) that the user named for source and rig. For the source, this is its pose at the
// reference frame.
struct RestStances {
  RestStance source = RestStance::AsItLies, rig = RestStance::AsItLies;

  bool operator==(const RestStances&) const = default;
};

struct RetargetMap {
  struct Source {
    std::string joint;
    // The constant rotation between the bone and its joint (see the top of this file). Empty: the rotation is computed
    // from the two skeletons.
    std::optional<glm::dquat> rest_offset;

    bool operator==(const Source&) const = default;
  };
  // The source of each bone, by the bone's name. Bones without an entry follow their parents.
  std::map<std::string, Source> sources;
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

// The part of the movement of the source's hips that the whole body follows.
enum class Travel {
  Locked,   // the body stays at its rest position
  InPlace,  // the body moves only up and down, so that feet on the ground are as high as at rest
  // The body moves up and down and along the ground, by the source's movement since frame 0. Thighs, shanks and feet
  // are rotated by up to 1.95 degrees so that the feet slide no further than the source's feet (foot_sliding.h).
  Free,
};

// The reference frame, at which the pose of the source corresponds to the rest pose of the rig. Found: the source's
// rest pose if the source stands in it, else the frame at which the source is nearest to standing.
enum class Reference { Found, RestPose, FirstFrame };

struct RetargetSettings {
  Travel travel = Travel::Locked;
  bool mirror = false;  // true: left and right of the body are swapped
  double scale = 0;     // mm of travel per unit of the file; 0: computed from the lengths of the legs
  Reference reference = Reference::Found;

  bool operator==(const RetargetSettings&) const = default;
};

// A motion retargeted to a rig. It is prepared once and then evaluated at many frames. The caller must keep `motion`
// and `armature` alive as long as this object.
class Retarget {
 public:
  // Prepares the retargeting. Throws Error when the motion has no frames.
  Retarget(const Motion& motion, const Armature& armature, const RetargetMap& map,
           const RetargetSettings& settings = {});

  Pose at(int frame) const;                                      // throws Error for a frame the motion lacks
  int joint_of(int bone) const { return joint_of_bone_[bone]; }  // index of its joint; -1: no joint
  double scale() const { return scale_; }                        // mm per unit of the file
  RetargetMap map() const;                                       // the map with all rest offsets filled in
  // Returns the indices of the source's joints that were turned into the rest pose that the user named.
  const std::vector<int>& turned_joints() const { return turned_joints_; }

 private:
  // Returns the pose of the rig for one frame of the source, before the feet are corrected.
  //   source  global transforms of the source's joints, in the file's axes and units
  Pose carried_over(const std::vector<RigidTransform>& source) const;
  // Returns the rotation of a bone from its rest pose, in world axes, for one frame of the source.
  //   carried  the parent bone's rotation from its rest pose, in world axes
  glm::dquat turned(int bone, const std::vector<RigidTransform>& source, const glm::dquat& carried) const;
  glm::dvec3 travelled(const std::vector<RigidTransform>& source) const;
  struct Leg {
    int thigh, shank, foot;  // bone indices; a leg without a shank has its foot as shank
    int toes;                // index of the toes bone; -1: no toes bone is matched to a joint
  };
  static int bone_of(const Leg& leg, int point);
  std::vector<FootTrack> foot_tracks() const;
  void move_foot(Pose& pose, const Leg& leg, const glm::dvec2& ankle_aside, const glm::dvec2& toes_aside) const;

  const Motion* motion_;
  const Armature* armature_;
  RetargetSettings settings_;
  RestStances stances_;
  // A copy of the motion whose limbs were turned into the rest pose that the user named; motion_ then points to this
  // copy. Null: no limb was turned.
  std::shared_ptr<const Motion> straight_;
  std::vector<int> turned_joints_;
  std::vector<int> joint_of_bone_;
  std::vector<glm::dquat> rest_offset_;  // constant rotation between each bone and its joint
  struct Between {
    int below = -1, above = -1;  // indices of the nearest matched trunk bones towards the pelvis and towards the head
    double share = 0;            // interpolates the rotation: 0 is that of bone `below`, 1 that of bone `above`
  };
  std::vector<Between> between_;  // one entry per bone; below = -1: the bone is matched, or follows its parent
  double scale_ = 1;
  int lead_ = -1;          // index of the source joint whose movement the whole body follows; -1: no joint
  glm::dvec3 start_{0};    // position of joint lead_ from which the travel is measured, in the file's axes
  std::vector<Leg> legs_;  // legs whose foot bones are matched to joints
  FootMending feet_;       // corrections that keep the feet from sliding; empty: no corrections
};

}  // namespace limber
