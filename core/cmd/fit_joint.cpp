// SPDX-License-Identifier: AGPL-3.0-or-later
// limber fit-joint VOLUME --rig RIG --bone B [--tissues T] [--bones L,L] [--range 0,90] -o RIG2: moves the axis of a
//   joint so that its bones do not collide over a range of angles, in degrees.
#include "core/autorig/joint_axis_fit.h"

#include <cstdio>
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/rig_io/rig_io.h"

namespace limber::cmd {

namespace {
struct FitJointOptions {
  BodyOptions body;
  std::string bone, output;
  std::vector<double> range{0, 90};
  RunOptions run;
};

void run_fit_joint(const FitJointOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);

  check_armature_writable(options.output);
  const Body body = read_body(options.body, progress);
  const LabelVolume& volume = body.file.volume;
  const int bone = require_bone(body.rig, options.bone);

  const TissueVoxels tissue(volume);
  const BoneParts parts = split_bones(volume, tissue, body.tissues, body.rig, progress, body.bone_map);
  const FitJoint settings{.minimum_degrees = options.range[0], .maximum_degrees = options.range[1]};
  const FittedJoint fitted = fit_joint(volume, tissue, parts, body.rig, bone, settings, progress);
  write_armature(fitted.armature, options.output);

  print("%s from %g to %g degrees: axis moved by %.1f mm, turned by %.1f degrees\n", options.bone.c_str(),
        settings.minimum_degrees, settings.maximum_degrees, fitted.moved_mm, fitted.turned_degrees);
  print("overlap of bones at the worst angle: %lld voxels before, %lld after the fit\n",
        static_cast<long long>(fitted.overlap_before), static_cast<long long>(fitted.overlap_after));
  if (fitted.overlap_after)
    warn("joint " + options.bone + ": " + std::to_string(fitted.overlap_after) +
         " bone voxels still collide after fitting its axis");
}
}  // namespace

void add_fit_joint(CLI::App& app) {
  auto* command =
      app.add_subcommand("fit-joint", "moves a joint's axis so that bones do not collide, and stores it as a hinge");
  auto options = std::make_shared<FitJointOptions>();
  add_body_options(*command, options->body);
  command->add_option("--bone", options->bone, "the bone whose head is the joint")->required();
  command
      ->add_option("--range", options->range,
                   "smallest and largest angle of the joint, degrees from rest, between which bones must not collide, "
                   "such as 0,90")
      ->delimiter(',')
      ->expected(2);
  writes(command->add_option("-o,--output", options->output, "rig to write (.json keeps the hinge)"))->required();
  add_run_options(*command, options->run);
  command->callback([options] { run_fit_joint(*options); });
}

}  // namespace limber::cmd
