// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/posed_mesh.h"

#include <algorithm>

#include "core/mesh/untangle.h"
#include "core/mesh/voxel_ball.h"
#include "core/resample/pose_path.h"
#include "core/skin/weight_at.h"

namespace limber {

namespace {

constexpr int kNearJoint = 2;  // bone voxels up to this many voxels from another bone count as part of a joint
constexpr int kSpread = 40;    // number of mesh edges over which the shifts of bone nodes are spread into flesh
// A second sample point in the flesh lies at this share of the way from the voxel's centre to the node.
constexpr double kTowards = 0.7;

glm::dvec3 place_of(const Eigen::MatrixX3d& V, int node) { return {V(node, 0), V(node, 1), V(node, 2)}; }

std::vector<bool> bone_labels(const TissueTable& tissues) {
  std::vector<bool> is_bone_label(65536, false);
  for (const Tissue& each : tissues.tissues) is_bone_label[each.label] = is_bone(each.kind);
  return is_bone_label;
}

// For each node, one of its tets of bone and one of its tets of soft tissue; -1: it has none.
struct TetsAtNodes {
  std::vector<int> bone, soft;
  TetsAtNodes(const TetMesh& mesh, const std::vector<bool>& is_bone_label)
      : bone(mesh.V.rows(), -1),
        soft(mesh.V.rows(), -1) {
    for (int t = 0; t < int(mesh.T.rows()); ++t)
      for (const int node : mesh.T.row(t)) (is_bone_label[mesh.region[t]] ? bone : soft)[node] = t;
  }
};

// Spreads the nodes' shifts to the nodes around them, by kSpread rounds of averaging over mesh edges. Nodes that are
// `fixed` keep their shifts; far from them shifts become small.
//   shift   #V, mm; changed at nodes that are not fixed
void spread(std::vector<glm::dvec3>& shift, const Eigen::MatrixX4i& T, const std::vector<bool>& fixed) {
  std::vector<glm::dvec3> sum(shift.size());
  std::vector<int> count(shift.size());
  for (int round = 0; round < kSpread; ++round) {
    std::fill(sum.begin(), sum.end(), glm::dvec3(0));
    std::fill(count.begin(), count.end(), 0);
    for (const auto& tet : T.rowwise()) {
      glm::dvec3 all(0);
      for (const int node : tet) all += shift[node];
      for (const int node : tet) sum[node] += all - shift[node], count[node] += 3;
    }
    for (std::size_t node = 0; node < shift.size(); ++node)
      if (!fixed[node] && count[node] > 0) shift[node] = sum[node] / double(count[node]);
  }
}

int strongest(const Influence& influence) {
  int best = 0;
  for (int k = 1; k < 4; ++k)
    if (influence.weight[k] > influence.weight[best]) best = k;
  return influence.bone[best];
}

// Returns the rig bone that each voxel of bone follows; -1 for all other tissue voxels.
std::vector<std::int32_t> bones_of_voxels(const LabelVolume& volume, const TissueVoxels& tissue,
                                          const std::vector<bool>& is_bone_label, const SkinWeights& weights) {
  std::vector<std::int32_t> bone_of(tissue.size(), -1);
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    const InfluenceChunk& influences = weights.chunk(brick);
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      if (is_bone_label[volume.at(v)]) bone_of[place] = strongest(influences[place - tissue.bricks()[brick].first]);
    });
  }
  return bone_of;
}

// Returns true for each node that moves rigidly: a node of bone, unless two bones of the rig share it. Bones share
// nodes where they touch only at an edge or a corner of a voxel.
std::vector<bool> rigid_nodes(const BodyMesh& body, const LabelVolume& volume, const TissueVoxels& tissue,
                              const std::vector<bool>& is_bone_label, const SkinWeights& weights) {
  const std::vector<std::int32_t> bone_of = bones_of_voxels(volume, tissue, is_bone_label, weights);
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  std::vector<std::int32_t> bone_at(body.mesh.V.rows(), -1);
  std::vector<bool> rigid(body.mesh.V.rows(), false), shared(body.mesh.V.rows(), false);
  for (int t = 0; t < int(body.mesh.T.rows()); ++t) {
    if (!is_bone_label[body.mesh.region[t]]) continue;
    const glm::ivec3 voxel(
        glm::floor(to_voxel * place_of(body.mesh.V, body.mesh.T(t, body.voxel_corner[t])) + glm::dvec3(0.5)));
    const std::int64_t place = volume.grid.contains(voxel) ? tissue.index_of(voxel) : -1;
    const std::int32_t bone = place < 0 ? -1 : bone_of[place];
    for (const int node : body.mesh.T.row(t)) {
      rigid[node] = true;
      if (bone < 0) continue;
      if (bone_at[node] >= 0 && bone_at[node] != bone) shared[node] = true;
      bone_at[node] = bone;
    }
  }
  for (std::size_t node = 0; node < rigid.size(); ++node) rigid[node] = rigid[node] && !shared[node];
  return rigid;
}

}  // namespace

