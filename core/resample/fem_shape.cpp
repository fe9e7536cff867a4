// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/fem_shape.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <new>
#include <utility>

#include "core/base/error.h"
#include "core/fem/contact_gap.h"
#include "core/fem/seam_sides.h"
#include "core/mesh/crossings.h"
#include "core/mesh/mesh_tissue.h"
#include "core/resample/limb_thickness.h"
#include "core/resample/pose_path.h"

namespace limber {

namespace {

// Thickness in mm of an adult's elbow, for which the lengths below were chosen. These lengths are multiplied by
// (thickness of the thinnest limb that the pose bends) / kThickness, so that bodies of any size are posed alike.
constexpr double kThickness = 93;
// Edge length in mm of the tets in an adult's elbow, for draft and for normal quality: 8 and 12 tets across the elbow.
constexpr double kDraft = 12, kUsual = 8;
// Upper limit on the volume to mesh, in cubes with the tets' edge length. A seated adult at kUsual needs about this
// many; for draft quality the limit is lower. A pose that bends both fingers and hips would exceed the limit, so its
// tets are made larger than requested.
constexpr double kMostCells = 40'000;
// Width of the margin that is meshed around tissue whose weights blend several bones, mm. It is needed because skin
// creases also beyond that tissue.
constexpr double kMargin = 24;
// Width of the margin that is meshed around tissue that the pose brings into contact, mm. It is smaller than kMargin,
// because pressed flesh deforms less far out than a crease.
constexpr double kGive = 16;
// The next three lengths are multiples of Fem::reach_mm, so that smaller tets solve the same problem more accurately.
// Width of the rim around the tissue that may deform: at least two layers of tets. The nodes of the rim move rigidly
// with a bone.
constexpr double kRim = 2.5;
// Distance from another bone below which the end of a bone is part of a joint and may slide, as a multiple of
// Fem::reach_mm.
constexpr double kJoint = 2;
// Distance between two bones in a pose below which both are part of a joint at this place, as a multiple of
// Fem::reach_mm.
constexpr double kClosing = 1;
// If a bone's node is further than this from its exact position, mm, a step of the solve fails. For coarse tets the
// limit is larger, because they follow a bone's shape only roughly.
constexpr double kDrift = 2;
// Gravity is applied little by little, over as many steps of the solve as a rotation of a joint by this angle takes,
// degrees.
constexpr double kSagging = 45;
constexpr double kContact = 1.4;  // distance below which skin is pushed apart, mm; for small tets it is smaller
// If the tets are larger than the thinnest bent limb requires, the contact distance grows with them, but at most to
// this multiple of the distance for that limb, because every pair of skin parts within the distance takes memory.
constexpr double kWiderContact = 1.5;
constexpr double kTouches = 1.5;  // multiple of the contact distance below which reports count a node as touching
// Cosine of half of 3 degrees. With fine quality, tets are smaller around joints that turn by more than 3 degrees.
constexpr double kBent = 0.9997;
constexpr double kExact = 0.1;  // with Fem::is_exact, the tolerance of the last solve is multiplied by this

// Near a bent joint soft tissue covers bone in the mesh, so that the tips of bones that bending pushes out do not lie
// at the skin. The covered distance from the joint, as a share of the distance up to which tissue slides.
constexpr double kCovered = 0.5;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Returns the positions at rest of the joints that turn by more than a given angle in at least one pose.
//   cosine  the cosine of half the angle
std::vector<glm::dvec3> bent_joints(const Armature& armature, const std::vector<Pose>& poses, double cosine) {
  std::vector<glm::dvec3> joints;
  for (size_t b = 0; b < armature.bones.size(); ++b)
    if (armature.bones[b].parent >= 0 && std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
          return std::abs(pose.rotation[b].w) < cosine;
        }))
      joints.push_back(armature.bones[b].head);
  return joints;
}

// Returns the thickness of the thinnest limb at these joints as a multiple of kThickness. Joints outside all tissue are
// left out; if no joint remains, the result is 1.
double limb_size(const TissueVoxels& tissue, const Grid& grid, const std::vector<glm::dvec3>& joints) {
  const TissueDepth depth(tissue, grid.spacing);
  std::optional<double> thinnest;
  for (const glm::dvec3& joint : joints)
    if (const auto thickness = limb_thickness(depth, grid, joint))
      thinnest = std::min(thinnest.value_or(INFINITY), *thickness);
  return thinnest.value_or(kThickness) / kThickness;
}

