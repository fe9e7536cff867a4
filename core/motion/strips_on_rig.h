// SPDX-License-Identifier: AGPL-3.0-or-later
// Strips applied to a rig: prepared once, then evaluated at many frames.
//
// Two rotations are blended by slerp, the body's shifts linearly. A strip that replaces the whole pose with full
// influence gives its own poses bit for bit, and the strips below it are not evaluated. Between two whole frames of a
// strip's clip, for example at half speed, the poses of the two frames are blended.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/strips.h"
#include "core/rig/pose.h"

namespace limber {

class ClipOnRig;

class StripsOnRig {
 public:
  // Bones of a strip that the rig does not have are ignored. A rig with several root bones cannot be turned as one. On
  // such a rig all cycles of a strip begin at the same position, and strips are not moved along the ground.
  //   rate    frames per second of the clip that has the strips
  //   before  an earlier StripsOnRig, whose prepared clips are reused if nothing has changed; may be null
  StripsOnRig(std::shared_ptr<const Strips> strips, std::shared_ptr<const Armature> armature, double rate,
              const StripsOnRig* before = nullptr);

  Pose at(int frame) const;
  // Returns one line that says which strips cannot move the rig, and why; empty if all can. Such a strip plays the rest
  // pose.
  const std::string& problem() const { return problem_; }

 private:
  struct OnRig {
    const Strip* strip;
    std::shared_ptr<const ClipOnRig> clip;
    // Number of the clip's frames that pass in one frame of the strip, and number that have passed at the strip's end.
    double ratio = 1, total = 0;
    int end = 0;  // last frame of the strip
    StripRun run;
    std::vector<char> changes;       // for each bone, whether the strip changes it; empty: all bones
    bool changes_root = true;        // whether the strip changes the body's shift
    GroundMove cycle;                // move of the body from the beginning of a cycle to its end
    std::optional<Pose> first_pose;  // first pose of the strip; only for StripBlend::AddChange
  };
  struct Layer {
    const OnRig* strip;
    double share;  // weight of the strip: its influence times its fade, (0, 1]
  };

  OnRig prepared(const Strip& strip, const StripRun& run, double rate, const StripsOnRig* before);
  void find_bones(OnRig& strip) const;
  // Returns the pose of the strip's clip after `passed` of its frames, mirrored if the strip is.
  Pose cycle_pose(const OnRig& strip, double passed) const;
  Pose pose_of(const OnRig& strip, int frame) const;
  static bool is_held(const std::vector<OnRig>& track, const OnRig& ended, int frame);
  std::vector<Layer> layers_at(int frame) const;
  bool covers(const Layer& layer) const;
  void blend(Pose& pose, const Layer& layer, int frame) const;

  std::shared_ptr<const Strips> strips_;
  std::shared_ptr<const Armature> armature_;
  std::map<const Clip*, std::shared_ptr<const ClipOnRig>> clips_;
  std::vector<std::vector<OnRig>> tracks_;  // the strips of the playing tracks, without muted strips
  bool has_one_root_ = true;
  std::string problem_;
};

}  // namespace limber
