// SPDX-License-Identifier: AGPL-3.0-or-later
// Cuts connected bone tissue apart where rig bones meet. In a coarse scan the bones of a limb touch along whole joint
// surfaces, and in a closed hand also along their sides; a watershed does not stop at such contacts. For each joint of
// the rig, the shafts on both sides are found. If bone tissue connects them, it is cut along the surface with the
// smallest area between them [Boykov & Kolmogorov 2003: cut metrics measured on a voxel grid]. The area is weighted:
// the weight is larger away from the joint (and rises steeply beyond a twelfth of the shorter bone's length) and larger
// in marrow than in the shells of bone. So of several thin places the one at the joint is cut, and not the thin shaft
// beside it. Between bones that do not touch, the cut has no area, and nothing is changed. In joints with known names,
// the cut prefers the anatomical surface of the joint (core/bones/joint_surface.h). If the bones are fused over half of
// the joint or more, no thin place shows where one bone ends, and the anatomical surface gets more weight.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_watershed.h"
#include "core/rig/armature.h"

namespace limber {

// A voxel beyond a joint of rig bone `bone`: it does not belong to `bone`, but may belong to `other`, the bone on the
// far side of the joint.
struct BeyondJoint {
  std::int32_t voxel;  // index in the graph
  int bone, other;
};

// Two rig bones between which the cut is uncertain: its area is at least 1.5 times the thinner bone's cross-section, so
// that no thin place shows where one bone ends.
struct BroadCut {
  int bone, other;
  double area;  // area of the cut, mm^2
};

struct JointCuts {
  std::vector<BeyondJoint> beyond;
  std::vector<BroadCut> broad;
  std::vector<float> depth;  // bone_depth() of each voxel after the cuts, mm
};

// Makes all cuts between rig bones: in `graph`, the entries of both voxels of every cut edge become kNotBone.
//   group       index in `candidates` for each voxel of the graph
//   candidates  rig bones that each group of voxels may follow; empty: any
JointCuts cut_at_joints(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
                        const Armature& armature, const std::vector<std::int32_t>& group,
                        const std::vector<std::vector<int>>& candidates, Progress& progress = no_progress());

}  // namespace limber
