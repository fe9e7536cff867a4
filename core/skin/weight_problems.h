// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds and repairs likely errors in weights. The kinds of problems are:
//   Unreached   a connected component of tissue without a rig bone in it, so that its weights are only a guess
//   Island      a small patch that mainly follows a bone, separate from the other tissue that follows this bone
//   FarBones    voxels that follow two bones that are far from each other in the rig
//   SoftBone    bone tissue that bends, or that follows another rig bone than the bone tissue around it
//   Steep       soft tissue whose weights change too much from one voxel to the next: it will tear or fold there
// One problem covers one component (Unreached), one patch (Island), one pair of bones (FarBones), one rig bone
// (SoftBone) or one connected group of voxels (Steep).
#pragma once

#include <string>
#include <vector>

#include "core/skin/weight_edits.h"

namespace limber {

struct WeightProblem {
  enum class Kind { Unreached, Island, FarBones, SoftBone, Steep };
  Kind kind = Kind::Unreached;
  // The bones that the problem is about. For Unreached and Island, `bone` is the bone that the voxels follow most. For
  // SoftBone it is the bone that they should follow. For FarBones, `bone` and `other` are the two bones; for Steep, the
  // bones on the two sides of the steep change.
  int bone = -1, other = -1;
  glm::dvec3 place{0};               // a voxel in the middle of the problem: its centre, world, mm
  std::vector<std::int64_t> voxels;  // the problem's voxels, as ascending indices in the list of tissue voxels
};

struct ProblemSettings {
  // A patch is an island if it is smaller than this share [0, 1] of the largest patch of its bone.
  double island_share = 0.1;
  // Two bones are far apart if they are at least this many steps apart in the bone tree. Siblings are 2 steps apart.
  int far_steps = 3;
  double far_weight = 0.02;  // FarBones: weight that each of the two bones must have at least
  // Upper limit on the change of weights between neighbouring voxels, (0, 1]; a larger change is steep. The change is
  // half the sum of the absolute differences. It is 1 when the two voxels have no bone in common.
  double steep = 0.5;
  std::int64_t least_voxels = 1;
};

// Returns the problems sorted by kind. Within each kind, larger problems come first.
std::vector<WeightProblem> find_problems(const WeightedBody& body, const SkinWeights& weights,
                                         const ProblemSettings& settings = {}, Progress& progress = no_progress());

// Returns a text that describes a problem, such as "12 voxels of Hand apart from the rest".
std::string describe(const WeightProblem& problem, const Armature& armature);

// Repairs a problem. Locked bones and voxels outside the scope's region do not change. SoftBone ignores the scope's
// `rigid_bone_tissue`.
//   Unreached   the whole component gets the weights of the nearest other tissue of the body
//   Island      the patch is filled from its rim inwards with the mean weights of its neighbours
//   FarBones    the smaller of the two weights is removed, and the other bones take it over
//   SoftBone    the voxels follow the bone that they should follow, and no other
//   Steep       the voxels, and the tissue up to three voxels around them, are smoothed until the change is no longer
//               steep, at most 40 times
WeightEdit repaired(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                    const EditScope& scope = {}, const ProblemSettings& settings = {});

}  // namespace limber
