// SPDX-License-Identifier: AGPL-3.0-or-later
// limber export-gltf VOLUME --rig R --weights W [--tissues T] [--motion F.bvh ...] [--up y|z|auto] [--map M]
//   [--motion-rest POSE] [--rig-rest POSE] [--root-motion] [--step MM] -o OUT.glb: writes the body's surface with its
//   skeleton, its weights and its motions.
#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/pose_options.h"
#include "core/export/gltf.h"
#include "core/skin/weights_io.h"

namespace limber::cmd {

namespace {
struct ExportGltfOptions {
  BodyOptions body;
  std::string weights, map, output, progress, up = "y";
  std::vector<std::string> motions;
  RestWords rests;
  bool root_motion = false;
  GltfSettings settings;
};

std::shared_ptr<const Clip> clip_of_file(const ExportGltfOptions& options, const std::string& file, const Armature& rig,
                                         const std::vector<std::shared_ptr<const Clip>>& before) {
  auto motion = std::make_shared<const Motion>(read_motion(file, options.up));
  if (motion->frame_count == 0) throw Error("this motion has no frames", file, "use another file");
  Clip clip = clip_of(motion, unique_clip_name(before, std::filesystem::path(file).stem().string()));
  clip.map = options.map.empty() ? match_by_names(*motion, rig) : read_retarget_map(options.map, *motion, rig);
  take_over(options.rests, clip.map);
  if (options.root_motion) clip.retarget.travel = Travel::Free;
  return std::make_shared<const Clip>(std::move(clip));
}

void export_gltf(const ExportGltfOptions& options) {
  check_place(options.output);
  CommandProgress progress(options.progress);
  const Body body = read_body(options.body, progress);
  const WeightsFile weights = read_weights(options.weights, body.file.volume, TissueVoxels(body.file.volume), body.rig);
  warn(weights.warnings);
  std::vector<std::shared_ptr<const Clip>> clips;
  for (const std::string& file : options.motions) clips.push_back(clip_of_file(options, file, body.rig, clips));
  write_glb({body.file.volume, body.tissues, body.rig, weights.weights}, clips, options.output, options.settings,
            progress);
}
}  // namespace

void add_export_gltf(CLI::App& app) {
  auto* command = app.add_subcommand(
      "export-gltf", "exports the body's surface, rig and weights, and motions as animations, to one .glb file");
  auto options = std::make_shared<ExportGltfOptions>();
  add_body_options(*command, options->body);
  command->add_option("--weights", options->weights, "weights: W.nrrd, or a folder with Bender's weights")->required();
  auto* motion =
      command->add_option("--motion", options->motions, "motion capture (BVH) that becomes an animation (repeatable)")
          ->type_name("F.bvh")
          ->expected(1)
          ->take_all();
  add_up_option(*command, options->up, motion);
  command
      ->add_option("--map", options->map,
                   "retarget map (JSON): which joint of the motion moves which rig bone (default: matched by names)")
      ->type_name("M.json")
      ->needs(motion);
  add_rest_options(*command, options->rests, motion, "");
  command
      ->add_flag("--root-motion", options->root_motion,
                 "move the body along the ground as the motion does (default: keep it at its rest position)")
      ->needs(motion);
  command
      ->add_option("--step", options->settings.step,
                   "distance between the surface's vertices, mm (default: 1/400 of the volume's longest side)")
      ->type_name("MM")
      ->check(CLI::PositiveNumber);
  writes(command->add_option("-o,--output", options->output, "glTF file to write, OUT.glb"))->required();
  command
      ->add_option("--progress", options->progress,
                   "with the value json: print progress to stderr, one line of JSON per step (default: a progress bar)")
      ->check(CLI::IsMember({"json"}));
  command->callback([options] { export_gltf(*options); });
}

}  // namespace limber::cmd
