// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/body/pose_body.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "core/autorig/joint_axis_fit.h"
#include "core/base/error.h"
#include "core/body/glide_poses.h"
#include "core/deform/bake_source.h"
#include "core/report/whole_bones.h"
#include "core/resample/fem_shape.h"
#include "core/resample/pose_path.h"
#include "core/resample/posed_voxels.h"

namespace limber {

namespace {

// Adds warnings to a report and immediately passes them to the caller as well.
class Warnings {
 public:
  Warnings(Report& report, const PosingEvents& events) : report_(report), events_(events) {}
  void note(const std::vector<std::string>& lines) const {
    for (const std::string& line : lines) {
      report_.warnings.push_back(line);
      if (events_.on_warning) events_.on_warning(line);
    }
  }

 private:
  Report& report_;
  const PosingEvents& events_;
};

// Warns the user if the mesh or the solve differs from the request.
void note_shape(const Warnings& warnings, const DeformReport& deform, const Pose& pose, bool contact) {
  if (deform.mesh && !deform.mesh->fallback.empty()) warnings.note({deform.mesh->fallback});
  if (deform.mesh && contact && deform.mesh->self_intersections.value_or(0) > 0)
    warnings.note(
        {std::to_string(*deform.mesh->self_intersections) + " pairs of triangles of the skin cross each other"});
  if (!deform.solve || deform.solve->converged) return;
  if (deform.solve->reached == 1)
    return warnings.note({"the pose is reached, but the solve has not converged: " + deform.solve->blocked_by});
  char share[64];
  std::snprintf(share, sizeof share, "%.0f %% (%.1f of %.1f degrees)", 100 * deform.solve->reached,
                deform.solve->reached * largest_angle_degrees(pose), largest_angle_degrees(pose));
  warnings.note({"the pose could not be reached: the result is the last pose on the way to it, " + std::string(share) +
                 (deform.solve->blocked_by.empty() ? "" : ": what stands in the way: " + deform.solve->blocked_by)});
}

// Warns of tissues with 5000 voxels or more whose mass still differs from its mass at rest by more than 0.1 %.
void note_masses(const Warnings& warnings, const MassExactReport& exact, const TissueTable& tissues) {
  for (const auto& [label, tissue] : exact.tissues) {
    if (tissue.wanted < 5000 || std::abs(tissue.after - tissue.wanted) * 1000 <= tissue.wanted) continue;
    const Tissue* known = tissues.find(label);
    warnings.note({(known ? known->name : "label " + std::to_string(label)) + " is " +
                   std::to_string(std::abs(tissue.after - tissue.wanted)) + " voxels " +
                   (tissue.after < tissue.wanted ? "short of" : "above") +
                   " its mass at rest: no border could move further"});
  }
}

// Warns of anatomical bones whose weights follow a wrong rig bone. The cause may be a weights file that is older than
// the rig or from another program.
void note_foreign_weights(const Warnings& warnings, const Body& body, const BoundBody& bound, const BodyInPose& posed) {
  const Pose& reached = posed.posed.shape ? posed.posed.shape->pose : posed.pose;
  const auto motions = bone_motions(bound.weights.bones(), posed.rig, reached);
  warnings.note(astray_bones(
      whole_bones(body.file.volume, bound.tissue, body.tissues, posed.rig, bound.weights, motions, body.bone_map)));
}

// Throws Error for a joint that was baked from another body.
void check_baked(const BakedJoints& baked, const Body& body, const BoundBody& bound) {
  if (baked.empty()) return;
  const BakeSource source =
      bake_source(body.file.volume, bound.tissue, LabelSets(body.tissues).bone, body.rig, bound.weights);
  for (const std::shared_ptr<const BakedJoint>& joint : baked) check_source(*joint, source);
}

Method method_of(const PosingSettings& settings, const PosingEvents& events) {
  const DeformationMethod* method = find_method(settings.method);
  if (!method) throw Error("there is no such method", settings.method, "write " + method_summaries(Methods::All));
  if (method->blend) return *method->blend;
  Fem fem;
  fem.contact = settings.has_contact();
  fem.slides = settings.slides;
  fem.estimates_error = settings.estimates_error;
  fem.objects = settings.objects;
  fem.gravity = settings.gravity;
  if (settings.quality == "draft") fem.quality = FemQuality::Draft;
  if (settings.quality == "fine") fem.quality = FemQuality::Fine;
  if (settings.mesher == "tetgen") fem.mesher = Mesher::tetgen;
  fem.on_mesh = events.on_mesh;
  fem.on_step = events.on_step;
  return fem;
}

void describe(const PosingSettings& asked, const Armature& rig, const Pose& pose, Report& report) {
  report.method = asked.method;
  auto& settings = report.settings;
  settings["method"] = asked.method;
  settings["nearest"] = asked.resample.nearest;
  settings["mass_exact"] = asked.resample.mass_exact;
  if (asked.resample.mass_exact) settings["mass_limit_percent"] = asked.resample.mass_limit_percent;
  settings["fit_joints"] = asked.fit_joints;
  settings["glide"] = asked.glide;
  if (asked.method == kFiniteElements) {
    settings["contact"] = asked.has_contact();
    settings["quality"] = asked.quality.empty() ? std::string("normal") : asked.quality;
    if (!asked.mesher.empty()) settings["mesher"] = asked.mesher;
  }
  if (asked.resample.spacing) settings["spacing_mm"] = *asked.resample.spacing;
  std::vector<std::string> turned;
  for (size_t b = 0; b < rig.bones.size(); ++b)
    if (pose.rotation[b] != glm::dquat(1, 0, 0, 0)) turned.push_back(rig.bones[b].name);
  settings["turned_bones"] = turned;
  report.joints = turned_joints(rig, pose);
}

// Completes the times of a report, and adds warnings where the result differs from the request.
void note_results(const Body& body, const BoundBody& bound, const PosingSettings& settings, const PosingEvents& events,
                  BodyInPose& posed) {
  const DeformReport& deform = posed.posed.report;
  StageSeconds& seconds = posed.report.seconds;
  seconds.mesh = deform.seconds_mesh;
  seconds.solve = deform.seconds_solve;
  seconds.deform = deform.seconds_deform;
  seconds.rasterize = deform.seconds_rasterize;
  const Warnings warnings(posed.report, events);
  if (const std::string overlap = overlap_warning(posed.report.glide, deform.bone_overlap_voxels); !overlap.empty())
    warnings.note({overlap});
  note_shape(warnings, deform, posed.pose, settings.has_contact());
  warnings.note(doubts_of_baked(deform.baked, settings.glide));
  for (const ObjectReport& object : deform.objects)
    if (object.crossings > 0)
      warnings.note({object.name + " crosses the skin in " + std::to_string(object.crossings) + " pairs of triangles"});
  if (settings.gravity != glm::dvec3(0) && !posed.posed.shape)
    warnings.note({"the pose bends nothing, so no flesh sags under gravity"});
  if (deform.mass_exact) note_masses(warnings, *deform.mass_exact, body.tissues);
  if (bound.is_from_file) note_foreign_weights(warnings, body, bound, posed);
}

}  // namespace

void pose_body(const Body& body, BoundBody& bound, std::vector<Pose> poses, const PosingSettings& settings,
               const Report& report, const PosingEvents& events, const std::function<void(BodyInPose&)>& on_posed,
               Progress& progress) {
  const LabelVolume& volume = body.file.volume;
  const Method method = method_of(settings, events);
  check_baked(settings.resample.baked, body, bound);
  if (settings.fit_joints && !settings.resample.baked.empty())
    throw Error("fitting joints moves the axis around which a joint was baked", "fit joints",
                "leave out the fitting or the baked joint, or bake the joint with the fitted rig");
  const glm::dvec3 voxel = volume.grid.spacing;
  const auto glide = glide_settings(settings.glide, std::max({voxel.x, voxel.y, voxel.z}), "glide " + settings.glide);
  Report base = report;
  Armature rig = body.rig;
  // The bones' motions in each requested pose, computed before fitting and gliding change poses and rig.
  std::vector<std::vector<RigidTransform>> asked;
  for (const Pose& pose : poses) asked.push_back(posed_from_rest(rig, pose));
  if (settings.fit_joints) {
    const Stopwatch fitting;
    FittedPose fitted = fit_joints(volume, bound.tissue, parts_of(body, bound, progress), rig, poses.at(0), progress);
    Warnings(base, events).note(fitted.warnings);
    rig = std::move(fitted.armature);
    poses[0] = std::move(fitted.pose);
    base.seconds.weights = base.seconds.weights.value_or(0) + fitting.seconds();
  }
  std::vector<std::vector<GlidedJoint>> glided;  // the shifted joints of each pose; empty if joints do not glide
  SkinWeights weights = bound.weights;
  if (glide) {
    const Stopwatch gliding;
    glided = glide_poses(poses, *glide, body, rig, bound.tissue, weights, progress);
    base.seconds.glide = gliding.seconds();
  }
  ResampleSettings resampling = settings.resample;
  resampling.seams = bound.tissue.shared_seams();
  if (events.on_pose) events.on_pose(rig, poses.at(0));
  resample_sequence(
      volume, body.tissues, rig, weights, poses, method, resampling,
      [&](std::size_t at, Posed result) {
        BodyInPose posed{at, rig, poses[at], asked[at], bound.weights, std::move(result), base};
        if (!glided.empty()) posed.report.glide = glided[at];
        note_results(body, bound, settings, events, posed);
        on_posed(posed);
        if (at + 1 < poses.size() && events.on_pose) events.on_pose(rig, poses[at + 1]);
      },
      progress);
}

void measure_posed_body(const Body& body, const PosingSettings& settings, BodyInPose& posed) {
  Report& report = posed.report;
  const Posed& result = posed.posed;
  const Stopwatch measuring;
  report.doubts = body.doubts;
  report.metrics = compare(body.file.volume, result.volume, body.tissues);
  const JudgedPose judged{body.file.volume,
                          result.volume,
                          body.tissues,
                          result.tiled_displacement.empty()
                              ? DisplacementView(result.displacement.data(), result.displacement.size())
                              : DisplacementView(result.tiled_displacement),
                          &posed.rig,
                          posed.asked,
                          posed_from_rest(posed.rig, result.shape ? result.shape->pose : posed.pose)};
  measure_body(judged, body.bone_map, report);
  report.deform = std::move(posed.posed.report);
  describe(settings, posed.rig, posed.pose, report);
  report.seconds.report = measuring.seconds();
  judge(report);
}

}  // namespace limber
