// SPDX-License-Identifier: AGPL-3.0-or-later
// A clip is a motion that moves the rig, and the keyframes set on top of it.
//
// Time is counted in frames of the clip, with `rate` frames in a second. The clip uses the motion's frames `first` to
// `last`; frame `first` plays at the clip's frame `start`. Before and after these frames the body holds still. If the
// clip has no motion, bones without keys stay in the rest pose.
//
// In place of a motion a clip may have strips: other clips that play one after another and over one another
// (core/motion/strips.h).
//
// The pose of a frame is made in this order: the motion or the strips, the keys, the constraints.
//
// Keys warp the motion [Witkin & Popovic, Motion Warping, 1995]. At a key's frame the bone has the key's rotation.
// Between two keys the bone follows the motion, rotated by a correction. At each key the correction is the rotation
// from the motion to the key; from one key to the next it is interpolated as the key's shape says, by slerp if it has
// none (core/motion/key_curve.h). It stays constant before the first key and after the last. Without a motion the keys
// themselves are interpolated.
//
// Constraints then change the pose of motion and keys (core/motion/constraint.h): a bone looks at a target, a hand
// stays in its place.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/motion/keyframes.h"
#include "core/motion/retarget.h"

namespace limber {

struct Constraints;
class ConstraintStack;
struct Strips;
class StripsOnRig;

struct Marker {
  int frame = 0;
  std::string name;

  bool operator==(const Marker&) const = default;
};

struct Clip {
  std::string name;                      // name of the clip, unique among the clips
  std::shared_ptr<const Motion> motion;  // null: the clip has only keys
  double rate = 30;                      // frames per second at which the clip plays
  int start = 0;
  int first = 0, last = 0;  // range of the motion's frames that is used, both included
  RetargetMap map;          // which joint moves which bone; without entries, bones and joints are matched by name
  RetargetSettings retarget;
  int range_start = 0, range_end = 250;  // the frames that play, both included
  Keys keys;
  std::vector<Marker> markers;                     // the clip's markers, sorted by frame
  std::shared_ptr<const Constraints> constraints;  // declared in core/motion/constraint.h; null: no constraints
  // Declared in core/motion/strips.h; null: no strips. A clip with a motion has no strips.
  std::shared_ptr<const Strips> strips;

  // Compares the pointers of motion, constraints and strips, not their contents.
  bool operator==(const Clip&) const = default;
  int end() const { return start + last - first; }  // the clip's frame at which the motion ends
};

// Makes a clip that plays the whole motion from frame `start` on, at the motion's own rate. A rate outside
// [0.01, 10000] becomes 30.
Clip clip_of(std::shared_ptr<const Motion> motion, std::string name, int start = 0);

// Returns the name `wanted`, with a number appended if a clip has this name already.
std::string unique_clip_name(const std::vector<std::shared_ptr<const Clip>>& clips, const std::string& wanted);

// A clip applied to a rig: prepared once, then evaluated at many frames.
class ClipOnRig {
 public:
  // If the motion cannot move the rig, problem() says why and the clip plays without the motion. Entries of the
  // retarget map whose joint or bone does not exist are ignored.
  //   before  an earlier ClipOnRig, whose preparation is reused if nothing that it depends on has changed; may be null
  ClipOnRig(std::shared_ptr<const Clip> clip, std::shared_ptr<const Armature> armature,
            const ClipOnRig* before = nullptr);

  Pose at(int frame) const;
  Pose unconstrained_at(int frame) const;  // returns the pose of motion and keys, without the constraints
  Pose base_at(int frame) const;           // returns the pose of the motion or the strips alone, without the keys
  // Returns whether a motion or strips move the rig. If so, keys change their poses; if not, the pose comes from the
  // keys alone.
  bool has_base() const { return retarget_ || strips_; }
  const ConstraintStack* constraints() const { return constraints_.get(); }  // null: there are none
  const std::shared_ptr<const Clip>& clip() const { return clip_; }
  const std::shared_ptr<const Armature>& armature() const { return armature_; }
  const Retarget* retarget() const { return retarget_.get(); }
  const StripsOnRig* strips() const { return strips_.get(); }  // null: the clip has no strips
  const std::string& problem() const { return problem_; }

 private:
  // Adds the shift of the root's keys at a frame to `pose`, which is the motion's pose at this frame. `base` returns
  // the motion's pose at other frames.
  void move_root(Pose& pose, int frame, const std::function<const Pose&(int)>& base) const;

  std::shared_ptr<const Clip> clip_;
  std::shared_ptr<const Armature> armature_;
  std::shared_ptr<const Retarget> retarget_;  // null: the clip has no motion, or there is a problem
  std::shared_ptr<const ConstraintStack> constraints_;
  std::shared_ptr<const StripsOnRig> strips_;
  std::string problem_;
};

}  // namespace limber
