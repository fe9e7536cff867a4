// SPDX-License-Identifier: AGPL-3.0-or-later
// A clip: a motion that moves the rig, and the keys set on top of it.
//
// Time is counted in frames of the clip, `rate` of them in a second. The motion's frame `first` stands at frame
// `start`; before and after what is used of it the body holds still. Where there is no motion, keys start from rest.
//
// Keys warp the motion [Witkin & Popovic, Motion Warping, 1995]: at a key's frame the bone stands as the key says;
// between two keys the motion goes on, turned by what the keys differ from it, going over from one to the next by
// slerp; before the first and after the last that turn stays. Without a motion this is the slerp of the keys
// themselves.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/motion/keyframes.h"
#include "core/motion/retarget.h"

namespace limber {

struct Marker {
  int frame = 0;
  std::string name;

  bool operator==(const Marker&) const = default;
};

struct Clip {
  std::string name;                      // unique among the clips
  std::shared_ptr<const Motion> motion;  // null: keys alone
  double rate = 30;                      // frames in a second
  int start = 0;
  int first = 0, last = 0;  // of the motion, both used
  RetargetMap map;          // without sources: by names
  RetargetSettings retarget;
  int range_start = 0, range_end = 250;  // what plays, both included
  Keys keys;
  std::vector<Marker> markers;  // by frame

  bool operator==(const Clip&) const = default;     // with the same motion: its pointer, not its contents
  int end() const { return start + last - first; }  // the last frame of the motion
};

// The whole motion from frame `start` on, at its own rate. An infinite or absurd rate becomes 30.
Clip clip_of(std::shared_ptr<const Motion> motion, std::string name, int start = 0);

// `wanted`, or with a number behind it when a clip has that name.
std::string unique_clip_name(const std::vector<std::shared_ptr<const Clip>>& clips, const std::string& wanted);

// A clip on a rig, prepared once, asked for many frames.
class ClipOnRig {
 public:
  // Where nothing of the motion matches the rig, problem() says so, and the motion is left out. What the map names and
  // either lacks is left out too.
  //   before  of which the preparation is taken over where nothing that it depends on has changed
  ClipOnRig(std::shared_ptr<const Clip> clip, std::shared_ptr<const Armature> armature,
            const ClipOnRig* before = nullptr);

  Pose at(int frame) const;
  const std::shared_ptr<const Clip>& clip() const { return clip_; }
  const std::shared_ptr<const Armature>& armature() const { return armature_; }
  const Retarget* retarget() const { return retarget_.get(); }
  const std::string& problem() const { return problem_; }

 private:
  Pose base_at(int frame) const;  // without keys

  std::shared_ptr<const Clip> clip_;
  std::shared_ptr<const Armature> armature_;
  std::shared_ptr<const Retarget> retarget_;  // of the clip's motion and the armature
  std::string problem_;
};

}  // namespace limber