// Returns the edge length of tets in mm. No tet is smaller than a voxel, since voxels show no smaller detail.
double spacing_of(FemQuality quality, double size, const Grid& grid) {
  const double voxel = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  return std::max(size * (quality == FemQuality::Draft ? kDraft : kUsual),
                  quality == FemQuality::Fine ? 2 * voxel : voxel);
}

// Returns the joints near which tissue slides, and how far from each: as far as the limb is thick there.
std::vector<SlidingSettings::Near> sliding_near(const TissueVoxels& tissue, const Grid& grid,
                                                const std::vector<glm::dvec3>& joints) {
  const TissueDepth depth(tissue, grid.spacing);
  std::vector<SlidingSettings::Near> near;
  for (const glm::dvec3& joint : joints)
    if (const auto thickness = limb_thickness(depth, grid, joint)) near.push_back({joint, *thickness});
  return near;
}

std::int64_t count_voxels(const TissueMask& mask) {
  std::int64_t count = 0;
  for (const auto& brick : mask)
    for (const std::uint64_t layer : brick) count += std::popcount(layer);
  return count;
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

// Returns the points of the path, [0, 1], at which moving_tissue examines the body: four on the way to the first pose,
// which may be long, and two on the way to each later pose.
std::vector<double> places_of(std::size_t poses) {
  std::vector<double> places;
  for (int k = 1; k <= 4; ++k) places.push_back(0.25 * k / double(poses));
  for (std::size_t leg = 1; leg < poses; ++leg)
    for (int k = 1; k <= 2; ++k) places.push_back((double(leg) + 0.5 * k) / double(poses));
  return places;
}

// Returns the points of the path, [0, 1], at which the poses are reached.
std::vector<double> ends_of(std::size_t poses) {
  std::vector<double> ends;
  for (std::size_t k = 1; k <= poses; ++k) ends.push_back(double(k) / double(poses));
  return ends;
}

// Returns the nodes that still wait to become free on one leg of the path (the way from one pose to the next). Their
// path position `until` is converted from a position on the whole path to a position on that leg.
std::vector<FemModel::Waiting> on_leg(std::vector<FemModel::Waiting> waiting, std::size_t leg, std::size_t legs) {
  for (FemModel::Waiting& each : waiting) each.until = each.until * double(legs) - double(leg);
  std::erase_if(waiting, [](const FemModel::Waiting& each) { return each.until <= 0; });
  return waiting;
}

// Fills the mesh report of a solved shape.
//   spacing     edge length of the tets, mm
//   contact_mm  distance below which contact pushes skin apart
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
  const Eigen::MatrixX3i border = boundary_of(mesh);
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
          .repeated_in_double = solved.repeated_in_double,
          .analyses = solved.analyses,
          .residual_mm = solved.residual,
          .bone_drift_mm = solved.bone_drift_mm,
          .largest_slide_mm = solved.slide.along,
          .largest_slide_gap_mm = solved.slide.off};
}

// Shows the progress of the second solve as "error estimate".
class ForEstimate : public Progress {
 public:
  explicit ForEstimate(Progress& whole) : whole_(whole) {}
  bool cancelled() const override { return whole_.cancelled(); }

 private:
  void on_update(std::string_view, double fraction) override { whole_.update("error estimate", fraction); }
  Progress& whole_;
};

