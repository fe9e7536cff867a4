// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/loop_poses.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/error.h"
#include "core/motion/ground_move.h"
#include "core/motion/key_curve.h"

namespace limber {

namespace {

constexpr std::int64_t kMostFrames = 1'000'000;
constexpr double kStill = 0.1;  // degrees per frame; the speeds of slower bones are not compared

void require_loop(std::size_t count, const LoopSettings& settings) {
  const std::int64_t steps = static_cast<std::int64_t>(count) - 1;
  if (steps < 2)
    throw Error("the motion is too short to be repeated", std::to_string(count) + " frames",
                "use three frames or more");
  if (settings.repeats < 1 || settings.repeats * steps >= kMostFrames)
    throw Error("these repeats have too many frames", std::to_string(settings.repeats) + " repeats",
                "use a number from 1 to " + std::to_string((kMostFrames - 1) / steps));
  if (settings.blend < 0 || settings.blend > steps)
    throw Error("the blend at the seam is longer than the motion", std::to_string(settings.blend) + " frames",
                "use a length from 0 to " + std::to_string(steps));
}

// Removes the travel and the change of heading from a take, evenly over its frames.
std::vector<Pose> on_the_spot(const Armature& armature, const std::vector<Pose>& poses) {
  const GroundMove whole = move_to(armature, poses.front(), poses.back());
  std::vector<Pose> still;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const double share = double(f) / double(poses.size() - 1);
    const glm::dvec3 centre = glm::mix(whole.from, whole.to, share);
    still.push_back(moved(armature, poses[f], {-share * whole.turn, centre, whole.from}));
  }
  return still;
}

glm::dquat turned_by(const glm::dvec3& turn) {
  const double angle = glm::length(turn);
  return angle > 1e-15 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
}

// The correction of one value at a seam: half of its difference to the other side's value, and half of the difference
// of the speeds. Rotation vectors in radians, or shifts in mm; speeds per frame.
struct Lack {
  glm::dvec3 way{0}, speed{0};

  // Returns the correction at a frame near the seam.
  //   share   0: at the frame farthest from the seam, 1: at the seam
  //   frames  number of blended frames on one side
  glm::dvec3 at(double share, double frames) const {
    const double square = share * share;
    return square * (3 - 2 * share) * way + square * (share - 1) * frames * speed;
  }
};

// A seam: the last two poses of the take and its first two poses, the latter moved to where the take ends.
struct Seam {
  Pose before, last, first, after;

  Lack bone(std::size_t b) const {
    return {turn_between(last.rotation[b], first.rotation[b]) / 2.0,
            (turn_between(first.rotation[b], after.rotation[b]) - turn_between(before.rotation[b], last.rotation[b])) /
                2.0};
  }
  Lack root() const {
    return {(first.root_translation - last.root_translation) / 2.0,
            (after.root_translation - first.root_translation - last.root_translation + before.root_translation) / 2.0};
  }
};

// Returns the take with its last and first frames corrected.
//   move  ground move from the beginning of the take to its end
std::vector<Pose> closed(const Armature& armature, std::vector<Pose> poses, const GroundMove& move, int blend) {
  const std::size_t last = poses.size() - 1, root = static_cast<std::size_t>(only_root(armature));
  const Seam seam{poses[last - 1], poses[last], moved(armature, poses[0], move), moved(armature, poses[1], move)};
  // At least the pose at the seam itself is corrected, so that the repeats join.
  const double frames = std::max(blend / 2.0, 1.0);
  const glm::dquat back = glm::conjugate(move.rotation());
  for (std::size_t step = 0; double(step) < frames; ++step) {
    const double share = 1 - double(step) / frames;
    Pose &end = poses[last - step], &start = poses[step];
    for (std::size_t b = 0; b < end.rotation.size(); ++b) {
      const Lack lack = seam.bone(b);
      // The frames after the seam need the opposite correction of values. Their correction of speeds keeps its sign,
      // because it is reversed twice: the difference is opposite, and the distance from the seam grows forwards instead
      // of backwards in time.
      const glm::dvec3 ahead = lack.at(share, frames), behind = Lack{-lack.way, lack.speed}.at(share, frames);
      end.rotation[b] = glm::normalize(turned_by(ahead) * end.rotation[b]);
      start.rotation[b] = glm::normalize(turned_by(b == root ? back * behind : behind) * start.rotation[b]);
    }
    const Lack lack = seam.root();
    end.root_translation += lack.at(share, frames);
    start.root_translation += back * Lack{-lack.way, lack.speed}.at(share, frames);
  }
  return poses;
}

// Returns the largest rotation of a bone from one pose to the next, in degrees, in the frames near both ends.
double fastest_near_ends(const std::vector<Pose>& poses, std::size_t bone, int frames) {
  double most = 0;
  const int steps = static_cast<int>(poses.size()) - 1;
  for (int f = 0; f < steps; ++f)
    if (f < frames || f >= steps - frames)
      most = std::max(most, glm::length(turn_between(poses[f].rotation[bone], poses[f + 1].rotation[bone])));
  return glm::degrees(most);
}

void measure(const Armature& armature, const std::vector<Pose>& take, const std::vector<Pose>& cycle,
             const GroundMove& move, int blend, LoopedPoses& out) {
  const Pose first = moved(armature, take.front(), move);
  const int frames = std::max(1, blend / 2);
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    const double gap = glm::degrees(glm::length(turn_between(take.back().rotation[b], first.rotation[b])));
    if (gap > out.gap_degrees) out.gap_degrees = gap, out.gap_bone = armature.bones[b].name;
    const double is = fastest_near_ends(cycle, b, frames), was = fastest_near_ends(take, b, frames);
    if (is > kStill) out.haste = std::max(out.haste, is / std::max(was, kStill));
  }
}

}  // namespace

LoopedPoses looped(const Armature& armature, const std::vector<Pose>& poses, const LoopSettings& settings) {
  require_loop(poses.size(), settings);
  const std::vector<Pose> take = settings.stays ? on_the_spot(armature, poses) : poses;
  const GroundMove move = move_to(armature, take.front(), take.back());
  const std::vector<Pose> cycle = closed(armature, take, move, settings.blend);
  LoopedPoses out;
  measure(armature, take, cycle, move, settings.blend, out);
  GroundMove so_far;
  for (int repeat = 0; repeat < settings.repeats; ++repeat) {
    for (std::size_t f = repeat == 0 ? 0 : 1; f < cycle.size(); ++f)
      out.poses.push_back(moved(armature, cycle[f], so_far));
    // The next repeat is moved by one more cycle: first by `move`, then by the moves of the repeats before it.
    so_far = {so_far.turn + move.turn, move.from, so_far.place(move.to)};
  }
  return out;
}

}  // namespace limber
