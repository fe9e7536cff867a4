// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes few keys of many frames: the poses of a recorded motion become the keys of Bezier curves that stay within a
// given error of every frame, so that the motion can be edited by its curves.
//
// The method is that for drawn curves [Schneider, An algorithm for automatically fitting digitized curves, Graphics
// Gems, 1990], applied to each bone. A curve through few keys is fitted to all frames. Each span with a larger error
// gets a key at its worst frame, until no span does. Then each key that is not needed is removed, and two neighbouring
// keys are merged where one suffices. The times of the frames are given, so only the speeds at the keys are fitted, in
// the parent's frame, by least squares over all frames [Gauss-Newton method]. The speed is the same before and after a
// key (aligned handles).
#pragma once

#include "core/base/progress.h"
#include "core/motion/keyframes.h"

namespace limber {

struct ReduceSettings {
  double degrees = 0.5;  // largest allowed error of a bone's rotation
  double mm = 1;         // largest allowed error of the body's shift
};

struct ReducedKeys {
  Keys keys;
  std::int64_t count = 0;   // number of keys, of all bones and of the shift
  double most_degrees = 0;  // largest angle of a bone from its recorded rotation, over all frames
  double most_mm = 0;       // largest distance of the shift from the recorded one
  std::string worst_bone;   // the bone with the angle most_degrees; "" if none turns
};

// Returns keys for poses that belong to the frames `start`, `start` + 1, ... A bone that stays at rest gets no keys; a
// bone with one constant rotation gets one key. Throws Error unless both allowed errors are positive. Throws Cancelled
// when the user stops it.
ReducedKeys reduced_to_keys(const Armature& armature, const std::vector<Pose>& poses, int start,
                            const ReduceSettings& settings, Progress& progress);

// The largest errors that are allowed at each frame; all are positive.
struct AllowedErrors {
  // Allowed errors of rotations, degrees; one list for each bone, one value for each frame.
  std::vector<std::vector<double>> degrees;
  std::vector<double> mm;  // allowed error of the body's shift at each frame, mm
};
AllowedErrors allowed_everywhere(const Armature& armature, std::size_t frames, const ReduceSettings& settings);

// The keys of one bone, or of the shift.
template <class Value>
struct ReducedTrack {
  std::map<int, Value> keys;
  KeyShapes shapes;
  double error = 0;  // largest distance from the recorded values, degrees for a bone, mm for the shift
};

// Fits keys to the same poses several times. A bone whose allowed errors have not changed is not fitted again.
class KeyFitter {
 public:
  // Keeps references to the rig and to the poses. The poses belong to the frames `start`, `start` + 1, ...
  KeyFitter(const Armature& armature, const std::vector<Pose>& poses, int start);

  // Returns keys whose errors are nowhere larger than `allowed`. Throws Cancelled when the user stops it.
  ReducedKeys fitted(const AllowedErrors& allowed, Progress& progress);

 private:
  const Armature& armature_;
  const std::vector<Pose>& poses_;
  const int start_;
  AllowedErrors allowed_;  // errors with which the stored tracks were fitted; empty: not fitted yet
  std::vector<ReducedTrack<glm::dquat>> tracks_;
  ReducedTrack<glm::dvec3> root_;
};

}  // namespace limber
