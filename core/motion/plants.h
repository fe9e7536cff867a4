// SPDX-License-Identifier: AGPL-3.0-or-later
// Plants feet on the ground and hands on targets: for some frames of a motion, a joint of a limb or the limb's tip
// keeps one position in the world. The limb's two long bones turn to reach it; the knee or elbow keeps its bending
// plane, and the foot or hand keeps its direction unless both its joint and its tip are planted. Before and after these
// frames the limb eases in and out. The body moves along with its feet, and sinks, within limits, if a leg would be too
// short to reach. What the limb still misses is reported by error_of().
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/rig/pose.h"

namespace limber {

// An arm or a leg of a rig, by its bones' indices.
struct PlantedLimb {
  std::string name;  // "left foot", "right foot", "left hand" or "right hand"; of a rig without sides "foot" or "hand"
  int upper = -1, lower = -1;  // thigh and shank, or upper arm and forearm
  int end = -1;                // foot or hand; -1: the rig has none, and the limb's tip is the lower bone's tail
  bool is_leg = false;
  // The axis about which the lower bone bends, in world axes at rest: a rotation by a positive angle bends it further.
  glm::dvec3 hinge{0};
};

// Finds the limbs of a rig by the names of its bones (joint_names.h); legs first.
std::vector<PlantedLimb> planted_limbs(const Armature& armature);

enum class PlantPoint {
  Joint,  // the head of the foot or hand: ankle or wrist
  Tip,    // the tail of the foot or hand: the ball of the foot, the end of the palm
};

struct Plant {
  int limb = 0;  // the limb whose hand or foot stays: an index in planted_limbs()
  PlantPoint point = PlantPoint::Tip;
  int first = 0, last = 0;  // the frames in which the point stays, both included
  glm::dvec3 place{0};      // position at which the point stays, in the world, mm
};

// Returns the position of a point of a limb in a pose, world, mm.
glm::dvec3 place_of(const PlantedLimb& limb, PlantPoint point, const Armature& armature, const Pose& pose);

// The positions of each limb's joint and tip (indexed by PlantPoint) in each pose, in the world, mm.
using LimbTracks = std::vector<std::array<std::vector<glm::dvec3>, 2>>;
LimbTracks limb_tracks(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses,
                       Progress& progress = no_progress());

// Finds the spans of frames in which a foot stands: its joint or its tip is low and slow. The position of each plant is
// the mean position of its point in the span.
//   rate  frames per second
std::vector<Plant> plants_of_feet(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                  const std::vector<Pose>& poses, double rate, Progress& progress = no_progress());

// Finds the spans of frames in which a foot or hand stays within two millimetres of one position, for example because
// it was planted before. Slow drifts, and the turning points of a swing, are not among them.
std::vector<Plant> plants_at_rest(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                  const std::vector<Pose>& poses, double rate, Progress& progress = no_progress());

// Returns those of `rests` in which the limb is fixed to something in the world (the ground, a handrail). A hand that
// also keeps still relative to the trunk only hangs, so its rest is left out, unless the hand moves relative to the
// trunk during the rest or at its ends.
//   rests  from plants_at_rest()
std::vector<Plant> held_by_world(const std::vector<Plant>& rests, const Armature& armature,
                                 const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses, double rate,
                                 Progress& progress = no_progress());

// Returns the plants without the frames in which `hold` holds their limb, or eases in or out. A plant may be split into
// two.
std::vector<Plant> without_held(const std::vector<Plant>& plants, const Plant& hold, int ease);

// Returns the poses in which the planted points are at their positions. Plants of one point may closely follow each
// other, but not overlap.
//   ease  frames over which a limb moves to its position before a plant, and away from it afterwards
// Throws Error for a plant without a limb or with frames that the motion does not have, and for plants that overlap.
// Throws Cancelled when the user stops it.
std::vector<Pose> planted(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                          const std::vector<Pose>& poses, const std::vector<Plant>& plants, int ease,
                          Progress& progress = no_progress());

// The accuracy with which a plant is kept, mm.
struct PlantError {
  double from_place = 0;  // largest distance of the point from the plant's position in its frames
  double slide = 0;       // largest horizontal distance of the point from its own position in the first of these frames
};
PlantError error_of(const Plant& plant, const Armature& armature, const std::vector<PlantedLimb>& limbs,
                    const std::vector<Pose>& poses);

}  // namespace limber
