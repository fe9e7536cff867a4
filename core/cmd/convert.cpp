// SPDX-License-Identifier: AGPL-3.0-or-later
// limber convert IN OUT [--tissues T]: the same thing in another format, chosen by the name of OUT.
#include <memory>

#include "core/base/error.h"
#include "core/cmd/command.h"
#include "core/cmd/convert_rig.h"
#include "core/volume/tissue_table.h"
#include "core/volume/volume_io.h"

namespace limber::cmd {

namespace {
struct Options {
  std::string in, out, tissues, progress;
};

// Label volumes keep every value as it was; grey ones with fractions go as float.
void convert_volume(const Options& options) {
  check_writable(options.out);
  CommandProgress progress(options.progress);
  const VolumeSummary summary = summarize_volume(options.in);
  if (!summary.is_label) {
    const GreyVolume grey = read_grey_volume(options.in, progress);
    warn(grey.warnings);
    write_grey_volume(grey, options.out);
    return;
  }
  VolumeFile file = read_volume(options.in, progress);
  warn(file.warnings);
  if (!options.tissues.empty()) {
    const TissueTable user = read_tissue_table(options.tissues);
    file.tissues = merge_tissue_tables(file.tissues, &user);
  }
  write_volume(file.volume, options.out, file.tissues, file.type);
}

void convert(const Options& options) {
  const Path in = options.in;
  if (is_volume_path(in)) return convert_volume(options);
  if (is_tissue_table(in)) return write_tissue_table(read_tissue_table(in), options.out);
  convert_rig_or_motion(in, options.out);
}
}  // namespace

void add_convert(CLI::App& app) {
  auto* command = app.add_subcommand("convert", "the same volume, rig or label table in another format, by file name");
  auto options = std::make_shared<Options>();
  command->add_option("IN", options->in, "a volume, a folder with DICOM images, a rig or a label table")->required();
  command->add_option("OUT", options->out, "its extension says the format")->required();
  command->add_option("--tissues", options->tissues, "label table whose names and colours go into OUT");
  command->add_option("--progress", options->progress, "json: one line a step on stderr")->check(CLI::IsMember({"json"}));
  command->callback([options] { convert(*options); });
}

}  // namespace limber::cmd
