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

// Margins around the tissue that bends by its weights, mm: skin creases further out than weights blend.
constexpr double kMargin = 24;
// The same around tissue that the pose brings into contact: pressed flesh gives way less far than a crease reaches.
constexpr double kGive = 16;
constexpr double kRim = 2.5;  // width of the rim of held nodes, in tets: at least two whole layers
constexpr double kJoint = 2;  // layers of tets that share the sliding of two bones
// Largest distance of a bone's node from its bone, mm. Coarse tets, whose bones are rough, are allowed more.
constexpr double kDrift = 2;
constexpr double kContact = 1.4;  // distance below which skin is pushed apart, mm; smaller where tets are small
constexpr double kTouches = 1.5;  // multiple of the contact distance below which reports count a node as touching
constexpr double kBent = 0.9997;  // cosine of half an angle of 3 degrees

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double tet_spacing(const Fem& fem) {
  if (fem.spacing_mm) return *fem.spacing_mm;
  return fem.quality == FemQuality::Draft ? 12 : 8;
}

// Returns the joints that turn in any of the poses; the mesh of fine quality has smaller tets around them.
std::vector<glm::dvec3> bent_joints(const Armature& armature, const std::vector<Pose>& poses) {
  std::vector<glm::dvec3> joints;
  for (size_t b = 0; b < armature.bones.size(); ++b)
    if (armature.bones[b].parent >= 0 &&
        std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) { return std::abs(pose.rotation[b].w) < kBent; }))
      joints.push_back(armature.bones[b].head);
  return joints;
}

// Returns the path from rest through all poses; each pose gets an equal share of [0, 1].
BonePath way_through(const std::vector<Pose>& poses, const SkinWeights& weights, const Armature& armature) {
  return [&](double t) {
    const double place = t * double(poses.size());
    const auto leg = std::min(std::size_t(place), poses.size() - 1);
    return bone_motions(weights.bones(), armature,
                        pose_between(leg ? poses[leg - 1] : rest_pose(armature), poses[leg], place - double(leg)));
  };
}

// Returns the points of way_through that moving_tissue examines: four on the first leg, which may be long, and two on
// each later leg.
std::vector<double> places_of(std::size_t poses) {
  std::vector<double> places;
  for (int k = 1; k <= 4; ++k) places.push_back(0.25 * k / double(poses));
  for (std::size_t leg = 1; leg < poses; ++leg)
    for (int k = 1; k <= 2; ++k) places.push_back((double(leg) + 0.5 * k) / double(poses));
  return places;
}

// Returns the nodes that wait on one of several legs of the path, with `until` converted to that leg.
std::vector<FemModel::Waiting> on_leg(std::vector<FemModel::Waiting> waiting, std::size_t leg, std::size_t legs) {
  for (FemModel::Waiting& each : waiting) each.until = each.until * double(legs) - double(leg);
  std::erase_if(waiting, [](const FemModel::Waiting& each) { return each.until <= 0; });
  return waiting;
}

// Fills the mesh report of a solved shape.
//   spacing  edge length of the tets, mm       contact_mm  distance below which skin is pushed apart
void measure(const SolvedPose& solved, double spacing, double contact_mm, FemShape& shape) {
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
  if (const auto gap = contact_gap(mesh.V, solved.V, border, spacing, kTouches * contact_mm)) {
    report.min_gap_mm = gap->smallest_mm;
    report.median_gap_mm = gap->median_mm;
    report.contact_nodes = gap->nodes;
  }
  report.volume_change_percent = volume_change_percent(shape.model, solved.V);
  report.stretch = stretches(shape.model, solved.V);
}

SolveReport report_of(const SolvedPose& solved) {
  return {.converged = solved.converged,
          .reached = solved.reached,
          .blocked_by = solved.blocked_by,
          .steps = solved.steps,
          .iterations = solved.iterations,
          .factorizations = solved.factorizations,
          .analyses = solved.analyses,
          .residual_mm = solved.residual,
          .bone_drift_mm = solved.bone_drift_mm};
}

}  // namespace

std::shared_ptr<const FemShape> solve_shape(const LabelVolume& volume, const TissueVoxels& tissue,
                                            const TissueTable& tissues, const LabelSet& is_bone,
                                            const SkinWeights& weights, const Armature& armature, const Pose& pose,
                                            const Fem& fem, Progress& progress) {
  return FemSequence(volume, tissue, tissues, is_bone, weights, armature, {pose}, fem, progress).next(progress);
}

