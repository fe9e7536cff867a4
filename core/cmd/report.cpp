// SPDX-License-Identifier: AGPL-3.0-or-later
// limber report BEFORE AFTER [--tissues T] [--json]
#include "core/report/report.h"

#include <iostream>
#include <memory>

#include "core/cmd/command.h"
#include "core/report/dice.h"
#include "core/volume/volume_io.h"

namespace limber::cmd {

namespace {
// The labels of `file` as `table` numbers them, matched by what they are called in files; values that `table` lacks are
// added to it.
void renumber(VolumeFile& file, TissueTable& table) {
  std::vector<Label> of(65536);
  Label highest = 0;
  for (const Tissue& tissue : table.tissues) highest = std::max(highest, tissue.label);
  for (const Tissue& tissue : file.tissues.tissues) {
    if (const Tissue* known = table.find_file_value(tissue.file_value)) {
      of[tissue.label] = known->label;
      continue;
    }
    if (highest == 65535)
      throw Error("the two volumes together have more than 65535 labels", "label comparison",
                  "compare volumes with fewer labels (limber prepare --merge)");
    table.tissues.push_back(tissue);
    table.tissues.back().label = of[tissue.label] = ++highest;
  }
  for (Label& label : file.volume.voxels) label = of[label];
}

struct Options {
  std::string before, after, tissues;
  bool json = false;
};

void run(const Options& options) {
  const Stopwatch total;
  Report report;
  report.inputs = {describe_input(options.before), describe_input(options.after)};
  CommandProgress progress("");
  VolumeFile before = read_volume(options.before, progress), after = read_volume(options.after, progress);
  std::optional<TissueTable> user;
  if (!options.tissues.empty()) {
    user = read_tissue_table(options.tissues);
    report.inputs.push_back(describe_input(options.tissues));
  }
  renumber(after, before.tissues);
  const TissueTable tissues = merge_tissue_tables(before.tissues, user ? &*user : nullptr);
  report.seconds.read = total.seconds();
  for (const VolumeFile* file : {&before, &after})
    for (const std::string& warning : file->warnings) {
      warn(warning);
      report.warnings.push_back(warning);
    }

  report.metrics = compare(before.volume, after.volume, tissues);
  if (before.volume.grid == after.volume.grid) report.dice = dice_by_label(before.volume, after.volume);
  progress.update("report", 1);
  report.seconds.total = total.seconds();
  if (options.json)
    std::cout << to_json(report);
  else
    print_report(std::cout, report);
}
}  // namespace

void add_report(CLI::App& app) {
  auto* command = app.add_subcommand("report", "what changed between two label volumes");
  auto options = std::make_shared<Options>();
  command->add_option("BEFORE", options->before, "label volume")->required();
  command->add_option("AFTER", options->after, "label volume")->required();
  command->add_option("--tissues", options->tissues, "tissue table: names, kinds, densities");
  command->add_flag("--json", options->json, "print the report as JSON (schema limber-report/1)");
  command->callback([options] { run(*options); });
}

}  // namespace limber::cmd
