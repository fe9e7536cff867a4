// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/resample.h"

#include <algorithm>
#include <chrono>

#include "core/base/error.h"
#include "core/deform/baked_flesh.h"
#include "core/deform/blend_rule.h"
#include "core/deform/inverse_map.h"
#include "core/deform/settled_flesh.h"
#include "core/resample/fem_shape.h"
#include "core/resample/output_grid.h"
#include "core/resample/pose_path.h"
#include "core/resample/posed_voxels.h"
#include "core/resample/rigid_weights.h"

namespace limber {

namespace {

class Seconds {
 public:
  double operator()() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Returns the method's blend (rule of skinning). For finite elements it returns linear blending: tissue outside the
// mesh moves rigidly, so every blend gives the same result.
Blend blend_of(const Method& method) {
  const Blend* blend = std::get_if<Blend>(&method);
  return blend ? *blend : Blend::Linear;
}

bool settles_flesh(const Method& method) {
  return std::holds_alternative<Blend>(method) && rule_of(std::get<Blend>(method)).settles_flesh;
}

void check_baked(const Method& method, const BakedJoints& baked) {
  const Blend* blend = std::get_if<Blend>(&method);
  if (baked.empty() || (blend && *blend == Blend::DualQuaternion)) return;
  throw Error("baked joints correct dual quaternions only", blend ? rule_of(*blend).word : "finite elements",
              "pose by dual quaternions (dqs), or without baked joints");
}

// Returns true if regions of the body may overlap in the pose: at least two bones have different motions.
bool can_fold(const std::vector<RigidTransform>& motions) {
  return std::any_of(motions.begin(), motions.end(), [&](const RigidTransform& m) {
    return m.rotation != motions[0].rotation || m.translation != motions[0].translation;
  });
}

// Returns the number of tissue voxels in bricks (cubes of 8^3 voxels) whose posed shape reaches beyond the output grid.
std::int64_t count_dropped(const PosedLattice& lattice, const PosedTets* tets, const VoxelRange& range) {
  const FixedPoint low = range.low * kFixedOne - kFixedOne / 2, high = range.high * kFixedOne + kFixedOne / 2;
  std::int64_t dropped = 0;
  for (std::int64_t b = 0; b < std::ssize(lattice.tissue().bricks()); ++b) {
    if (tets && tets->shares(b)) continue;  // output_grid() has made the grid large enough for all tets
    const auto& box = lattice.bounds(b);
    if (glm::any(glm::lessThan(box.low, low - kFixedOne)) || glm::any(glm::greaterThan(box.high, high + kFixedOne)))
      dropped += lattice.tissue().bricks()[b].count();
  }
  return dropped;
}

void tell(const FemShape& shape, DeformReport& report) {
  report.mesh = shape.mesh;
  report.solve = shape.solve;
  report.objects = shape.objects;
  report.seconds_mesh = shape.seconds_mesh;
  report.seconds_solve = shape.seconds_solve;
}

// A body whose weights are rigid in bone tissue (each bone voxel follows one rig bone), with the data that are the same
// for all poses.
struct RigidBody {
  const LabelVolume& volume;
  const TissueTable& tissues;
  const Armature& armature;
  TissueVoxels tissue;
  LabelSets labels;
  SkinWeights weights;

