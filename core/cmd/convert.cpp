// SPDX-License-Identifier: AGPL-3.0-or-later
// limber convert IN OUT [--tissues T] [--frequency HZ] [--properties P.csv] [--threads N]: converts a file to the
// format that the extension of OUT names.
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/convert_rig.h"
#include "core/cmd/surface_options.h"
#include "core/cmd/tissue_options.h"
#include "core/export/exporter.h"
#include "core/export/surface_files.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/grey_image.h"
#include "core/volume_io/volume_files.h"
#include "core/volume_io/volume_format.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

namespace {
struct ConvertOptions {
  std::string in, out;
  RunOptions run;
  MaterialOptions material;
};

void export_body(const Exporter& exporter, const VolumeFile& file, const ConvertOptions& options, Progress& progress) {
  const TissueTable tissues = tissues_of(file, options.material.tissues);
  std::vector<std::string> warnings;
  std::vector<TissueMaterial> materials;
  if (exporter.needs_frequency) materials = materials_of(tissues, options.material, options.out);
  if (std::string text = stand_ins_text(materials); !text.empty()) warnings.push_back(std::move(text));
  write_export(
      exporter,
      {file.volume, tissues, std::move(materials), options.material.frequency.value_or(0), nullptr, progress, warnings},
      options.out);
  warn(warnings);
}

// Converts a volume. Labels keep their values. A grey volume with fractional values is written as float.
void convert_volume(const ConvertOptions& options) {
  const Exporter* exporter = exporter_for(options.out);
  if (exporter && !exporter->takes_voxels)
    throw Error("this format stores a tet mesh, which a volume does not have", options.out,
                "make a mesh with `limber mesh` or `limber resample --mesh-out`");
  if (exporter && exporter->needs_frequency && !options.material.frequency)
    materials_of({}, options.material, options.out);  // throws an Error that says which option is missing
  if (exporter) check_place(options.out);
  else check_writable(options.out);
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  const VolumeSummary summary = summarize_volume(options.in);
  if (!summary.is_label) {
    if (exporter) throw Error("this is not a label volume", options.in, "give a volume whose voxels are labels");
    const GreyVolume grey = read_grey_volume(options.in, progress);
    warn(grey.warnings);
    write_grey_volume(grey, options.out);
    return;
  }
  VolumeFile file = read_volume(options.in, progress);
  warn(file.warnings);
  if (exporter) {
    require_labels(file.volume, tissues_of(file, options.material.tissues), options.in);
    if (is_surface_path(options.out))  // write_surfaces_of() also prints the sizes of the surfaces
      return write_surfaces_of(file.volume, tissues_of(file, options.material.tissues), {}, options.out, progress);
    return export_body(*exporter, file, options, progress);
  }
  if (!options.material.tissues.empty()) file.tissues = tissues_of(file, options.material.tissues);
  write_volume(file.volume, options.out, file.tissues, file.type);
}

OptionFiles files_of_output(const std::string& name) {
  OptionFiles files{{}, files_written_as(name)};
  try {
    if (const Exporter* exporter = exporter_for(name)) files.written = files_exported_as(*exporter, name);
  } catch (const Error&) {
    // Ignores a wrong output name here; the conversion itself reports it.
  }
  return files;
}

void convert(const ConvertOptions& options) {
  const Path in = options.in;
  if (is_volume_path(in)) return convert_volume(options);
  if (is_tissue_table(in)) return write_tissue_table(read_tissue_table(in), options.out);
  convert_rig_or_motion(in, options.out);
}
}  // namespace

void add_convert(CLI::App& app) {
  auto* command = app.add_subcommand("convert",
                                     "converts a volume, rig or label table to another format, or a volume to surfaces "
                                     "or to the input of a simulation; OUT's extension selects the format");
  auto options = std::make_shared<ConvertOptions>();
  command->add_option("IN", options->in, "a volume, a folder with DICOM images, a rig or a label table")->required();
  writes(command->add_option("OUT", options->out,
                             "file to write; its extension selects the format: volumes " + writable_endings() + "; " +
                                 exporter_endings()),
         files_of_output)
      ->required();
  add_material_options(*command, options->material);
  add_run_options(*command, options->run);
  command->callback([options] { convert(*options); });
}

}  // namespace limber::cmd
