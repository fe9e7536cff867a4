// SPDX-License-Identifier: AGPL-3.0-or-later
// limber weights VOLUME --rig RIG [--tissues T] [--bones L,L] [--method heat|geodesic|rigid] -o W.nrrd [--bender-dir DIR]
#include <cstdio>
#include <memory>
#include <optional>

#include "core/base/parallel.h"
#include "core/cmd/command.h"
#include "core/rig/armature_io.h"
#include "core/rig/bone_parts.h"
#include "core/skin/geodesic.h"
#include "core/skin/heat_diffusion.h"
#include "core/skin/rigid.h"
#include "core/skin/weights_io.h"
#include "core/volume/volume_io.h"

namespace limber::cmd {

namespace {
struct Options {
  std::string volume, rig, tissues, method = "heat", output, bender_folder;
  std::vector<double> bones;
  RunOptions run;
};

void print_table(const BoneParts& parts, const Armature& armature) {
  std::printf("%-28s %10s   %s\n", "rig bone", "voxels", "centre of the bone part, mm");
  for (const auto& part : parts.parts)
    std::printf("%-28s %10lld   %.0f %.0f %.0f\n", armature.bones[part.bone].name.c_str(), static_cast<long long>(part.voxel_count),
                part.centre.x, part.centre.y, part.centre.z);
  std::vector<bool> has_part(armature.bones.size(), false);
  for (const auto& part : parts.parts) has_part[part.bone] = true;
  for (size_t b = 0; b < armature.bones.size(); ++b)
    if (!has_part[b]) std::printf("%-28s %10s   holds the tissue around its axis\n", armature.bones[b].name.c_str(), "none");
}

void make_weights(const Options& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);

  check_weights_writable(options.output);
  VolumeFile file = read_volume(options.volume, progress);
  warn(file.warnings);
  std::optional<TissueTable> user;
  if (!options.tissues.empty()) user = read_tissue_table(options.tissues);
  TissueTable tissues = merge_tissue_tables(file.tissues, user ? &*user : nullptr);
  if (!options.bones.empty()) tissues = with_bones(std::move(tissues), options.bones);
  const ArmatureFile rig = read_armature_file(options.rig);
  warn(rig.warnings);

  const TissueVoxels tissue(file.volume);
  const BoneParts parts = split_bones(file.volume, tissue, tissues, rig.armature, progress);
  WeightsReport report;
  const SkinWeights weights =
      options.method == "rigid"      ? bind_rigid(file.volume, tissue, rig.armature, parts, progress, &report)
      : options.method == "geodesic" ? bind_geodesic(file.volume, tissue, rig.armature, parts, {}, progress, &report)
                                     : diffuse_heat(file.volume, tissue, tissues, rig.armature, parts, {}, progress, &report);
  warn(report.warnings);
  if (!options.bender_folder.empty()) write_bender_weights(weights, file.volume, tissue, options.bender_folder);
  write_weights(weights, file.volume, tissue, options.output);

  std::printf("tissue: %lld voxels, table: %s\n", static_cast<long long>(tissue.size()), tissues.source.c_str());
  print_table(parts, rig.armature);
  if (options.method == "heat") std::printf("heat: residual %.1e in %d iterations\n", report.residual, report.iterations);
}
}  // namespace

void add_weights(CLI::App& app) {
  auto* command = app.add_subcommand("weights", "how tissue follows the bones: up to four bones and weights a voxel");
  auto options = std::make_shared<Options>();
  command->add_option("VOLUME", options->volume, "label volume")->required();
  command->add_option("--rig", options->rig, "rig")->required();
  command->add_option("--tissues", options->tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command->add_option("--bones", options->bones, "labels that are bone, as in the file")->delimiter(',');
  command->add_option("--method", options->method, "heat, geodesic or rigid")->check(CLI::IsMember({"heat", "geodesic", "rigid"}));
  command->add_option("-o,--output", options->output, "W.nrrd")->required();
  command->add_option("--bender-dir", options->bender_folder, "also write weight_NN.mha, one a bone, into this folder");
  add_run_options(*command, options->run);
  command->callback([options] { make_weights(*options); });
}

}  // namespace limber::cmd