  RigidBody(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature, const SkinWeights& weights,
            std::shared_ptr<const Seams> seams, Progress& progress)
      : volume(volume),
        tissues(tissues),
        armature(armature),
        tissue(volume),
        labels(tissues),
        weights(with_rigid_bones(weights, volume, tissue, tissues, labels.bone, armature, progress)) {
    tissue.set_seams(std::move(seams));
  }
};

// Returns the weights of tissue that does not move with the mesh.
SkinWeights weights_beside_mesh(const RigidBody& body, const FemShape& shape) {
  SkinWeights weights = with_rigid_rest(body.weights, body.tissue, shape.moving);
  return shape.sides ? without_strays(std::move(weights), body.tissue, shape.sides->strays) : weights;
}

// Poses the body. Returns its labels in tiles, or nothing if the labels are already in posed.volume (write_voxels).
//   shape  the mesh that finite elements have solved for the pose; null: skinning
std::optional<TiledLabels> deform_body(const RigidBody& body, const Pose& pose, std::shared_ptr<const FemShape> shape,
                                       const Method& method, const ResampleSettings& settings, Posed& posed,
                                       Progress& progress) {
  const Seconds seconds;
  const LabelVolume& volume = body.volume;
  const LabelSets& labels = body.labels;
  const glm::dvec3 ratio = settings.spacing ? spacing_ratio(volume.grid, *settings.spacing) : glm::dvec3(1);
  const auto motions = bone_motions(body.weights.bones(), body.armature, shape ? shape->pose : pose);
  const SkinWeights weights = shape ? weights_beside_mesh(body, *shape) : body.weights;
  std::optional<TissueVoxels> cut;  // the tissue with the seams along which the mesh is cut
  if (shape && shape->sides) cut.emplace(body.tissue).set_seams(shape->sides->sides.seams);
  posed.shape = std::move(shape);
  DeformReport& report = posed.report;
  if (posed.shape) tell(*posed.shape, report);

  std::optional<SettledFlesh> settled;
  if (settles_flesh(method) && can_fold(motions))
    report.settled =
        settled.emplace(volume, body.tissue, weights, labels.bone, motions, blend_of(method), progress).report();
  const BakedFlesh baked(body.tissue, volume.grid, joints_in_pose(settings.baked, body.armature, pose));
  report.baked = report_of_baked(settings.baked, body.armature, pose);
  const FleshShifts* shifts = baked.empty() ? nullptr : &baked;
  if (settled) shifts = &*settled;
  const PosedLattice lattice(volume, cut ? *cut : body.tissue, weights, motions, blend_of(method), ratio, progress,
                             shifts);
  const RigidBones bones(lattice, weights, labels.bone, motions);
  std::optional<PosedTets> tets;
  if (posed.shape)
    tets.emplace(posed.shape->model.fem.mesh, posed.shape->V, lattice, posed.shape->moving.meshed, progress,
                 posed.shape->sides ? &posed.shape->sides->of_voxel : nullptr);
  const OutputGrid output = output_grid(lattice, bones, tets ? &*tets : nullptr);
  std::optional<TissueDepth> depth;
  if (can_fold(motions)) depth.emplace(body.tissue, volume.grid.spacing);

  report.tissue_voxels = body.tissue.size();
  report.overlap_by_label.assign(65536, 0);
  for (const std::string& name : weights.bones()) report.bones.push_back({name});
  report.dropped_voxels = count_dropped(lattice, tets ? &*tets : nullptr, output.range);
  report.seconds_deform = seconds();

  const Seconds rasterize_seconds;
  const bool mends = can_fold(motions) && !settings.nearest;
  std::optional<TiledLabels> posed_labels =
      write_voxels({volume, body.tissues, labels, lattice, bones, tets ? &*tets : nullptr, depth ? &*depth : nullptr,
                    output, mends, tets.has_value() || !baked.empty()},
                   settings, posed, progress);
  std::erase_if(report.bones, [](const auto& bone) { return bone.voxels == 0; });
  report.seconds_rasterize = rasterize_seconds();
  return posed_labels;
}

// Returns the volume of the body in one pose. To save memory, the labels are laid out in rows after the data of the
// deformation are freed.
Posed resample_body(const RigidBody& body, const Pose& pose, std::shared_ptr<const FemShape> shape,
                    const Method& method, const ResampleSettings& settings, Progress& progress) {
  Posed posed;
  std::optional<TiledLabels> labels = deform_body(body, pose, std::move(shape), method, settings, posed, progress);
  if (labels) posed.volume = in_rows(std::move(*labels));
  return posed;
}

}  // namespace

Posed resample(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
               const SkinWeights& weights, const Pose& pose, const Method& method, const ResampleSettings& settings,
               Progress& progress) {
  Posed one;
  resample_sequence(
      volume, tissues, armature, weights, {pose}, method, settings,
      [&](std::size_t, Posed posed) { one = std::move(posed); }, progress);
  return one;
}

void resample_sequence(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                       const SkinWeights& weights, const std::vector<Pose>& poses, const Method& method,
                       const ResampleSettings& settings,
                       const std::function<void(std::size_t place, Posed posed)>& on_posed, Progress& progress) {
  check_baked(method, settings.baked);
  const Seconds preparing;
  const RigidBody body(volume, tissues, armature, weights, settings.seams, progress);
  const double prepared = preparing();
  std::optional<FemSequence> shapes;
  if (const Fem* fem = std::get_if<Fem>(&method))
    shapes.emplace(volume, body.tissue, tissues, body.labels.bone, body.weights, armature, poses, *fem, progress);
  for (std::size_t place = 0; place < poses.size(); ++place) {
    Posed posed =
        resample_body(body, poses[place], shapes ? shapes->next(progress) : nullptr, method, settings, progress);
    if (place == 0) posed.report.seconds_deform += prepared;
    on_posed(place, std::move(posed));
  }
}

}  // namespace limber
