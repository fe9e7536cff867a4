// SPDX-License-Identifier: AGPL-3.0-or-later
// limber convert IN OUT [--tissues T] [--frequency HZ] [--properties P.csv]: the same thing in another format, chosen by the name of OUT.
#include <memory>

#include "core/base/error.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/convert_rig.h"
#include "core/cmd/surface_options.h"
#include "core/cmd/tissue_options.h"
#include "core/deck/decks.h"
#include "core/mesh/surface_files.h"
#include "core/volume/grey_image.h"
#include "core/volume/tissue_table.h"
#include "core/volume/volume_files.h"
#include "core/volume/volume_io.h"

namespace limber::cmd {

namespace {
struct Options {
  std::string in, out, progress;
  MaterialOptions material;
};

void write_as_deck(DeckFormat format, const VolumeFile& file, const Options& options) {
  const TissueTable tissues = tissues_of(file, options.material.tissues);
  std::vector<std::string> warnings;
  std::vector<TissueMaterial> materials;
  if (needs_frequency(format)) materials = materials_of(tissues, options.material, options.out);
  if (std::string text = stand_ins_text(materials); !text.empty()) warnings.push_back(std::move(text));
  write_deck(file.volume, tissues, std::move(materials), options.material.frequency.value_or(0), options.out, warnings);
  warn(warnings);
}

// Label volumes keep every value as it was; grey ones with fractions go as float.
void convert_volume(const Options& options) {
  const DeckFormat format = deck_format(options.out);
  const bool is_surface = is_surface_path(options.out);
  if (needs_frequency(format) && !options.material.frequency) materials_of({}, options.material, options.out);  // says what is missing
  if (format == DeckFormat::None && !is_surface) check_writable(options.out);
  else check_place(options.out);
  CommandProgress progress(options.progress);
  const VolumeSummary summary = summarize_volume(options.in);
  if (!summary.is_label) {
    if (format != DeckFormat::None || is_surface) throw Error("this is no label volume", options.in, "give one whose voxels are labels");
    const GreyVolume grey = read_grey_volume(options.in, progress);
    warn(grey.warnings);
    write_grey_volume(grey, options.out);
    return;
  }
  VolumeFile file = read_volume(options.in, progress);
  warn(file.warnings);
  if (format != DeckFormat::None || is_surface)
    require_labels(file.volume, tissues_of(file, options.material.tissues), options.in);
  if (format != DeckFormat::None) return write_as_deck(format, file, options);
  if (is_surface) return write_surfaces_of(file.volume, tissues_of(file, options.material.tissues), {}, options.out, progress);
  if (!options.material.tissues.empty()) file.tissues = tissues_of(file, options.material.tissues);
  write_volume(file.volume, options.out, file.tissues, file.type);
}

OptionFiles files_of_output(const std::string& name) {
  OptionFiles files{{}, files_written_as(name)};
  for (const Path& beside : companions(deck_format(name), name)) files.written.push_back(beside);
  return files;
}

void convert(const Options& options) {
  const Path in = options.in;
  if (is_volume_path(in)) return convert_volume(options);
  if (is_tissue_table(in)) return write_tissue_table(read_tissue_table(in), options.out);
  convert_rig_or_motion(in, options.out);
}
}  // namespace

void add_convert(CLI::App& app) {
  auto* command = app.add_subcommand("convert", "a volume, rig or label table in another format, or a volume as surfaces or as what a simulation takes, by file name");
  auto options = std::make_shared<Options>();
  command->add_option("IN", options->in, "a volume, a folder with DICOM images, a rig or a label table")->required();
  writes(command->add_option("OUT", options->out, "its extension says the format: volumes .nrrd .mha .nii.gz .txt ..., surfaces .obj .glb .stl .ply, simulations .xml (openEMS) .csxcad.h5 .gprmax.h5 .dat (ICRP 110)"), files_of_output)->required();
  add_material_options(*command, options->material);
  command->add_option("--progress", options->progress, "json: one line a step on stderr")->check(CLI::IsMember({"json"}));
  command->callback([options] { convert(*options); });
}

}  // namespace limber::cmd