std::shared_ptr<const Seams> seams_and_joints(const LabelVolume& volume, const TissueVoxels& tissue,
                                              const TissueTable& tissues, const SkinWeights& weights) {
  const std::vector<std::int32_t> bone_of = bones_of_voxels(volume, tissue, bone_labels(tissues), weights);
  auto cut = std::make_shared<Seams>(tissue.seams() ? *tissue.seams() : Seams(volume.grid.size));
  const auto bone_at = [&](const glm::ivec3& v) {
    const std::int64_t place = volume.grid.contains(v) ? tissue.index_of(v) : -1;
    return place < 0 ? -1 : bone_of[place];
  };
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const std::int32_t bone = bone_of[place];
    if (bone < 0 ||
        !any_voxel_near(v, volume.grid, kNearJoint, [&](const glm::ivec3& near) { return bone_at(near) > bone; }))
      return;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        glm::ivec3 next = v;
        next[axis] += side;
        if (volume.grid.contains(next) && bone_at(next) != bone && tissue.index_of(next) >= 0)
          cut->cut(side < 0 ? next : v, axis);
      }
  });
  return cut;
}

PosedMesh pose_mesh(const BodyMesh& body, const LabelVolume& volume, const TissueVoxels& tissue,
                    const TissueTable& tissues, const SkinWeights& weights, const Armature& armature, const Pose& pose,
                    Blend blend, const FemShape* shape, const BakedJoints& baked) {
  const std::vector<bool> is_bone_label = bone_labels(tissues);
  const TetsAtNodes tets(body.mesh, is_bone_label);
  const auto voxel_at = [&](int tet) { return place_of(body.mesh.V, body.mesh.T(tet, body.voxel_corner[tet])); };
  // True for nodes on a seam or on bone, which move with the flesh on one side of them.
  std::vector<bool> is_edge(body.mesh.V.rows(), false);
  for (const int node : body.at_seam) is_edge[node] = true;

  // Finds the posed position of the flesh at each node, also at the border of bone. At nodes with is_edge it is
  // extrapolated from two points in the flesh on one side.
  std::vector<int> bone_nodes, soft_nodes;
  std::vector<glm::dvec3> bone_voxels, soft;
  for (int node = 0; node < int(body.mesh.V.rows()); ++node) {
    if (tets.bone[node] >= 0) {
      bone_nodes.push_back(node);
      bone_voxels.push_back(voxel_at(tets.bone[node]));
      is_edge[node] = true;
    }
    if (tets.soft[node] < 0) continue;
    soft_nodes.push_back(node);
    const glm::dvec3 at = place_of(body.mesh.V, node);
    if (is_edge[node]) {
      soft.push_back(voxel_at(tets.soft[node]));
      soft.push_back(glm::mix(soft.back(), at, kTowards));
    } else {
      soft.push_back(at);
    }
  }
  const std::vector<glm::dvec3> moved =
      posed_points(volume, tissue, tissues, weights, armature, pose, blend, shape, soft, baked);
  std::vector<glm::dvec3> flesh(body.mesh.V.rows());
  std::size_t next = 0;
  for (const int node : soft_nodes) {
    flesh[node] = moved[next++];
    if (is_edge[node]) flesh[node] += (moved[next++] - flesh[node]) / kTowards;
  }

  // Moves the nodes of bone rigidly, and spreads the resulting shifts to the flesh around them.
  const auto motions =
      skin_transforms(bone_motions(weights.bones(), armature, shape ? part_of_pose(pose, shape->reached) : pose));
  const std::vector<SkinAt> skin = skin_at(volume, tissue, weights, bone_voxels);
  std::vector<glm::dvec3> shift(body.mesh.V.rows(), glm::dvec3(0));
  const std::vector<bool> fixed = rigid_nodes(body, volume, tissue, is_bone_label, weights);
  for (std::size_t i = 0; i < bone_nodes.size(); ++i) {
    const int node = bone_nodes[i];
    const glm::dvec3 at = blend_point(blend, motions, std::vector<BoneWeight>{{strongest(skin[i].influence), 1.0}},
                                      place_of(body.mesh.V, node));
    if (tets.soft[node] < 0) flesh[node] = at;
    shift[node] = at - flesh[node];
  }
  spread(shift, body.mesh.T, fixed);
  PosedMesh posed{body.mesh.V};
  for (std::size_t node = 0; node < flesh.size(); ++node) {
    const glm::dvec3 at = flesh[node] + shift[node];
    posed.V.row(node) << at.x, at.y, at.z;
  }
  posed.inside_out = untangle(posed.V, body.mesh.V, body.mesh.T, fixed);
  return posed;
}

}  // namespace limber
