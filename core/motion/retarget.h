// SPDX-License-Identifier: AGPL-3.0-or-later
// Motion of one skeleton carried over to another.
//
// Each matched bone turns in the world exactly as its source joint turns:
//   posed_from_rest(bone, frame) = source(joint, frame) * rest_offset(bone)
// with `source` the joint's global rotation in LPS axes. The offset is fixed once, from a moment when the source stands
// as a rig rests: its rest pose where that is a standing one, else the frame nearest to standing. At that moment
//   - arms, thighs, shanks and fingers get the source's *directions* (so arms hang when the actor's hang, whatever pose
//     either skeleton rests in), each by the shortest turn from where the bone above carries it; palms get its facing;
//   - feet keep their pitch to the ground and get its heading; pelvis, spine, neck, head and collars, whose bones run
//     differently in every skeleton, keep their rest shape and get the heading of hips and shoulders.
// What the source's joints do not tell then may be said (rest_pose_kind.h): limbs that lie otherwise than said are laid
// so first, and palms that have no fingers face as said. The body faces where the actor faces. Bones of the trunk
// between matched ones share the bend; all others follow the bone they hang from. Lengths stay the rig's; travel is
// scaled by the legs' lengths. In a motion of the rig itself each joint is its bone.
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

// What both rest in. The source: at zero angles, or in its first frame where that is the reference.
struct RestStances {
  RestStance source = RestStance::AsItLies, rig = RestStance::AsItLies;

  bool operator==(const RestStances&) const = default;
};

struct RetargetMap {
  struct Source {
    std::string joint;
    std::optional<glm::dquat> rest_offset;  // as above; without one it is found

    bool operator==(const Source&) const = default;
  };
  std::map<std::string, Source> sources;  // by rig bone; bones that are not named follow
  RestStances stances;

  bool operator==(const RetargetMap&) const = default;
  // The bone's source joint, empty when it has none.
  std::string joint_of(const std::string& bone) const;
};

// By what the names mean (core/rig/joint_names.h). Throws Error when nothing matches.
RetargetMap match_by_names(const Motion& motion, const Armature& armature);

// What of the map both have.
RetargetMap known_part(const RetargetMap& map, const Motion& motion, const Armature& armature);

// {"source joint": "rig bone" | ["rig bone", ...] | {"bone": name, "rest_offset_wxyz": [4]} | null,
//  "@rests": {"motion": "file" | "T" | "A" | "anatomical", "rig": likewise}}
// Throws Error for a joint or bone that is not there, a bone named twice, or a map that matches nothing.
RetargetMap read_retarget_map(const Path& path, const Motion& motion, const Armature& armature);
RetargetMap parse_retarget_map(const std::string& text, const std::string& where, const Motion& motion,
                               const Armature& armature);
void write_retarget_map(const RetargetMap& map, const Path& path);

// How the body goes with the source's hips.
enum class Travel {
  Locked,   // stays where it rests
  InPlace,  // goes up and down, so that its feet on the ground stand as high as at rest, and nowhere else
  Free,     // up and down likewise; and as the source does since frame 0, so that its feet slide no further than the
            // source's: thighs, shanks and feet turn by up to 1.95 degrees for it (foot_sliding.h)
};

// The moment at which the source stands as the rig rests.
enum class Reference { Found, RestPose, FirstFrame };

struct RetargetSettings {
  Travel travel = Travel::Locked;
  bool mirror = false;  // left and right change places
  double scale = 0;     // of the travel: mm for a unit of the file; 0: by the legs' lengths
  Reference reference = Reference::Found;

  bool operator==(const RetargetSettings&) const = default;
};

// Prepared once, asked for many frames. Invariant: `motion` and `armature` outlive it.
class Retarget {
 public:
  // Throws Error when the motion has no frames.
  Retarget(const Motion& motion, const Armature& armature, const RetargetMap& map,
           const RetargetSettings& settings = {});

  Pose at(int frame) const;                                                 // throws Error for a frame the motion lacks
  int joint_of(int bone) const { return joint_of_bone_[bone]; }             // -1 where unmatched
  double scale() const { return scale_; }                                   // mm per file unit
  RetargetMap map() const;                                                  // with the offsets that are in use
  const std::vector<int>& turned_joints() const { return turned_joints_; }  // that lay otherwise than is said

 private:
  // Where the source's joints are so; without what the feet add to the travel.
  Pose carried_over(const std::vector<RigidTransform>& source) const;
  //   carried  how the bone above has turned from rest, in the world; likewise what is returned
  glm::dquat turned(int bone, const std::vector<RigidTransform>& source, const glm::dquat& carried) const;
  glm::dvec3 travelled(const std::vector<RigidTransform>& source) const;
  struct Leg {
    int thigh, shank, foot;  // bones; without a shank it is the foot
    int toes;                // -1 where none are matched
  };
  static int bone_of(const Leg& leg, int point);
  std::vector<FootTrack> foot_tracks() const;
  void move_foot(Pose& pose, const Leg& leg, const glm::dvec2& ankle_aside, const glm::dvec2& toes_aside) const;

  const Motion* motion_;
  const Armature* armature_;
  RetargetSettings settings_;
  RestStances stances_;
  std::shared_ptr<const Motion> straight_;  // what motion_ is, where limbs had to be turned
  std::vector<int> turned_joints_;
  std::vector<int> joint_of_bone_;
  std::vector<glm::dquat> rest_offset_;  // per bone
  struct Between {
    int below = -1, above = -1;  // matched bones of the trunk
    double share = 0;            // of the turn from below to above
  };
  std::vector<Between> between_;  // per bone; below = -1 where it follows its parent
  double scale_ = 1;
  int lead_ = -1;          // the joint that the body travels with
  glm::dvec3 start_{0};    // where it is at frame 0, in the file's axes
  std::vector<Leg> legs_;  // with feet that are matched
  FootMending feet_;       // where the body travels
};

}  // namespace limber
