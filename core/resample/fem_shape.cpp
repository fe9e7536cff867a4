// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/fem_shape.h"

#include <algorithm>
#include <chrono>

#include "core/base/error.h"
#include "core/fem/contact_gap.h"
#include "core/mesh/crossings.h"
#include "core/mesh/mesh_tissue.h"
#include "core/resample/pose_path.h"

namespace limber {

namespace {

constexpr double kMargin = 24;  // mm around what bends by its weights: skin creases wider than weights blend
constexpr double kRim = 2.5;    // tets: two layers whole, whatever cells the tissue's border cuts
constexpr double kJoint = 2;    // tets: so many layers share the sliding of two bones
constexpr double kDrift = 2;    // mm that a bone may give way at a node, more where tets are so coarse that bones are rough
constexpr double kContact = 2;  // mm from which skin is pushed apart; less where tets are small
constexpr double kBent = 0.9997;  // cosine of half an angle of 3 degrees

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double tet_spacing(const Fem& fem) {
  if (fem.spacing_mm) return *fem.spacing_mm;
  return fem.quality == FemQuality::Draft ? 12 : 8;
}

// The joints that turn, where the mesh of best quality is finer.
std::vector<glm::dvec3> bent_joints(const Armature& armature, const Pose& pose) {
  std::vector<glm::dvec3> joints;
  for (size_t b = 0; b < armature.bones.size(); ++b)
    if (armature.bones[b].parent >= 0 && std::abs(pose.rotation[b].w) < kBent) joints.push_back(armature.bones[b].head);
  return joints;
}

//   spacing  of the mesh, mm
void measure(const SolvedPose& solved, double spacing, FemShape& shape) {
  const TetMesh& mesh = shape.model.fem.mesh;
  const std::vector<double> ratios = volume_ratios(mesh, solved.V);
  MeshReport& report = shape.mesh;
  report.tets = mesh.T.rows();
  report.nodes = mesh.V.rows();
  report.inverted = solved.inverted;
  std::int64_t soft = 0, pressed = 0;
  for (size_t t = 0; t < ratios.size(); ++t) {
    report.joint_tets += shape.model.joint[t];
    if (shape.model.joint[t] || mesh.region[t] != TetMesh::kSoft) continue;
    ++soft;
    pressed += ratios[t] < 0.2;
    report.min_det_f = soft == 1 ? ratios[t] : std::min(report.min_det_f, ratios[t]);
  }
  if (soft > 0) report.share_below_fifth = double(pressed) / double(soft);
  const Eigen::MatrixX3i border = boundary_of(mesh.T);
  report.self_intersections = std::ssize(crossing_pairs(solved.V, border));
  if (const auto gap = contact_gap(mesh.V, solved.V, border, 3 * spacing, spacing)) {
    report.min_gap_mm = gap->smallest_mm;
    report.median_gap_mm = gap->median_mm;
  }
  report.volume_change_percent = volume_change_percent(shape.model, solved.V);
  report.stretch = stretches(shape.model, solved.V);
}

SolveReport report_of(const SolvedPose& solved) {
  return {.converged = solved.converged, .reached = solved.reached, .blocked_by = solved.blocked_by, .steps = solved.steps,
          .iterations = solved.iterations, .factorizations = solved.factorizations, .residual_mm = solved.residual, .bone_drift_mm = solved.bone_drift_mm};
}

}  // namespace

std::shared_ptr<const FemShape> solve_shape(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues, const LabelSet& is_bone,
                                            const SkinWeights& weights, const Armature& armature, const Pose& pose, const Fem& fem,
                                            Progress& progress) {
  const auto meshing = std::chrono::steady_clock::now();
  const double spacing = tet_spacing(fem);
  const BonePath path = [&](double t) { return bone_motions(weights.bones(), armature, part_of_pose(pose, t)); };
  auto shape = std::make_shared<FemShape>();
  shape->moving = moving_tissue(volume, tissue, weights, path,
                                {.margin_mm = kMargin + spacing, .rim_mm = kRim * spacing, .contact = fem.contact, .near_mm = 2 * spacing}, progress);
  if (shape->moving.empty()) return nullptr;

  const LabelVolume regions = regions_to_mesh(volume, tissue, is_bone, weights, shape->moving);
  MeshSettings settings{.spacing_mm = spacing};
  if (fem.quality == FemQuality::Fine) settings.fine_around = bent_joints(armature, pose);
  TissueMesh meshed = mesh_tissue(regions, settings, progress);
  shape->mesh.fallback = meshed.warning;
  shape->model = tissue_model(volume, tissue, tissues, weights, shape->moving, std::move(meshed.mesh), {.joint_mm = kJoint * spacing});
  shape->seconds_mesh = seconds_since(meshing);
  if (fem.on_mesh) fem.on_mesh(shape->model);

  const auto solving = std::chrono::steady_clock::now();
  const double finest = settings.fine_around.empty() ? spacing : spacing / 2;
  const SolveSettings solve{.contact = fem.contact, .contact_mm = std::min(kContact, finest / 4), .step_tolerance_mm = finest / 2, .bone_drift_mm = std::max(kDrift, spacing / 2)};
  const SolvedPose solved = solve_pose(shape->model.fem, path, largest_angle_degrees(pose), solve, progress, fem.on_step);
  if (solved.steps == 0 && solved.converged)  // something should have moved
    throw Error("no bone that moves is as large as the mesh's tets, so nothing would follow it", "finite elements", "choose a finer quality, or blend instead");
  shape->V = solved.V;
  shape->reached = solved.reached;
  shape->cpu = solved.seconds;
  shape->solve = report_of(solved);
  measure(solved, spacing, *shape);
  std::erase_if(shape->mesh.stretch, [&](const auto& tissue) { return is_bone[tissue.first] != 0; });  // painted rigidly, whatever tets it lies in
  shape->seconds_solve = seconds_since(solving);
  return shape;
}

}  // namespace limber
