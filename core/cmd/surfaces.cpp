// SPDX-License-Identifier: AGPL-3.0-or-later
// limber surfaces VOLUME -o OUT.obj|glb|stl|ply [--tissues T] [--only A,B] [--relax N]: writes closed, smooth surfaces
// of tissues. Neighbouring tissues share the surface between them.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/base/error.h"
#include "core/base/output_files.h"
#include "core/base/text_parse.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/surface_options.h"
#include "core/cmd/tissue_options.h"
#include "core/export/surface_files.h"
#include "core/volume_io/grey_image.h"

namespace limber::cmd {

namespace {
struct SurfacesOptions {
  std::string volume, tissues, output, progress;
  SurfaceChoice choice;
};

bool is_meant(const Tissue& tissue, const std::string& word) {
  return lower_case(tissue.name) == lower_case(word) || text_of(tissue.file_value) == word;
}

void keep_chosen(LabelSurfaces& all, const TissueTable& tissues, const std::vector<std::string>& chosen) {
  if (chosen.empty()) return;
  for (const std::string& word : chosen)
    if (std::none_of(tissues.tissues.begin(), tissues.tissues.end(),
                     [&](const Tissue& tissue) { return is_meant(tissue, word); }))
      throw Error("there is no tissue " + in_quotes(word), "--only", "name tissues or labels that `limber info` lists");
  std::erase_if(all.surfaces, [&](const LabelSurface& surface) {
    const Tissue* tissue = tissues.find(surface.label);
    return !tissue ||
           std::none_of(chosen.begin(), chosen.end(), [&](const std::string& word) { return is_meant(*tissue, word); });
  });
}

void print_surfaces(const LabelSurfaces& all, const LabelVolume& volume, const TissueTable& tissues) {
  std::vector<std::int64_t> voxels(65536);
  for (const Label label : volume.voxels) ++voxels[label];
  print("%-28s %10s %10s %7s %14s %18s\n", "tissue", "triangles", "vertices", "Euler", "mm3", "of voxels' volume");
  for (const LabelSurface& surface : all.surfaces) {
    const Tissue* tissue = tissues.find(surface.label);
    const double mm3 = enclosed_volume(all, surface),
                 by_voxels = static_cast<double>(voxels[surface.label]) * volume.grid.voxel_volume();
    print("%-28s %10zu %10zu %7d %14.6g %17.2f%%\n", one_line(tissue ? tissue->name : "").c_str(), surface.F.size(),
          surface.vertex.size(), surface.euler_number(), mm3, 100 * mm3 / by_voxels);
  }
}
// Returns the files that an output name stands for: the file itself, and existing files of single tissues (the name,
// "-" and more) that may be overwritten.
OptionFiles files_of_surfaces(const std::string& name) {
  const Path path = name;
  OptionFiles files{{}, {path}};
  const std::string start = path.stem().string() + "-", end = path.extension().string();
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(path.has_parent_path() ? path.parent_path() : Path("."), error))
    if (const std::string file = entry.path().filename().string(); file.starts_with(start) && file.ends_with(end))
      files.written.push_back(entry.path());
  return files;
}
}  // namespace

void write_surfaces_of(const LabelVolume& volume, const TissueTable& tissues, const SurfaceChoice& choice,
                       const std::string& output, Progress& progress) {
  if (!is_surface_path(output))
    throw Error("surfaces cannot be written with this extension", output, std::string("use ") + kSurfaceEndings);
  LabelSurfaces all = label_surfaces(volume, choice.settings, progress);
  keep_chosen(all, tissues, choice.tissues);
  if (all.surfaces.empty()) throw Error("the volume has no tissue", output, "give a volume with labels other than 0");
  Outputs outputs;
  outputs.expect(surface_paths(all, tissues, output));
  write_surfaces(all, tissues, output);
  outputs.complete();
  print_surfaces(all, volume, tissues);
}

void add_surfaces(CLI::App& app) {
  auto* command = app.add_subcommand(
      "surfaces", "writes the surfaces of tissues, closed and smooth; neighbouring tissues share their borders");
  auto options = std::make_shared<SurfacesOptions>();
  command->add_option("VOLUME", options->volume, "label volume")->required();
  command->add_option("--tissues", options->tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command->add_option("--only", options->choice.tissues, "write only these tissues, by name or label (default: all)")
      ->delimiter(',')
      ->type_name("A,B");
  command
      ->add_option(
          "--relax", options->choice.settings.relaxations,
          "number of smoothing steps (default: 5); more steps are smoother, but thin parts lose volume; 0 keeps the "
          "voxels' faces and volumes")
      ->check(CLI::Range(0, 1000));
  writes(command->add_option("-o,--output", options->output,
                             "OUT.obj or OUT.glb (one file), OUT.stl or OUT.ply (one file per tissue: OUT-NAME.stl)"),
         files_of_surfaces)
      ->required();
  command
      ->add_option("--progress", options->progress,
                   "with the value json: print progress to stderr, one line of JSON per step (default: a progress bar)")
      ->check(CLI::IsMember({"json"}));
  command->callback([options] {
    check_place(options->output);
    CommandProgress progress(options->progress);
    const VolumeFile file = read_volume(options->volume, progress);
    warn(file.warnings);
    const TissueTable tissues = tissues_of(file, options->tissues);
    require_labels(file.volume, tissues, options->volume);
    write_surfaces_of(file.volume, tissues, options->choice, options->output, progress);
  });
}

}  // namespace limber::cmd