// Runs a step of the second solve. Returns why it failed, or an empty string. A failure leaves the first solve's result
// valid.
template <class Step>
std::string why_it_failed(const Step& step) {
  try {
    step();
    return "";
  } catch (const Error& error) {
    return std::string("the second solve, with larger tets, failed: ") + error.what();
  } catch (const std::bad_alloc&) {
    return "there was not enough memory for the second solve";
  }
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
      objects_(fem_.objects),
      grid_(volume.grid) {
  const auto meshing = std::chrono::steady_clock::now();
  last_.pose = rest_pose(armature);
  size_ = limb_size(tissue, volume.grid, bent_joints(armature, poses_, 1));
  DeformingRegion& moving = last_.moving;
  const double asked = fem_.spacing_mm.value_or(spacing_of(fem_.quality, size_, volume.grid));
  const BonePath way = way_through(poses_, weights, armature);
  const auto find_moving = [&](double spacing) {
    spacing_ = spacing;
    reach_ = fem_.reach_mm.value_or(std::max(spacing, size_ * kUsual));
    moving = moving_tissue(volume, tissue, weights, way,
                           {.margin_mm = size_ * kMargin + reach_,
                            .rim_mm = kRim * reach_,
                            .contact = fem_.contact,
                            .near_mm = 2 * reach_,
                            .give_mm = size_ * kGive + reach_,
                            .places = places_of(poses_.size()),
                            .sweeps = objects_.sweeps(spacing),
                            .pressed_at = ends_of(poses_.size())},
                           progress);
  };
  find_moving(asked);
  objects_.choose(moving.clearances);
  if (moving.empty()) return;
  const double cells = double(count_voxels(moving.meshed)) * volume.grid.voxel_volume() / std::pow(asked, 3);
  const double most = kMostCells * (fem_.quality == FemQuality::Draft ? std::pow(kUsual / kDraft, 3) : 1);
  if (!fem_.spacing_mm && cells > most) {
    find_moving(asked * std::cbrt(cells / most));
    objects_.choose(moving.clearances);
    char note[160];
    std::snprintf(note, sizeof note,
                  "the pose bends limbs of very different thickness: tets of %.3g mm instead of %.3g mm", spacing_,
                  asked);
    last_.mesh.fallback = note;
  }

  const auto motions_on = [&](const BonePath& path) {
    std::vector<std::vector<RigidTransform>> motions;
    for (const double place : places_of(poses_.size())) motions.push_back(path(place));
    return motions;
  };
  MeshSettings settings{
      .spacing_mm = spacing_, .mesher = fem_.mesher, .fine_radius_mm = size_ * MeshSettings().fine_radius_mm};
  if (fem_.quality == FemQuality::Fine) settings.fine_around = bent_joints(armature, poses_, kBent);
  SlidingSettings sliding;
  if (fem_.slides) sliding.near = sliding_near(tissue, volume.grid, bent_joints(armature, poses_, kBent));
  for (const auto& [joint, mm] : sliding.near) settings.covered.push_back({joint, kCovered * mm});
  finest_ = settings.fine_around.empty() ? spacing_ : spacing_ / 2;
  // The size of the limb for which tets of this size are right. Differences due to rounding alone are ignored below.
  const double of_tets = reach_ / (fem_.quality == FemQuality::Draft ? kDraft : kUsual);
  solver_size_ = (!fem_.spacing_mm || fem_.reach_mm) && of_tets > 1.001 * size_ ? of_tets : size_;
  const auto sides =
      std::make_shared<VoxelSides>(sides_of_seams(volume, tissue, is_bone, weights, armature, moving.moves_as));
  if (sides->sides.seams) last_.sides = sides;
  TissueMesh meshed =
      mesh_tissue(regions_to_mesh(volume, tissue, is_bone, weights, moving, *sides), settings, progress, sides->sides);
  if (!meshed.warning.empty()) last_.mesh.fallback += (last_.mesh.fallback.empty() ? "" : "; ") + meshed.warning;
  sliding.tet_mm = finest_;
  last_.model = tissue_model(volume, tissue, tissues, weights, moving, std::move(meshed.mesh),
                             {.joint_mm = kJoint * reach_,
                              .motions = motions_on(way),
                              .closing_mm = kClosing * reach_,
                              .sliding = std::move(sliding),
                              .sides = last_.sides.get()});
  if (!fem_.is_exact) waiting_ = last_.model.fem.waiting;
  if (fem_.gravity != glm::dvec3(0)) last_.model.fem.mass = node_masses(last_.model, tissues);
  if (!objects_.empty()) {
    weight_n_ = weight_of(volume, tissue, tissues);
    objects_.add_to(last_.model.fem);
  }
  last_.V = last_.model.fem.mesh.V;
  if (fem_.on_mesh) fem_.on_mesh(last_.model);
  if (fem_.estimates_error) {
    Fem coarser = fem_;
    coarser.estimates_error = false;
    coarser.spacing_mm = kCoarser * spacing_;
    coarser.reach_mm = reach_;
    coarser.on_mesh = {}, coarser.on_step = {};
    ForEstimate estimate(progress);
    no_estimate_ = why_it_failed([&] {
      coarse_ = std::make_unique<FemSequence>(volume, tissue, tissues, is_bone, weights, armature, poses_,
                                              std::move(coarser), estimate);
    });
  }
  last_.seconds_mesh = seconds_since(meshing);
}

FemError FemSequence::error_of(const FemShape& shape, Progress& progress) {
  FemError error;
  if (coarse_ && no_estimate_.empty()) {
    ForEstimate estimate(progress);
    no_estimate_ = why_it_failed([&] {
      const std::shared_ptr<const FemShape> coarse = coarse_->next(estimate);
      if (coarse) error = estimated_error(shape, *coarse, grid_);
      else error.unknown = "the second solve, with larger tets, contains no bending tissue";
    });
  }
  if (!no_estimate_.empty()) error.unknown = no_estimate_;
  return error;
}

std::shared_ptr<const FemShape> FemSequence::next(Progress& progress) {
  const Pose from = last_.pose, to = poses_.at(solved_);
  last_.model.fem.waiting = on_leg(waiting_, solved_++, poses_.size());
  if (last_.moving.empty()) return nullptr;
  const auto solving = std::chrono::steady_clock::now();
  const BonePath path = [&](double t) { return bone_motions(weights_.bones(), armature_, pose_between(from, to, t)); };
  const SolveSettings settings{
      .contact = fem_.contact,
      .contact_mm = std::min({solver_size_ * kContact, kWiderContact * size_ * kContact, finest_ / 4}),
      .object_mm = std::min(solver_size_ * SolveSettings().object_mm, finest_ / 4),
      .gravity = {fem_.gravity.x, fem_.gravity.y, fem_.gravity.z},
      .has_weight_at_start = has_weight_,
      .step_tolerance_mm = finest_ / 2,
      .tolerance_mm = (fem_.is_exact ? kExact : 1) * solver_size_ * SolveSettings().tolerance_mm,
      .bone_drift_mm = std::max(solver_size_ * kDrift, spacing_ / 2),
      .size = solver_size_};
  double angle = largest_angle_degrees(from, to);
  if (fem_.gravity != glm::dvec3(0) && !has_weight_) angle = std::max(angle, kSagging);
  SolvedPose solved = solve_pose(last_.model.fem, path, angle, settings, progress, fem_.on_step, &last_.V);
  // If the pose bends joints but the solve took no step, no moving bone contains a node of the mesh.
  if (solved.steps == 0 && solved.converged && largest_angle_degrees(to) > 0)
    throw Error("every moving bone is smaller than the mesh's tets, so no tissue would follow it", "finite elements",
                "use a finer quality, or blending");
  has_weight_ = has_weight_ || solved.reached == 1;
  if (!objects_.empty() && !is_pressed_ && solved.reached < 1)
    solved.blocked_by += ", so the objects were not moved to the body";
  if (!objects_.empty() && !std::exchange(is_pressed_, is_pressed_ || solved.reached == 1) && solved.reached == 1)
    solved = objects_.press(last_.model.fem, path(1), std::move(solved), settings, spacing_, weight_n_, progress,
                            fem_.on_step);
  const bool ends = solved_ == poses_.size();
  auto shape = std::make_shared<FemShape>(ends ? std::move(last_) : FemShape(last_));
  shape->V = solved.V;
  if (!objects_.empty()) {
    shape->objects = objects_.report(shape->model.fem, solved);
    shape->pressed = objects_.pressed_nodes(shape->model.fem, solved);
  }
  shape->reached = solved.reached;
  shape->pose = pose_between(from, to, solved.reached);
  shape->cpu = solved.seconds;
  shape->solve = report_of(solved);
  shape->solve.sliding_nodes = std::ssize(shape->model.fem.sliding);
  shape->solve.parameters = {.tet_mm = spacing_,
                             .finest_tet_mm = finest_,
                             .step_degrees = settings.step_degrees,
                             .step_tolerance_mm = settings.step_tolerance_mm,
                             .tolerance_mm = settings.tolerance_mm,
                             .joint_mm = kJoint * reach_,
                             .contact_mm = fem_.contact ? std::optional(settings.contact_mm) : std::nullopt};
  shape->mesh = {.fallback = shape->mesh.fallback};
  measure(solved, spacing_, settings.contact_mm, *shape);
  std::erase_if(shape->mesh.stretch, [&](const auto& tissue) {
    return is_bone_[tissue.first] != 0;
  });  // bone tissue has no stretch: its voxels move rigidly, even inside tets that stretch
  if (fem_.estimates_error)
    shape->solve.error = ends && !solved.converged ? FemError{.unknown = "the solve did not reach the pose"}
                                                   : error_of(*shape, progress);
  shape->seconds_solve = seconds_since(solving);
  if (ends) return shape;
  // If the solve stopped early, the way to the next pose differs from the planned path, so the positions at which
  // waiting nodes become free are not valid. All nodes become free now.
  if (shape->reached < 1) waiting_.clear();
  last_.V = shape->V;
  last_.pose = shape->pose;
  last_.seconds_mesh = 0;  // only the first pose's report contains the time for meshing
  return shape;
}

}  // namespace limber
