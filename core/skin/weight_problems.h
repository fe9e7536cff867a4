// SPDX-License-Identifier: AGPL-3.0-or-later
// What may be wrong with weights, where it is, and what to do about it.
//   Unreached   a piece of tissue apart from the body: no bone lies in it, so nothing but a guess says what it follows
//   Island      a small patch that mainly follows a bone, apart from the rest of what follows that bone
//   FarBones    voxels that follow two bones far from each other in the rig
//   SoftBone    bone tissue that bends, or that follows another bone than the bone tissue it has grown on
//   Steep       soft tissue whose weights change too much from one voxel to the next: it will tear or fold there
// One problem stands for one place: a piece, a patch, a pair of bones, a run of voxels that hang together.
#pragma once

#include <string>
#include <vector>

#include "core/skin/weight_edits.h"

namespace limber {

struct WeightProblem {
  enum class Kind { Unreached, Island, FarBones, SoftBone, Steep };
  Kind kind = Kind::Unreached;
  int bone = -1, other = -1;  // Unreached, Island: the bone followed most; SoftBone: the bone to be followed; FarBones:
                              // both; Steep: the two sides
  glm::dvec3 place{0};        // world, mm: the middle of the voxel nearest to the middle of all
  std::vector<std::int64_t> voxels;  // places in the tissue list, growing; what FarBones and Steep would change
};

struct ProblemSettings {
  double island_share = 0.1;  // a patch is an island when it is smaller than this share of the bone's largest, [0, 1]
  int far_steps = 3;          // along the rig from bone to bone: that many or more is far (siblings are 2 apart)
  double far_weight = 0.02;   // both bones have at least this
  double steep = 0.5;         // half the sum of |differences| of all bones between neighbours, (0, 1]: 1 is a clean cut
  std::int64_t least_voxels = 1;
};

// By kind, within a kind the largest first.
std::vector<WeightProblem> find_problems(const WeightedBody& body, const SkinWeights& weights,
                                         const ProblemSettings& settings = {}, Progress& progress = no_progress());

// "12 voxels of Hand apart from the rest"
std::string describe(const WeightProblem& problem, const Armature& armature);

// Under the scope's locks; its region counts as well, its `rigid_bone_tissue` does not for SoftBone.
//   Unreached   the piece follows, as one, what the nearest tissue of the body does
//   Island      filled in from its rim
//   FarBones    the lesser of the two goes, the others take over
//   SoftBone    rigid with its bone
//   Steep       smoothed there and for three voxels around, until it is not steep, 40 times at most
WeightEdit repaired(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                    const EditScope& scope = {}, const ProblemSettings& settings = {});

}  // namespace limber
