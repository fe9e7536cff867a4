// SPDX-License-Identifier: AGPL-3.0-or-later
// limber resample VOLUME --rig RIG [--tissues T] [--bones L,L] [--weights W] POSE-OPTIONS --method lbs|dqs [--fit-joints]
//        -o OUT [--report R.json] [--spacing MM] [--nearest] [--with GREY=OUT2] [--field OUT.nrrd] [--jacobian OUT.nrrd]
//        [--threads N] [--progress json]
#include "core/resample/resample.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "core/base/parallel.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/pose_options.h"
#include "core/report/report.h"
#include "core/rig/bone_parts.h"
#include "core/rig/fit_joint.h"
#include "core/skin/heat_diffusion.h"
#include "core/skin/weights_io.h"

namespace limber::cmd {

namespace {

struct Options {
  BodyOptions body;
  PoseOptions pose;
  RunOptions run;
  std::string weights, method, output, report, grey, field, jacobian;
  std::optional<double> spacing;
  bool nearest = false, fit_joints = false;
};

// GREY=OUT2
struct GreyPaths {
  std::string from, to;
};
GreyPaths grey_paths(const std::string& request) {
  const size_t equals = request.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == request.size())
    throw Error("this is no grey volume and output", "--with " + request, "write GREY=OUT, as in --with ct.nii.gz=posed-ct.nii.gz");
  return {request.substr(0, equals), request.substr(equals + 1)};
}

// Before anything is computed.
void check_outputs(const Options& options) {
  check_writable(options.output);
  std::vector<std::string> outputs = {options.output, options.field, options.jacobian};
  if (!options.grey.empty()) outputs.push_back(grey_paths(options.grey).to);
  for (const std::string& volume : outputs)
    if (!volume.empty()) check_writable(volume);
  if (!options.report.empty()) check_place(options.report);
  outputs.push_back(options.report);
  check_distinct(outputs);
}

// Kept for the report, and shown at once.
void note(Report& report, const std::vector<std::string>& warnings) {
  warn(warnings);
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
}

SkinWeights weights_of(const Body& body, const TissueVoxels& tissue, const BoneParts& parts, const Options& options,
                       Report& report, Progress& progress) {
  if (!options.weights.empty()) {
    WeightsFile file = read_weights(options.weights, body.file.volume, tissue, body.rig);
    note(report, file.warnings);
    return std::move(file.weights);
  }
  WeightsReport heat;
  SkinWeights weights = diffuse_heat(body.file.volume, tissue, body.tissues, body.rig, parts, {}, progress, &heat);
  note(report, heat.warnings);
  return weights;
}

Method method_of(const std::string& name) {
  if (name == "dqs") return DualQuaternion{};
  return LinearBlend{};
}

// Takes away what was written when something later fails.
class Outputs {
 public:
  ~Outputs() {
    std::error_code ignored;
    if (!complete_)
      for (const Path& path : written_) std::filesystem::remove(path, ignored);
  }
  template <class Write>
  void write(const std::string& path, const Write& write) {
    if (path.empty()) return;
    const bool is_new = !std::filesystem::exists(path);
    write();
    if (is_new) written_.push_back(path);
  }
  void complete() { complete_ = true; }

