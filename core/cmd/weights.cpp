// SPDX-License-Identifier: AGPL-3.0-or-later
// limber weights VOLUME --rig RIG [--tissues T] [--bones L,L] [--method heat|geodesic|rigid] [--seams FILE|none]
//   -o W.nrrd [--bender-dir DIR] [--strict]: computes the weights by which tissue follows the bones.
#include <cstdio>
#include <memory>
#include <optional>
#include <tuple>

#include "core/base/parallel.h"
#include "core/body/bind_body.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/seam_options.h"
#include "core/report/report.h"
#include "core/report/whole_bones.h"
#include "core/skin/weights_io.h"

namespace limber::cmd {

namespace {
struct WeightsOptions {
  BodyOptions body;
  std::string method = "heat", output, bender_folder, seams;
  bool strict = false;
  RunOptions run;
};

void print_table(const BoneParts& parts, const Armature& armature) {
  print("%-28s %10s   %s\n", "rig bone", "voxels", "centre of the bone part, mm");
  for (const auto& part : parts.parts)
    print("%-28s %10lld   %.0f %.0f %.0f\n", one_line(armature.bones[part.bone].name).c_str(),
          static_cast<long long>(part.voxel_count), part.centre.x, part.centre.y, part.centre.z);
  std::vector<bool> has_part(armature.bones.size(), false);
  for (const auto& part : parts.parts) has_part[part.bone] = true;
  for (size_t b = 0; b < armature.bones.size(); ++b)
    if (!has_part[b])
      print("%-28s %10s   no bone tissue: moves the soft tissue around its axis\n",
            one_line(armature.bones[b].name).c_str(), "none");
}

// Prints the rig bone that each label of bone tissue follows, and how this rig bone was found.
void print_identities(const BoneParts& parts, const TissueTable& tissues, const Armature& armature) {
  print("\n%-44s %-20s %10s   %s\n", "bone tissue", "follows", "voxels", "found by");
  for (const auto& identity : parts.identities) {
    const Tissue* tissue = tissues.find(identity.label);
    const std::string name = tissue && !tissue->name.empty() ? tissue->name : "label " + std::to_string(identity.label);
    print("%-44.44s %-20s %10lld   %s%s\n", one_line(name).c_str(),
          one_line(armature.bones[identity.bone].name).c_str(), static_cast<long long>(identity.voxel_count),
          std::string(to_string(identity.found_by)).c_str(), identity.is_substitute ? ", not sure" : "");
  }
}

// Judges the two quality gates that need no pose: "inputs" (do the files belong to one body?) and "follows" (does each
// anatomical bone follow its own rig bone?). Prints the two results, and returns the sentences of the gates that
// failed.
std::vector<std::string> failed_gates_of(const Body& body, const TissueVoxels& tissue, const SkinWeights& weights) {
  Report report;
  report.doubts = body.doubts;
  const std::vector<RigidTransform> at_rest(weights.bones().size());
  report.posed_bones.whole =
      whole_bones(body.file.volume, tissue, body.tissues, body.rig, weights, at_rest, body.bone_map);
  judge(report);
  std::erase_if(report.gates, [](const QualityGate& gate) { return gate.id != "inputs" && gate.id != "follows"; });
  for (const QualityGate& gate : report.gates)
    print("%-11s %s\n", gate.state == GateState::Failed ? "FAILED" : std::string(to_string(gate.state)).c_str(),
          one_line(gate.sentence).c_str());
  return failed_gates(report);
}

// Returns the existing files of the folder that --bender-dir would overwrite.
OptionFiles files_of_bender_folder(const std::string& folder) {
  OptionFiles files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().filename().string().starts_with("weight_")) files.written.push_back(entry.path());
  return files;
}

void make_weights(const WeightsOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);

  check_weights_writable(options.output);
  const Body body = read_body(options.body, progress);
  const LabelVolume& volume = body.file.volume;
  const Armature& rig = body.rig;

  const SeamChoice seams = read_seam_choice(options.seams, volume, progress);
  const Binding binding = require_binding(options.method, "--method " + options.method);
  const BoundBody bound = bind_body(body, binding, seams, progress);
  const auto& [tissue, weights, parts, solve] = std::tie(bound.tissue, bound.weights, *bound.parts, bound.solve);
  warn(bound.warnings);
  if (!options.bender_folder.empty()) write_bender_weights(weights, volume, tissue, options.bender_folder);
  write_weights(weights, volume, tissue, options.output, SeamsOfWeights::OfTissue);

  print("tissue: %lld voxels, table: %s\n", static_cast<long long>(tissue.size()),
        one_line(body.tissues.source).c_str());
  print_table(parts, rig);
  print_identities(parts, body.tissues, rig);
  if (options.method == "heat") print("heat: residual %.1e in %d iterations\n", solve.residual, solve.iterations);
  if (!options.strict) return;
  const std::vector<std::string> failed = failed_gates_of(body, tissue, weights);
  tell_failed_gates(failed);
  if (!failed.empty()) throw GateFailed();
}
}  // namespace

void add_weights(CLI::App& app) {
  auto* command = app.add_subcommand(
      "weights", "computes skin weights: for each voxel, up to four bones that the voxel follows, and their weights");
  auto options = std::make_shared<WeightsOptions>();
  add_body_options(*command, options->body);
  command
      ->add_option("--method", options->method,
                   "how weights are computed: heat (smoothest), geodesic (faster) or rigid (one bone per voxel)")
      ->check(CLI::IsMember(binding_words()));
  add_seam_option(*command, options->seams);
  writes(command->add_option("-o,--output", options->output, "weights to write, W.nrrd"))->required();
  writes(command->add_option("--bender-dir", options->bender_folder,
                             "also write weight_NN.mha, one file per bone, into this folder"),
         files_of_bender_folder);
  command->add_flag("--strict", options->strict,
                    "exit with code 5 when the inputs do not belong together, or an anatomical bone does not follow "
                    "its own rig bone");
  add_run_options(*command, options->run);
  command->callback([options] { make_weights(*options); });
}

}  // namespace limber::cmd
