// SPDX-License-Identifier: AGPL-3.0-or-later
// limber repair-joint VOLUME --rig RIG --bone B [--weights W] [--tissues T] [--bones L,L] [--range LOW,HIGH]
//   [--method mix|lbs|dqs] [--seams FILE|none] -o W2.nrrd: changes the weights around a joint so that skin, fat and
//   muscle keep their volumes over the joint's range of motion.
#include "core/repair/repair_joint.h"

#include <memory>
#include <optional>

#include "core/base/parallel.h"
#include "core/body/bind_body.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/seam_options.h"
#include "core/resample/deformation_method.h"
#include "core/skin/weights_io.h"

namespace limber::cmd {

namespace {
struct RepairJointOptions {
  BodyOptions body;
  std::string weights, bone, method = deformation_methods().front().word, seams, output;
  std::vector<double> range;
  RunOptions run;
};

void print_side(const TurnFigures& figures) {
  print("  %+7.2f %+7.2f %+7.2f %7.2f %9lld", figures.change[0], figures.change[1], figures.change[2], figures.sum(),
        static_cast<long long>(figures.overlap_voxels));
}

// Prints, for each angle of the joint, the volume changes of skin, fat and muscle in percent, the sum of their absolute
// values, and the number of overlapping voxels, before and after the repair.
void print_figures(const JointRepair& repair) {
  print("%8s  %-41s  %s\n", "", "before, %", "after, %");
  print("%8s", "degrees");
  for (int side = 0; side < 2; ++side) print("  %7s %7s %7s %7s %9s", "skin", "fat", "muscle", "sum", "overlap");
  print("\n");
  for (std::size_t t = 0; t < repair.before.size(); ++t) {
    print("%+8.1f", glm::degrees(repair.before[t].turn.angle));
    print_side(repair.before[t]);
    print_side(repair.after[t]);
    print("\n");
  }
}

void repair(const RepairJointOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);

  check_weights_writable(options.output);
  const Body body = read_body(options.body, progress);
  const int bone = require_bone(body.rig, options.bone);
  const SeamChoice seams = read_seam_choice(options.seams, body.file.volume, progress);
  const BoundBody bound = options.weights.empty() ? bind_body(body, Binding::Heat, seams, progress)
                                                  : read_bound_body(body, options.weights, seams, progress);
  warn(bound.warnings);
  JointRepairSettings settings;
  settings.blend = *find_method(options.method)->blend;
  if (!options.range.empty()) settings.range = TurnRange{options.range[0], options.range[1]};
  const JointRepair repair =
      repair_joint({body.file.volume, bound.tissue, body.tissues, body.rig}, bound.weights, bone, settings, progress);
  write_weights(repair.weights, body.file.volume, bound.tissue, options.output, SeamsOfWeights::OfTissue);
  print_figures(repair);
  print("%s.\n", one_line(describe(repair, body.rig, bone)).c_str());
}
}  // namespace

void add_repair_joint(CLI::App& app) {
  auto* command = app.add_subcommand(
      "repair-joint", "changes the weights around a joint so that skin, fat and muscle keep their volumes");
  auto options = std::make_shared<RepairJointOptions>();
  add_body_options(*command, options->body);
  command->add_option("--bone", options->bone, "the bone whose head is the joint")->required();
  command->add_option("--weights", options->weights,
                      "weights to start from, W.nrrd (default: computed by heat diffusion)");
  command
      ->add_option(
          "--range", options->range,
          "smallest and largest angle of the joint, degrees from rest, e.g. 0,90 (default: the limits of the joint)")
      ->delimiter(',')
      ->expected(2);
  command->add_option("--method", options->method, method_summaries(Methods::Blends))
      ->check(CLI::IsMember(method_words(Methods::Blends)));
  add_seam_option(*command, options->seams);
  writes(command->add_option("-o,--output", options->output, "W.nrrd"))->required();
  add_run_options(*command, options->run);
  command->callback([options] { repair(*options); });
}

}  // namespace limber::cmd
