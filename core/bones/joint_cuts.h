// SPDX-License-Identifier: AGPL-3.0-or-later
// Cuts connected bone tissue apart where rig bones meet. In a coarse scan the bones of a limb touch along whole joint
// surfaces, and in a hand held closed also along their sides; a watershed runs across such contacts. For each joint of
// the rig the shaft on either side of it is found, and where bone tissue connects the two, it is cut along the surface
// of least area between them [Boykov & Kolmogorov 2003: cut metrics measured on a voxel grid]. The area counts more
// away from the joint, steeply farther than a twelfth of the shorter bone, and more through marrow than through the
// shells of bone, so that of several necks the one at the joint is cut, and not the thin shaft beside it. Bones that do
// not touch have a cut of no area, and nothing is changed. In joints that the rig's names tell, the cut prefers the
// surface that anatomy knows (core/bones/joint_surface.h); where the bones are closed up over half the joint or more,
// no neck says where one ends, and it prefers that twice as much.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_watershed.h"
#include "core/rig/armature.h"

namespace limber {

// A voxel that lies beyond a joint, seen from a rig bone: it is not of that bone, and may well be of the other one.
struct BeyondJoint {
  std::int32_t voxel;  // of the graph
  int bone, other;
};

// Two rig bones whose tissue touched, where it was cut apart, in half again the area of the thinner one's cross-section
// or more: no neck says where one bone ends.
struct BroadCut {
  int bone, other;
  double area;  // mm^2
};

struct JointCuts {
  std::vector<BeyondJoint> beyond;
  std::vector<BroadCut> broad;
  std::vector<float> depth;  // of the graph after the cuts, as bone_depth() says it
};

// Removes the graph's connections across the cuts: both sides see kNotBone.
//   group       #graph, into `candidates`
//   candidates  the rig bones that a group may follow; none means any
JointCuts cut_at_joints(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
                        const Armature& armature, const std::vector<std::int32_t>& group,
                        const std::vector<std::vector<int>>& candidates, Progress& progress = no_progress());

}  // namespace limber
