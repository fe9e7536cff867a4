// SPDX-License-Identifier: AGPL-3.0-or-later
// limber bake-joint VOLUME --rig RIG --bone B [--range LOW,HIGH] [--angles N] [--weights W] [--tissues T] [--bones L,L]
//   [--quality draft|normal|fine] [--no-contact] [--glide off|voxel|joint|MM] [--seams FILE|none] -o JOINT.bake: solves
//   a joint by finite elements at a few angles, and writes how far the solved shapes differ from blending, for limber
//   resample --baked.
#include "core/bake/bake_joint.h"

#include <memory>
#include <optional>

#include "core/bake/baked_joint_io.h"
#include "core/base/parallel.h"
#include "core/body/glide_poses.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/seam_options.h"

namespace limber::cmd {

namespace {

struct BakeJointOptions {
  BodyOptions body;
  std::string weights, bone, seams, glide, quality = "normal", output;
  std::vector<double> range;
  int angles = BakeSettings{}.angles;
  bool no_contact = false;
  RunOptions run;
};

BakeSettings settings_of(const BakeJointOptions& options) {
  BakeSettings settings;
  if (!options.range.empty()) settings.low = options.range[0], settings.high = options.range[1];
  settings.angles = options.angles;
  settings.contact = !options.no_contact;
  settings.glide = options.glide.empty() ? settings.glide : options.glide;
  settings.quality = options.quality == "draft"  ? FemQuality::Draft
                     : options.quality == "fine" ? FemQuality::Fine
                                                 : FemQuality::Normal;
  return settings;
}

void print_errors(const char* name, const std::vector<BakeError>& errors) {
  for (const BakeError& error : errors)
    print("%-8s %+9.1f %15.2f %14.2f %12.2f\n", name, error.degrees, error.flesh_mm, error.skin_mm, error.largest_mm);
}

// Prints how far shapes of the baked joint differ from those of finite elements, at the baked angles and between them.
void print_bake(const BakedJoint& joint) {
  print("%-8s %9s %15s %14s %12s\n", "", "degrees", "95 % flesh, mm", "95 % skin, mm", "largest, mm");
  print_errors("baked", joint.at_baked);
  print_errors("between", joint.between);
  const BakeError worst = worst_between(joint);
  print(
      "%s is baked from %+.4g to %+.4g degrees, %lld nodes at %lld angles. Between these angles, at %+.4g degrees, "
      "95 %% of flesh is within %.2f mm and 95 %% of skin within %.2f mm of the finite element solution.\n",
      one_line(joint.bone).c_str(), joint.degrees.front(), joint.degrees.back(),
      static_cast<long long>(joint.nodes.size()), static_cast<long long>(joint.degrees.size() - 1), worst.degrees,
      worst.flesh_mm, worst.skin_mm);
}

void bake(const BakeJointOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);

  check_place(options.output);
  const BakeSettings settings = settings_of(options);
  glide_settings(settings.glide, 1, "--glide " + settings.glide);
  const Body body = read_body(options.body, progress);
  const int bone = require_bone(body.rig, options.bone);
  const SeamChoice seams = read_seam_choice(options.seams, body.file.volume, progress);
  const BoundBody bound = options.weights.empty() ? bind_body(body, Binding::Heat, seams, progress)
                                                  : read_bound_body(body, options.weights, seams, progress);
  warn(bound.warnings);
  const JointBake baked = bake_joint(body, bound, bone, settings, progress);
  warn(baked.warnings);
  write_baked_joint(baked.joint, options.output);
  print_bake(baked.joint);
  if (!baked.all_reached) throw PoseNotReached();
}

}  // namespace

void add_bake_joint(CLI::App& app) {
  auto* command = app.add_subcommand("bake-joint",
                                     "solves a joint by finite elements once and stores the shapes, which 'limber "
                                     "resample --baked' then applies as fast as blending");
  auto options = std::make_shared<BakeJointOptions>();
  add_body_options(*command, options->body);
  command->add_option("--bone", options->bone, "the bone below the joint")->required();
  command
      ->add_option("--range", options->range,
                   "smallest and largest angle of the joint, degrees from rest, positive bends further, e.g. -20,100 "
                   "(default: 0,90)")
      ->delimiter(',')
      ->expected(2);
  command
      ->add_option(
          "--angles", options->angles,
          "number of angles to bake in addition to rest; as many angles between them are solved to measure the error")
      ->capture_default_str()
      ->check(CLI::Range(1, 30));
  command->add_option("--weights", options->weights, "weights, W.nrrd (default: computed by heat diffusion)");
  add_seam_option(*command, options->seams);
  command
      ->add_option("--quality", options->quality,
                   "resolution of the mesh: draft (8 tets across the thinnest bent limb), normal (12), or fine (24 "
                   "around the joint)")
      ->capture_default_str()
      ->check(CLI::IsMember({"draft", "normal", "fine"}));
  command->add_flag("--no-contact", options->no_contact,
                    "let skin pass through skin, which solves faster (default: skin presses against skin)");
  command
      ->add_option("--glide", options->glide,
                   "largest shift of the joint where its bones would overlap: joint (5 percent of the shorter bone), "
                   "voxel (no bone moves further than one voxel), a length in mm, or off (default: joint)")
      ->type_name("off|voxel|joint|MM");
  writes(command->add_option("-o,--output", options->output, "baked joint to write, JOINT.bake"))->required();
  add_run_options(*command, options->run);
  command->callback([options] { bake(*options); });
}

}  // namespace limber::cmd
