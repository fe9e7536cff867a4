// SPDX-License-Identifier: AGPL-3.0-or-later
// limber prepare IN -o OUT [--orient CODE] [--flip x|y|z] [--merge A=B ...] [--spacing MM] [--drop-specks N] [--crop]
//        [--pad N] [--statistics CSV] [--tissues T] [--seams SEAMS.nrrd --rig RIG]
#include "core/volume/prepare.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/bones/bone_parts.h"
#include "core/cmd/command.h"
#include "core/rig/armature_io.h"
#include "core/seams/find_seams.h"
#include "core/seams/seams_io.h"
#include "core/volume/volume_io.h"

namespace limber::cmd {

namespace {
struct Options {
  std::string in, out, tissues, statistics, orientation, flip, seams, rig;
  std::vector<std::string> merges;
  std::optional<double> spacing;
  std::int64_t specks = 0;
  bool crop = false;
  int pad = 0;
  RunOptions run;
};

// A tissue by the value it has in files, or by its name.
const Tissue& tissue_of(const TissueTable& tissues, const std::string& text, const std::string& merge) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size())
    if (const Tissue* tissue = tissues.find_file_value(value)) return *tissue;
  for (const Tissue& tissue : tissues.tissues)
    if (tissue.name == text) return tissue;
  throw Error("the volume has no such label", "--merge " + merge + ", " + text, "name a value or a tissue that 'limber info' lists");
}

// A=B: every A becomes B.
void merge(LabelVolume& volume, TissueTable& tissues, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw Error("this is no pair of labels", "--merge " + text, "write A=B: every A becomes B");
  const Label from = tissue_of(tissues, text.substr(0, equals), text).label;
  const std::string into = text.substr(equals + 1);
  const Label target = into == "0" || into == "air" ? Label{0} : tissue_of(tissues, into, text).label;
  if (from == target) return;
  volume = merge_labels(volume, from, target);
  std::erase_if(tissues.tissues, [&](const Tissue& tissue) { return tissue.label == from; });
}

// Only what is still there, so that the file names no label it lacks.
void keep_present(TissueTable& tissues, const LabelVolume& volume) {
  std::vector<bool> present(65536, false);
  for (Label label : volume.voxels) present[label] = true;
  std::erase_if(tissues.tissues, [&](const Tissue& tissue) { return !present[tissue.label]; });
}

// Of the volume as it is written, in the rig's world.
void write_seams_found(const LabelVolume& volume, const TissueTable& tissues, const Options& options, Progress& progress) {
  const ArmatureFile rig = read_armature_file(options.rig);
  warn(rig.warnings);
  const TissueVoxels tissue(volume);
  const BoneParts parts = split_bones(volume, tissue, tissues, rig.armature, progress);
  const Seams seams = find_seams(volume, tissue, tissues, rig.armature, parts, progress);
  write_seams(seams, volume.grid, options.seams);
  std::printf("seams: %lld voxel faces between limbs that touch\n", static_cast<long long>(seams.size()));
}

void prepare(const Options& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  check_writable(options.out);
  if (!options.statistics.empty()) check_place(options.statistics);
  if (!options.seams.empty()) check_writable(options.seams);
  check_distinct({options.out, options.statistics, options.seams});
  VolumeFile file = read_volume(options.in, progress);
  warn(file.warnings);
  TissueTable user;
  if (!options.tissues.empty()) user = read_tissue_table(options.tissues);
  TissueTable tissues = merge_tissue_tables(file.tissues, options.tissues.empty() ? nullptr : &user);

  LabelVolume& volume = file.volume;
  if (!options.orientation.empty()) volume = reorient(volume, options.orientation);
  if (!options.flip.empty()) volume = flip(volume, options.flip[0] - 'x');
  for (const std::string& text : options.merges) merge(volume, tissues, text);
  if (options.spacing) volume = regrid(volume, glm::dvec3(*options.spacing), progress);
  if (options.specks > 0) volume = drop_specks(volume, options.specks);
  if (options.crop) volume = crop_to_tissue(volume);
  if (options.pad > 0) volume = pad(volume, options.pad);
  keep_present(tissues, volume);

  progress.update("write", 0);
  write_volume(volume, options.out, tissues, file.type);
  if (!options.seams.empty()) write_seams_found(volume, tissues, options, progress);
  if (!options.statistics.empty()) write_file_atomically(options.statistics, to_csv(label_statistics(volume), tissues));
  progress.update("write", 1);
}
}  // namespace

void add_prepare(CLI::App& app) {
  auto* command = app.add_subcommand(
      "prepare",
      "makes a label volume ready; whatever is asked is done in this order: --orient, --flip, --merge, --spacing, "
      "--drop-specks, --crop, --pad, --seams, --statistics");
  auto options = std::make_shared<Options>();
  command->add_option("IN", options->in, "label volume")->required();
  command->add_option("-o,--output", options->out, "label volume to write; its format by extension")->required();
  command->add_option("--tissues", options->tissues, "label table with names and densities");
  command->add_option("--orient", options->orientation, "turn voxel axes to these directions exactly: LPS, RAS ...");
  command->add_option("--flip", options->flip, "mirror the body along a world axis")->check(CLI::IsMember({"x", "y", "z"}));
  command->add_option("--merge", options->merges, "A=B: every A becomes B; values in the file, or names; 0 is air (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--spacing", options->spacing, "new size of a voxel in mm, by largest volume share; thin layers stay closed");
  command->add_option("--drop-specks", options->specks, "pieces of fewer voxels than this take the label around them")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--crop", options->crop, "take away air around the tissue");
  command->add_option("--pad", options->pad, "voxels of air to put on every side")->check(CLI::NonNegativeNumber);
  auto* seams = command->add_option("--seams", options->seams, "finds where limbs touch without being one (hand on hip, thigh on thigh) and writes the faces between them as a label volume: 1 towards x, 2 towards y, 4 towards z, summed");
  auto* rig = command->add_option("--rig", options->rig, "seams: the rig that says what the limbs are");
  seams->needs(rig);
  rig->needs(seams);
  command->add_option("--statistics", options->statistics, "CSV file: per label voxels, volume, mass, centre, box, pieces, surface");
  add_run_options(*command, options->run);
  command->callback([options] { prepare(*options); });
}

}  // namespace limber::cmd