FemSequence::FemSequence(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const LabelSet& is_bone, const SkinWeights& weights, const Armature& armature,
                         std::vector<Pose> poses, Fem fem, Progress& progress)
    : weights_(weights),
      armature_(armature),
      is_bone_(is_bone),
      poses_(std::move(poses)),
      fem_(std::move(fem)),
      spacing_(tet_spacing(fem_)) {
  const auto meshing = std::chrono::steady_clock::now();
  DeformingRegion& moving = last_.moving;
  moving = moving_tissue(volume, tissue, weights, way_through(poses_, weights, armature),
                         {.margin_mm = kMargin + spacing_,
                          .rim_mm = kRim * spacing_,
                          .contact = fem_.contact,
                          .near_mm = 2 * spacing_,
                          .give_mm = kGive + spacing_,
                          .places = places_of(poses_.size())},
                         progress);
  last_.pose = rest_pose(armature);
  if (moving.empty()) return;

  const LabelVolume regions = regions_to_mesh(volume, tissue, is_bone, weights, moving);
  MeshSettings settings{.spacing_mm = spacing_, .mesher = fem_.mesher};
  if (fem_.quality == FemQuality::Fine) settings.fine_around = bent_joints(armature, poses_);
  finest_ = settings.fine_around.empty() ? spacing_ : spacing_ / 2;
  TissueMesh meshed = mesh_tissue(regions, settings, progress);
  last_.mesh.fallback = meshed.warning;
  last_.model =
      tissue_model(volume, tissue, tissues, weights, moving, std::move(meshed.mesh), {.joint_mm = kJoint * spacing_});
  waiting_ = last_.model.fem.waiting;
  last_.V = last_.model.fem.mesh.V;
  last_.seconds_mesh = seconds_since(meshing);
  if (fem_.on_mesh) fem_.on_mesh(last_.model);
}

std::shared_ptr<const FemShape> FemSequence::next(Progress& progress) {
  const Pose from = last_.pose, to = poses_.at(solved_);
  last_.model.fem.waiting = on_leg(waiting_, solved_++, poses_.size());
  if (last_.moving.empty()) return nullptr;
  const auto solving = std::chrono::steady_clock::now();
  const BonePath path = [&](double t) { return bone_motions(weights_.bones(), armature_, pose_between(from, to, t)); };
  const SolveSettings settings{.contact = fem_.contact,
                               .contact_mm = std::min(kContact, finest_ / 4),
                               .step_tolerance_mm = finest_ / 2,
                               .bone_drift_mm = std::max(kDrift, spacing_ / 2)};
  const SolvedPose solved =
      solve_pose(last_.model.fem, path, largest_angle_degrees(from, to), settings, progress, fem_.on_step, &last_.V);
  if (solved.steps == 0 && solved.converged && largest_angle_degrees(to) > 0)  // no node is held by a moving bone
    throw Error("no bone that moves is as large as the mesh's tets, so nothing would follow it", "finite elements",
                "choose a finer quality, or blend instead");
  const bool ends = solved_ == poses_.size();
  auto shape = std::make_shared<FemShape>(ends ? std::move(last_) : FemShape(last_));
  shape->V = solved.V;
  shape->reached = solved.reached;
  shape->pose = pose_between(from, to, solved.reached);
  shape->cpu = solved.seconds;
  shape->solve = report_of(solved);
  shape->mesh = {.fallback = shape->mesh.fallback};
  measure(solved, spacing_, settings.contact_mm, *shape);
  std::erase_if(shape->mesh.stretch, [&](const auto& tissue) {
    return is_bone_[tissue.first] != 0;
  });  // bone is painted rigidly, whatever tets it lies in
  shape->seconds_solve = seconds_since(solving);
  if (ends) return shape;
  if (shape->reached < 1) waiting_.clear();  // the next leg starts elsewhere, so the waiting times are not valid
  last_.V = shape->V;
  last_.pose = shape->pose;
  last_.seconds_mesh = 0;  // only the first shape reports the time for meshing
  return shape;
}

}  // namespace limber
