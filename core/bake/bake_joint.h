// SPDX-License-Identifier: AGPL-3.0-or-later
// Bakes a joint (deform/baked_joint.h): solves it by finite elements at angles from rest to either end of its range,
// and stores how far the solved shapes differ from blending. Each solve starts from the shape at the angle before. The
// angles halfway between the baked ones are solved too, but used only to measure the error there.
//
// All angles on one side of rest share one model: the tissue that may deform, and the ends of bones that count as part
// of the joint, are those of the whole range, and no tissue stays rigid until contact reaches it (Fem::is_exact).
// Therefore shapes change smoothly with the angle. If each angle had a model of its own, neighbouring angles would
// differ: on a real arm by jumps of 4 mm, which no interpolation could follow.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/body/bind_body.h"
#include "core/body/body.h"
#include "core/deform/baked_joint.h"
#include "core/resample/fem.h"

namespace limber {

struct BakeSettings {
  double low = 0, high = 90;  // degrees from rest; low <= 0 <= high, and at least 5 degrees from end to end
  int angles = 7;  // number of baked angles from end to end, without rest; at least one on each side that has a range
  bool contact = true;  // true: skin touches skin in the solves instead of passing through
  FemQuality quality = FemQuality::Normal;
  std::string glide = "joint";  // how joints glide in the solves: a word of core/body/glide_poses.h
};

struct JointBake {
  BakedJoint joint;
  bool all_reached = true;            // false: the solver did not reach all angles, and the baked range is shorter
  std::vector<std::string> warnings;  // tell the user what differs from the request
};

// Throws Error for a bone without a parent or without an axis, for a bad range, when the tissue cannot be meshed, when
// no angle can be reached, and when the joint bends no tissue.
JointBake bake_joint(const Body& body, const BoundBody& bound, int bone, const BakeSettings& settings,
                     Progress& progress);

}  // namespace limber