 private:
  std::vector<Path> written_;
  bool complete_ = false;
};

void describe(Report& report, const Options& options, const Armature& rig, const Pose& pose) {
  report.method = options.method;
  auto& settings = report.settings;
  settings["method"] = options.method;
  settings["nearest"] = options.nearest;
  settings["fit_joints"] = options.fit_joints;
  if (options.spacing) settings["spacing_mm"] = *options.spacing;
  if (!options.pose.flex.empty()) settings["flex"] = options.pose.flex;
  if (!options.pose.motion.empty()) settings["frame"] = std::int64_t{options.pose.frame.value_or(0)};
  if (options.pose.up != "y") settings["up"] = options.pose.up;
  std::vector<std::string> turned;
  for (size_t b = 0; b < rig.bones.size(); ++b)
    if (pose.rotation[b] != glm::dquat(1, 0, 0, 0)) turned.push_back(rig.bones[b].name);
  settings["turned_bones"] = turned;
  for (const std::string& path : {options.body.volume, options.body.rig, options.body.tissues, options.weights, options.pose.pose,
                                  options.pose.motion, options.pose.map})
    if (!path.empty()) report.inputs.push_back(describe_input(path));
}

void write_outputs(const Options& options, const Body& body, Posed& posed, Outputs& outputs) {
  outputs.write(options.output, [&] { write_volume(posed.volume, options.output, body.tissues, body.file.type); });
  outputs.write(options.field, [&] { write_vector_volume(posed.volume.grid, posed.displacement, options.field); });
  outputs.write(options.jacobian, [&] { write_scalar_volume(posed.volume.grid, posed.jacobian, options.jacobian); });
  if (options.grey.empty()) return;
  const std::string to = grey_paths(options.grey).to;
  outputs.write(to, [&] { write_grey_volume(posed.grey, to); });
}

void note_bone_overlap(Report& report, std::int64_t voxels, bool joints_fitted) {
  if (voxels == 0) return;
  note(report, {joints_fitted ? std::to_string(voxels) + " voxels are still claimed by two bones"
                              : std::to_string(voxels) + " voxels are claimed by two bones: the rig's joint is not the anatomical one: "
                                                         "add --fit-joints"});
}

void run(const Options& options) {
  const Stopwatch total;
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  check_outputs(options);
  Report report;

  const Stopwatch reading;
  Body body = read_body(options.body, progress);
  Pose pose = read_pose_options(options.pose, body.rig);
  std::optional<GreyVolume> grey;
  if (!options.grey.empty()) grey = read_grey_volume(grey_paths(options.grey).from, progress);
  report.seconds.read = reading.seconds();

  const Stopwatch weighting;
  const TissueVoxels tissue(body.file.volume);
  BoneParts parts;
  if (options.weights.empty() || options.fit_joints) parts = split_bones(body.file.volume, tissue, body.tissues, body.rig, progress);
  const SkinWeights weights = weights_of(body, tissue, parts, options, report, progress);
  if (options.fit_joints) {
    FittedPose fitted = fit_joints(body.file.volume, tissue, parts, body.rig, pose, progress);
    note(report, fitted.warnings);
    body.rig = std::move(fitted.armature);
    pose = std::move(fitted.pose);
  }
  report.seconds.weights = weighting.seconds();

  const ResampleSettings settings{.nearest = options.nearest, .spacing = options.spacing,
                                  .displacement = !options.field.empty(), .jacobian = !options.jacobian.empty(),
                                  .grey = grey ? &*grey : nullptr};
  Posed posed = resample(body.file.volume, body.tissues, body.rig, weights, pose, method_of(options.method), settings, progress);
  report.seconds.deform = posed.report.seconds_deform;
  report.seconds.rasterize = posed.report.seconds_rasterize;
  note_bone_overlap(report, posed.report.bone_overlap_voxels, options.fit_joints);

  Outputs outputs;
  const Stopwatch writing;
  write_outputs(options, body, posed, outputs);
  report.seconds.write = writing.seconds();
  if (!options.report.empty()) {
    const Stopwatch comparing;
    report.metrics = compare(body.file.volume, posed.volume, body.tissues);
    describe(report, options, body.rig, pose);
    report.deform = std::move(posed.report);
    report.seconds.report = comparing.seconds();
    report.seconds.total = total.seconds();
    outputs.write(options.report, [&] { write_report(report, options.report); });
    print_report(std::cout, report);
  }
  outputs.complete();
}

}  // namespace

void add_resample(CLI::App& app) {
  auto* command = app.add_subcommand("resample", "a posed label volume");
  auto options = std::make_shared<Options>();
  add_body_options(*command, options->body);
  command->add_option("--weights", options->weights, "W.nrrd (default: heat diffusion)");
  add_pose_options(*command, options->pose);
  command->add_option("--method", options->method, "lbs (linear) or dqs (dual quaternions)")->required()->check(CLI::IsMember({"lbs", "dqs"}));
  command->add_flag("--fit-joints", options->fit_joints, "first move each bent joint so that its bones do not collide");
  command->add_option("-o,--output", options->output, "the posed volume")->required();
  command->add_option("--report", options->report, "what changed: JSON there, a table on stdout");
  command->add_option("--spacing", options->spacing, "of the output, mm (default: as the input)")->check(CLI::Range(1e-9, 1e6));
  command->add_flag("--nearest", options->nearest, "labels of the nearest rest voxel");
  command->add_option("--with", options->grey, "a grey volume moved by the same map")->type_name("GREY=OUT");
  command->add_option("--field", options->field, "displacement at each posed voxel, mm");
  command->add_option("--jacobian", options->jacobian, "volume ratio at each posed voxel");
  add_run_options(*command, options->run);
  command->callback([options] { run(*options); });
}

}  // namespace limber::cmd
