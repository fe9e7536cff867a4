// SPDX-License-Identifier: AGPL-3.0-or-later
// Plants feet on the ground and hands on targets: for some frames of a motion, a joint of a limb or the limb's tip
// stays at a place of the world. The limb's two long bones turn so that it does; the knee or elbow bends in its own
// plane, and foot or hand keeps its direction unless its joint and its tip are both planted. Before and after these
// frames the limb comes and goes smoothly. The body moves along with its feet, and sinks, within bounds, where a leg
// would be too short for its foot's place. What a limb cannot reach it misses (error_of()).
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
  // The axis about which the lower bone bends at rest, world: a turn by a positive angle bends it further.
  glm::dvec3 hinge{0};
};

// Finds the limbs of a rig by the names of its bones (joint_names.h); legs first.
std::vector<PlantedLimb> planted_limbs(const Armature& armature);

enum class PlantPoint {
  Joint,  // the head of the foot or hand: ankle or wrist
  Tip,    // the tail of the foot or hand: the ball of the foot, the end of the palm
};

struct Plant {
  int limb = 0;  // index in planted_limbs()
  PlantPoint point = PlantPoint::Tip;
  int first = 0, last = 0;  // the frames in which the point stays, both included
  glm::dvec3 place{0};      // where it stays, world, mm
};

// Returns the position of a point of a limb in a pose, world, mm.
glm::dvec3 place_of(const PlantedLimb& limb, PlantPoint point, const Armature& armature, const Pose& pose);

// The positions of each limb's joint and tip, by PlantPoint, in each pose, world, mm.
using LimbTracks = std::vector<std::array<std::vector<glm::dvec3>, 2>>;
LimbTracks limb_tracks(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses,
                       Progress& progress = no_progress());

// Finds the spans of frames in which a foot stands: its joint or its tip is low and slow. The place of each plant is
// the mean of the point's places in the span.
//   rate  frames per second
std::vector<Plant> plants_of_feet(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                  const std::vector<Pose>& poses, double rate, Progress& progress = no_progress());

// Finds the spans of frames in which a foot or hand rests at one place to within two millimetres, such as those in
// which it was planted or held before. Slow drifts and turning points of a swing are not among them.
std::vector<Plant> plants_at_rest(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                  const std::vector<Pose>& poses, double rate, Progress& progress = no_progress());

// Returns those of plants_at_rest() that the world holds: of a hand, only those during which, or at whose ends, the
// hand moves relative to the trunk. A hand that is still relative to both hangs idle, and goes where the body goes.
std::vector<Plant> held_by_world(const std::vector<Plant>& rests, const Armature& armature,
                                 const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses, double rate,
                                 Progress& progress = no_progress());

// Returns the plants without the frames in which the limb of `hold` is held, or comes there or leaves. A plant may fall
// into two.
std::vector<Plant> without_held(const std::vector<Plant>& plants, const Plant& hold, int ease);

// Returns the poses with the points at their places. Plants of one point may follow each other closely, but not
// overlap.
//   ease  frames over which a limb comes to its place and leaves it
// Throws Error for a plant without a limb or with frames that the motion does not have, for plants that overlap, and
// Cancelled.
std::vector<Pose> planted(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                          const std::vector<Pose>& poses, const std::vector<Plant>& plants, int ease,
                          Progress& progress = no_progress());

// How well a plant is kept, mm.
struct PlantError {
  double from_place = 0;  // largest distance of the point from its place in the planted frames
  double slide = 0;       // largest distance along the ground from where the point is in the first of these frames
};
PlantError error_of(const Plant& plant, const Armature& armature, const std::vector<PlantedLimb>& limbs,
                    const std::vector<Pose>& poses);

}  // namespace limber
