// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/posed_points.h"

#include <memory>

#include "core/deform/carried_points.h"
#include "core/resample/pose_path.h"
#include "core/skin/weight_at.h"

namespace limber {

namespace {
constexpr double kBesideMesh = 10;  // points within this distance of the mesh move with it, mm

// Returns, for each point, the position to which the mesh moves it; none: the mesh does not move the point, for example
// because the point is in tissue that is not meshed.
std::vector<std::optional<glm::dvec3>> carried(const LabelVolume& volume, const TissueVoxels& tissue,
                                               const FemShape& shape, std::span<const glm::dvec3> points) {
  const AffineTransform to_voxel = voxel_from_world(volume.grid), to_world = world_from_voxel(volume.grid);
  std::vector<PointToCarry> rest;
  for (const glm::dvec3& point : points) rest.push_back({to_voxel * point, to_voxel * point});
  const auto mesh = std::make_shared<const TetMesh>(shape.model.fem.mesh);
  std::vector<std::optional<glm::dvec3>> posed = CarriedPoints(mesh, volume.grid, rest, kBesideMesh).posed(shape.V);
  for (std::size_t i = 0; i < posed.size(); ++i) {
    if (!posed[i]) continue;
    posed[i] = to_world * *posed[i];
    const glm::ivec3 voxel(glm::floor(rest[i].rest + 0.5));
    const int brick = volume.grid.contains(voxel) ? tissue.brick_at(voxel) : -1;
    if (brick < 0) continue;
    const bool is_tissue = tissue.index_of(voxel) >= 0;
    const bool is_meshed = shape.moving.meshed[brick][voxel.z & 7] >> ((voxel.x & 7) + 8 * (voxel.y & 7)) & 1;
    if (is_tissue && !is_meshed) posed[i].reset();
  }
  return posed;
}
}  // namespace

std::vector<glm::dvec3> posed_points(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                     const SkinWeights& weights, const Armature& armature, const Pose& pose,
                                     Blend blend, const FemShape* shape, std::span<const glm::dvec3> points,
                                     const BakedJoints& baked) {
  const auto motions =
      skin_transforms(bone_motions(weights.bones(), armature, shape ? part_of_pose(pose, shape->reached) : pose));
  const std::vector<SkinAt> skin = skin_at(volume, tissue, weights, points);
  std::vector<std::optional<glm::dvec3>> by_mesh(points.size());
  if (shape) by_mesh = carried(volume, tissue, *shape, points);
  const BakedFlesh flesh(tissue, volume.grid, joints_in_pose(baked, armature, pose));
  const AffineTransform to_voxel = voxel_from_world(volume.grid), to_world = world_from_voxel(volume.grid);
  std::vector<glm::dvec3> posed;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Tissue* at = tissues.find(skin[i].label);
    if (by_mesh[i] && !(at && is_bone(at->kind))) {
      posed.push_back(*by_mesh[i]);
      continue;
    }
    std::vector<BoneWeight> influences;
    for (int k = 0; k < 4; ++k)
      if (skin[i].influence.weight[k] > 0)
        influences.push_back({skin[i].influence.bone[k], skin[i].influence.weight[k] / 65535.0});
    posed.push_back(blend_point(blend, motions, influences, points[i]));
    if (!(at && is_bone(at->kind)))
      posed.back() += to_world.linear * glm::dvec3(flesh.shift_at(to_voxel * points[i] + 0.5));
  }
  return posed;
}

}  // namespace limber
