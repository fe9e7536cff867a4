// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds and repairs likely errors in weights:
//   Unreached   a connected component of tissue without a bone in it, so that its weights are only a guess
//   Island      a small patch that mainly follows a bone, separate from the rest of the tissue that follows this bone
//   FarBones    voxels that follow two bones that are far from each other in the rig
//   SoftBone    bone tissue that bends, or that follows another rig bone than the bone tissue it has grown on
//   Steep       soft tissue whose weights change too much from one voxel to the next: it will tear or fold there
// One problem covers one component, one patch, one pair of bones, one rig bone (SoftBone), or one connected group of
// voxels.
#pragma once

#include <string>
#include <vector>

#include "core/skin/weight_edits.h"

namespace limber {

struct WeightProblem {
  enum class Kind { Unreached, Island, FarBones, SoftBone, Steep };
  Kind kind = Kind::Unreached;
  // The bones concerned. Unreached, Island: the bone that the voxels follow most. SoftBone: the bone that they should
  // follow. FarBones: the two bones. Steep: the bones on the two sides of the steep change.
  int bone = -1, other = -1;
  glm::dvec3 place{0};  // world, mm: centre of that voxel of the problem that is nearest to the mean position of all
  std::vector<std::int64_t> voxels;  // voxels of the problem: indices in the list of tissue voxels, ascending
};

struct ProblemSettings {
  // A patch smaller than this share of the bone's largest patch is an island, [0, 1].
  double island_share = 0.1;
  // Bones that are at least this many steps apart in the bone tree are far apart (siblings are 2 steps apart).
  int far_steps = 3;
  double far_weight = 0.02;  // FarBones: smallest weight that both bones must have
  // A change of weights between neighbouring voxels is steep if half the sum of the absolute differences exceeds this,
  // (0, 1]. At a value of 1 the two voxels have no bone in common.
  double steep = 0.5;
  std::int64_t least_voxels = 1;
};

// Returns the problems sorted by kind, and within a kind from the largest to the smallest.
std::vector<WeightProblem> find_problems(const WeightedBody& body, const SkinWeights& weights,
                                         const ProblemSettings& settings = {}, Progress& progress = no_progress());

// Describes a problem: "12 voxels of Hand apart from the rest".
std::string describe(const WeightProblem& problem, const Armature& armature);

// Repairs a problem within the scope's locks and region. SoftBone ignores the scope's `rigid_bone_tissue`.
//   Unreached   the whole component gets the weights of the nearest tissue of the body
//   Island      the patch is filled from its rim inwards with the mean weights of its neighbours
//   FarBones    the smaller of the two weights is removed, and the other bones take it over
//   SoftBone    the voxels follow the bone that they should follow, and no other
//   Steep       the voxels, and the tissue up to three voxels around them, are smoothed until the change is no longer
//               steep, at most 40 times
WeightEdit repaired(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                    const EditScope& scope = {}, const ProblemSettings& settings = {});

}  // namespace limber
