// SPDX-License-Identifier: AGPL-3.0-or-later
// Repairs a joint: changes the weights around it so that skin, fat and muscle keep their volumes over the joint's range
// of motion and overlap less. The volume of blended tissue changes with the slope of its share w about the joint's axis
// (turn_table.h): what the flexor side loses, a wider blend on the extensor side gains.
//
//   1. The widths of the joint capsule on its flexor and its extensor side are searched (capsule_shares.h).
//   2. From the best capsule, or from the weights as they are where these are better, a smooth correction is found on
//      the nodes of coarse cells by bounded L-BFGS (volume_model.h, bounded_minimum.h).
//   3. The body is resampled in all turns. The difference between what came out and what was predicted corrects the
//      prediction, and the correction is repeated once. Where more tissue overlaps than before, it starts again with
//      higher costs of folds and overlap.
//   4. Of all weights so found, those with the smallest mean of S = |skin| + |fat| + |muscle| volume change are kept,
//   but
//      only if S is smaller than before, and no more tissue overlaps in the mean of the turns.
//
// On the Bender arm, by dual quaternions from 0 to 90 degrees: S 13.0 -> 0.5 % at +45, 47.5 -> 17.8 % at +90, overlap
// 2424 -> 263 voxels at +45, in 6 CPU s. Knee, hip and shoulder of a whole body of 3 mm: S 1.5 -> 0.4, 2.4 -> 0.7 and
// 1.5 -> 1.0 % of the whole body's tissue, in the mean of their turns.
//
// Bones stay rigid, weights sum to one, locked bones keep their weights. The result does not depend on the number of
// threads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/repair/capsule_shares.h"
#include "core/repair/volume_model.h"
#include "core/skin/normalize.h"

namespace limber {

struct JointRepairSettings {
  std::optional<TurnRange> range;  // none: the joint's own (default_range)
  Blend blend = Blend::Mixed;      // that the body is posed by
  BoneSet locked;                  // bones whose weights stay; empty: none
};

// What one turn of the joint does to the resampled body.
struct TurnFigures {
  JointTurn turn;
  FleshChange change{};             // volume changes of skin, fat and muscle, % of the body's
  std::int64_t overlap_voxels = 0;  // posed voxels in which tissue overlaps
  double sum() const;               // S, %
};

struct JointRepair {
  bool is_better = false;  // false: nothing was found, and the weights are the given ones
  SkinWeights weights;
  std::int64_t changed = 0;                // voxels whose weights differ
  CapsuleWidths widths;                    // of the capsule that the correction started from
  bool starts_from_capsule = false;        // false: the correction started from the given weights
  std::vector<TurnFigures> before, after;  // in the turns of joint_motion(); equal where nothing was found
};

// Throws Error as joint_motion() does, if no soft tissue moves at the joint, and if no tissue is skin, fat or muscle.
//   bone  the bone below the joint
JointRepair repair_joint(const WeightedBody& body, const SkinWeights& weights, int bone,
                         const JointRepairSettings& settings = {}, Progress& progress = no_progress());

// Means over the turns.
double mean_sum(const std::vector<TurnFigures>& figures);
double mean_overlap(const std::vector<TurnFigures>& figures);

// Returns the result in one sentence for the user, without a full stop.
std::string describe(const JointRepair& repair, const Armature& armature, int bone);

}  // namespace limber
