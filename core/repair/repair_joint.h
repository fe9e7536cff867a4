// SPDX-License-Identifier: AGPL-3.0-or-later
// Repairs a joint: changes the weights around it so that skin, fat and muscle keep their volumes over the joint's range
// of motion and overlap less. The volume of blended tissue depends on the gradient of its share w around the joint's
// axis (turn_table.h), so a wider blend on the extensor side can gain the volume that the flexor side loses.
//
//   1. Searches for the best widths of the joint capsule on its flexor and its extensor side (capsule_shares.h).
//   2. From the best capsule, or from the present weights if they are better, finds a smooth correction on the nodes of
//      coarse cells by bounded L-BFGS (volume_model.h, bounded_minimum.h).
//   3. Resamples the body in all turns. The difference between resampled and predicted volume changes corrects the
//      prediction, and step 2 is repeated. If more tissue overlaps than before the repair, step 2 starts again with
//      higher costs of folds and overlap.
//   4. Of all weights found in this way, keeps those with the smallest mean of S = |skin| + |fat| + |muscle| volume
//      change, but only if S is smaller than before, and if no more tissue overlaps in the mean of the turns.
//
// On the Bender arm, by dual quaternions from 0 to 90 degrees: S falls from 13.0 to 0.5 % at 45 degrees and from 47.5
// to 17.8 % at 90 degrees, the overlap from 2424 to 263 voxels at 45 degrees, in 6 CPU s. Knee, hip and shoulder of a
// whole body with voxels of 3 mm: S falls from 1.5 to 0.4, from 2.4 to 0.7 and from 1.5 to 1.0 % of the whole body's
// tissue, in the mean of their turns.
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
  std::optional<TurnRange> range;  // range of the joint's angle; none: the usual motion of the joint (joint_motion.h)
  Blend blend = Blend::Mixed;      // the blend by which the body will be posed
  BoneSet locked;                  // bones whose weights do not change; empty: none
};

// The changes of the resampled body in one turn of the joint.
struct TurnFigures {
  JointTurn turn;
  FleshChange change{};             // volume changes of skin, fat and muscle, % of the body's volume of each
  std::int64_t overlap_voxels = 0;  // posed voxels in which tissue overlaps
  double sum() const;               // S: sum of the absolute volume changes, %
};

struct JointRepair {
  bool is_better = false;  // false: no better weights were found, and `weights` are the given ones
  SkinWeights weights;
  std::int64_t changed = 0;          // number of voxels whose weights have changed
  CapsuleWidths widths;              // widths of the capsule from which the correction started
  bool starts_from_capsule = false;  // false: the correction started from the given weights
  // Figures before and after the repair, one entry for each turn of joint_motion(); equal if no better weights were
  // found.
  std::vector<TurnFigures> before, after;
};

// Repairs a joint. Throws Error as joint_motion() does, if no soft tissue moves at the joint, and if no tissue is skin,
// fat or muscle.
//   bone  the bone below the joint
JointRepair repair_joint(const WeightedBody& body, const SkinWeights& weights, int bone,
                         const JointRepairSettings& settings = {}, Progress& progress = no_progress());

// Return the means over the turns: of S, the sum of the absolute volume changes (%), and of the overlapping voxels.
double mean_sum(const std::vector<TurnFigures>& figures);
double mean_overlap(const std::vector<TurnFigures>& figures);

// Returns the result in one sentence for the user, without a full stop.
std::string describe(const JointRepair& repair, const Armature& armature, int bone);

}  // namespace limber
