// SPDX-License-Identifier: AGPL-3.0-or-later
// limber fit-rig VOLUME --template NAME|RIG|auto [--tissues T] [--bones L,L] -o RIG [--report R.json]: fits a rig to a
//   volume automatically.
#include "core/autorig/place_in_tissue.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/parallel.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/rig_io/rig_io.h"
#include "core/rig_io/rig_templates.h"
#include "core/volume_io/grey_image.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

namespace {

struct FitRigOptions {
  std::string volume, rig, tissues, output, report;
  std::vector<double> bones;
  RunOptions run;
};

Armature wanted_rig(const std::string& name, const VolumeFile& file, Progress& progress) {
  if (name == "auto") {
    const std::string suggested = suggest_template(file.volume, progress);
    print("template: %s\n", suggested.c_str());
    return rig_template(suggested);
  }
  std::error_code failed;
  if (is_rig_template(name) || !std::filesystem::exists(name, failed)) return rig_template(name);
  ArmatureFile rig = read_armature_file(name);
  warn(rig.warnings);
  return std::move(rig.armature);
}

nlohmann::ordered_json report_of(const AutoFit& fitted) {
  nlohmann::ordered_json report{
      {"schema", "limber-fit/1"}, {"misfit_mm", fitted.misfit_mm}, {"share_in_tissue", fitted.check.whole}};
  for (size_t b = 0; b < fitted.joints.size(); ++b) {
    const glm::dvec3& head = fitted.armature.bones[b].head;
    report["joints"].push_back({{"name", fitted.armature.bones[b].name},
                                {"position", {head.x, head.y, head.z}},
                                {"found_by", std::string(to_string(fitted.joints[b].how))},
                                {"confidence", fitted.joints[b].confidence},
                                {"may_be_off_mm", fitted.joints[b].error},
                                {"share_in_tissue", fitted.check.share[b]}});
  }
  for (const auto& leaving : fitted.check.leaving)
    report["leaving"].push_back({{"bone", fitted.armature.bones[leaving.bone].name},
                                 {"from", leaving.from},
                                 {"to", leaving.to},
                                 {"place", {leaving.place.x, leaving.place.y, leaving.place.z}}});
  report["warnings"] = fitted.warnings;
  return report;
}

void print_fit(const AutoFit& fitted) {
  print("%-24s %-14s %10s %10s %10s\n", "joint", "found by", "confidence", "may be off", "in tissue");
  for (size_t b = 0; b < fitted.joints.size(); ++b)
    print("%-24s %-14s %9.0f%% %7.0f mm %9.0f%%\n", one_line(fitted.armature.bones[b].name).c_str(),
          std::string(to_string(fitted.joints[b].how)).c_str(), 100 * fitted.joints[b].confidence,
          fitted.joints[b].error, 100 * fitted.check.share[b]);
  if (fitted.misfit_mm > 0)
    print("the skin lies %.1f mm (root mean square) from the fitted body's skin, ", fitted.misfit_mm);
  print("%.1f %% of the length of all bones lies in tissue\n", 100 * fitted.check.whole);
}

void run_fit_rig(const FitRigOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  check_armature_writable(options.output);
  if (!options.report.empty()) check_place(options.report);
  const VolumeFile file = read_volume(options.volume, progress);
  warn(file.warnings);
  std::optional<TissueTable> user;
  if (!options.tissues.empty()) user = read_tissue_table(options.tissues);
  TissueTable tissues = merge_tissue_tables(file.tissues, user ? &*user : nullptr);
  require_labels(file.volume, tissues, options.volume);
  if (!options.bones.empty()) tissues = with_bones(std::move(tissues), options.bones);
  const Armature rig = wanted_rig(options.rig, file, progress);

  const AutoFit fitted = fitted_or_placed(file.volume, tissues, rig, progress);
  write_armature(fitted.armature, options.output);
  if (!options.report.empty()) write_file_atomically(options.report, report_of(fitted).dump(1) + "\n");
  print_fit(fitted);
  warn(fitted.warnings);
}

}  // namespace

void add_fit_rig(CLI::App& app) {
  auto* command = app.add_subcommand(
      "fit-rig",
      "fits a rig to a volume automatically; finds joints from named bones, bone tissue, or the body's shape");
  auto options = std::make_shared<FitRigOptions>();
  command->add_option("VOLUME", options->volume, "label volume")->required();
  command
      ->add_option("--template", options->rig,
                   "rig to fit: arm, hand, leg, adult, child, quadruped, auto, or a rig file (JSON, Bender .vtk "
                   "or .arm, BVH)")
      ->required();
  command->add_option("--tissues", options->tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command
      ->add_option("--bones", options->bones,
                   "labels that are bone, as numbers in the volume file (default: from the tissue table, or found "
                   "automatically)")
      ->delimiter(',')
      ->type_name("L,L");
  writes(command->add_option("-o,--output", options->output, "rig to write (.json keeps joint limits)"))->required();
  writes(command->add_option("--report", options->report, "JSON file to write: how each joint was found"));
  add_run_options(*command, options->run);
  command->callback([options] { run_fit_rig(*options); });
}

}  // namespace limber::cmd
