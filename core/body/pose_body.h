// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses a bound body: fits and glides its joints, resamples it by any method, warns of what differs from the request,
// and measures and judges the result for its report.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/body/bind_body.h"
#include "core/body/body.h"
#include "core/fem/solve_pose.h"
#include "core/report/report.h"
#include "core/resample/deformation_method.h"
#include "core/resample/resample.h"

namespace limber {

struct PosingSettings {
  std::string method = deformation_methods().front().word;  // a word of deformation_methods()
  bool contact = false;            // fem: true: skin touches skin instead of passing through it
  std::string quality, mesher;     // fem: draft, normal or fine; lattice or tetgen. "": normal, lattice
  bool slides = false;             // fem: true: loose tissue slides over bone near bent joints
  bool estimates_error = false;    // fem: true: a second solve with larger tets estimates the error
  std::vector<FemObject> objects;  // fem: rigid objects that press on the body
  glm::dvec3 gravity{0};           // fem: acceleration of gravity, m/s2
  std::string glide = "joint";     // how far joints may glide: a word of glide_poses.h
  bool fit_joints = false;         // true: joint axes are first fitted to the bones around them; only for one pose
  ResampleSettings resample;       // settings of resampling; its seams are those of the bound body

  bool has_contact() const { return contact || !objects.empty(); }  // objects press only if contact is simulated
};

// Functions that are called during the work; each may be empty.
struct PosingEvents {
  std::function<void(const std::string&)> on_warning;
  std::function<void(const Armature& rig, const Pose& pose)> on_pose;  // called before each pose is computed
  std::function<void(const TissueModel&)> on_mesh;                     // fem: called before the first iteration
  std::function<void(const SolveStep&)> on_step;                       // fem: called after every iteration
};

// The body in one pose of a sequence.
struct BodyInPose {
  std::size_t index = 0;              // index of the pose in the sequence
  const Armature& rig;                // the body's rig; its joints are fitted to the pose if that was requested
  const Pose& pose;                   // the pose after joints were fitted and shifted
  std::vector<RigidTransform> asked;  // #bones: motions from rest to the requested pose, with the body's original rig
  const SkinWeights& weights;         // the weights of the bound body
  Posed posed;
  Report report;  // warnings, shifted joints and times; measure_posed_body() adds the rest
};

// Computes each pose of a sequence and calls on_posed for it. With finite elements, each solve starts from the shape
// that the previous solve reached. Throws Error for a bad setting, and as resample() does.
//   report  initial contents of the report of each pose
void pose_body(const Body& body, BoundBody& bound, std::vector<Pose> poses, const PosingSettings& settings,
               const Report& report, const PosingEvents& events, const std::function<void(BodyInPose&)>& on_posed,
               Progress& progress);

// Completes the report of a posed body: settings, joints that the pose turns, measures and quality gates. Call it once,
// when nothing else needs posed.posed.report: that part is moved into posed.report.
void measure_posed_body(const Body& body, const PosingSettings& settings, BodyInPose& posed);

}  // namespace limber
