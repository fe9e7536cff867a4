// SPDX-License-Identifier: AGPL-3.0-or-later
// limber prepare IN -o OUT [--from-ct [--thresholds BODY,FAT,SOFT,BONE]] [--orient CODE] [--flip x|y|z]
//   [--merge A=B ...] [--spacing MM] [--drop-specks N] [--crop] [--pad N] [--close-skin inward|outward [--skin-label
//   L]] [--statistics CSV] [--tissues T]
//   [--seams SEAMS.nrrd --rig RIG]: prepares a label volume for posing.
#include "core/prepare/prepare.h"
#include "core/volume_io/grey_image.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/bones/bone_parts.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/prepare/close_skin.h"
#include "core/prepare/ct_labels.h"
#include "core/rig_io/rig_io.h"
#include "core/seams/find_seams.h"
#include "core/seams/seams_io.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

namespace {
struct PrepareOptions {
  std::string in, out, tissues, statistics, orientation, flip, seams, rig, close_skin, skin_label;
  std::vector<std::string> merges;
  bool from_ct = false;
  std::vector<double> thresholds;
  std::optional<double> spacing;
  std::int64_t specks = 0;
  bool crop = false;
  int pad = 0;
  RunOptions run;
};

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// Finds a tissue by its value in the volume's file or by its name. Returns nullptr when there is none.
const Tissue* find_tissue(const TissueTable& tissues, const std::string& text) {
  if (const auto value = number_of(text))
    if (const Tissue* tissue = tissues.find_file_value(*value)) return tissue;
  for (const Tissue& tissue : tissues.tissues)
    if (tissue.name == text) return &tissue;
  return nullptr;
}

const Tissue& tissue_of(const TissueTable& tissues, const std::string& text, const std::string& merge) {
  if (const Tissue* tissue = find_tissue(tissues, text)) return *tissue;
  throw Error("the volume has no such label", "--merge " + merge + ", " + text,
              "name a value or a tissue that 'limber info' lists");
}

// Merges two labels as the option A=B says: every voxel of A becomes B.
void merge(LabelVolume& volume, TissueTable& tissues, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw Error("this is not a pair of labels", "--merge " + text, "write A=B: every A becomes B");
  const Label from = tissue_of(tissues, text.substr(0, equals), text).label;
  const std::string into = text.substr(equals + 1);
  const Label target = into == "0" || into == "air" ? Label{0} : tissue_of(tissues, into, text).label;
  if (from == target) return;
  volume = merge_labels(volume, from, target);
  std::erase_if(tissues.tissues, [&](const Tissue& tissue) { return tissue.label == from; });
}

// Returns the label for new skin voxels. If `text` is empty, returns nothing: new skin gets the label of the nearest
// skin. If `text` is a whole number that is no tissue's value, adds a new tissue.
std::optional<Label> skin_label_of(TissueTable& tissues, const std::string& text) {
  if (text.empty()) return std::nullopt;
  if (const Tissue* tissue = find_tissue(tissues, text)) {
    if (is_bone(tissue->kind)) throw Error("bone cannot be skin", "--skin-label " + text, "name a label of skin");
    return tissue->label;
  }
  const auto value = number_of(text);
  if (!value || *value < 1 || *value > 65535 || *value != std::floor(*value))
    throw Error("the volume has no such label", "--skin-label " + text,
                "name a tissue that 'limber info' lists, or a number from 1 to 65535");
  Tissue skin;
  for (skin.label = static_cast<Label>(*value); tissues.find(skin.label) || skin.label == 0;) ++skin.label;
  skin.file_value = *value;
  skin.name = "Skin";
  skin.kind = TissueKind::Skin;
  apply_kind_defaults(skin);
  const auto after = std::find_if(tissues.tissues.begin(), tissues.tissues.end(),
                                  [&](const Tissue& tissue) { return tissue.label > skin.label; });
  return tissues.tissues.insert(after, skin)->label;
}

void print_by_tissue(const std::vector<std::int64_t>& voxels, const TissueTable& tissues) {
  const char* between = "";
  for (const Tissue& tissue : tissues.tissues) {
    if (voxels[tissue.label] == 0) continue;
    print("%s%s %lld", between, one_line(tissue.name).c_str(), static_cast<long long>(voxels[tissue.label]));
    between = ", ";
  }
}

void warn_of_cuts(const ClosedSkin& closed) {
  constexpr std::array kSides{"lowest x", "highest x", "lowest y", "highest y", "lowest z", "highest z"};
  for (int side = 0; side < 6; ++side)
    if (closed.cut[side] > 0)
      warn({"skin: the body is cut by the volume's border at the " + std::string(kSides[side]) + " (" +
            std::to_string(closed.cut[side]) +
            " voxels that are not skin) and stays open there; if the body ends there, add air with --pad 1"});
}

LabelVolume with_closed_skin(const LabelVolume& volume, TissueTable& tissues, const PrepareOptions& options) {
  const bool inward = options.close_skin == "inward";
  const auto label = skin_label_of(tissues, options.skin_label);
  ClosedSkin closed = close_skin(volume, tissues, inward ? SkinGrowth::Inward : SkinGrowth::Outward, label);
  warn_of_cuts(closed);
  print(inward ? "skin: %lld voxels of flesh at the air became skin" : "skin: %lld voxels of air became skin",
        static_cast<long long>(closed.changed_voxels));
  if (closed.changed_voxels > 0) {
    print(inward ? " (" : ", over voxels of ");
    print_by_tissue(closed.covered, tissues);
    print(inward ? ")" : "");
  }
  print("\n");
  if (closed.bare_bone_voxels > 0)
    print("skin: %lld voxels of bone touch the air and stay bone; --close-skin outward covers them\n",
          static_cast<long long>(closed.bare_bone_voxels));
  if (closed.is_padded) print("skin: the volume was grown by one voxel on every side to hold the skin\n");
  if (closed.enclosed_voxels > 0)
    print("skin: the new skin encloses %lld voxels of air\n", static_cast<long long>(closed.enclosed_voxels));
  return std::move(closed.volume);
}

// Removes tissues without voxels in the volume, so that the written file lists no label without voxels.
void keep_present(TissueTable& tissues, const LabelVolume& volume) {
  std::vector<bool> present(65536, false);
  for (Label label : volume.voxels) present[label] = true;
  std::erase_if(tissues.tissues, [&](const Tissue& tissue) { return !present[tissue.label]; });
}

// Finds the seams of the prepared volume and writes them to a file.
void write_seams_found(const LabelVolume& volume, const TissueTable& tissues, const PrepareOptions& options,
                       Progress& progress) {
  const ArmatureFile rig = read_armature_file(options.rig);
  warn(rig.warnings);
  const TissueVoxels tissue(volume);
  const BoneParts parts = split_bones(volume, tissue, tissues, rig.armature, progress);
  const Seams seams = find_seams(volume, tissue, tissues, rig.armature, parts, progress);
  write_seams(seams, volume.grid, options.seams);
  print("seams: %lld voxel faces between limbs that touch\n", static_cast<long long>(seams.size()));
}

// Returns the labels that thresholds make of a CT, as if they had been read from a file.
VolumeFile labels_of(const PrepareOptions& options, Progress& progress) {
  CtThresholds thresholds;
  if (!options.thresholds.empty()) {
    thresholds.body = options.thresholds[0];
    thresholds.fat = options.thresholds[1];
    thresholds.soft = options.thresholds[2];
    thresholds.bone = options.thresholds[3];
  }
  const GreyVolume ct = read_grey_volume(options.in, progress);
  CtLabels labels = labels_of_ct(grey_levels(ct.grid, ct.voxels), thresholds, progress);
  print(
      "labels: made from densities; contrast agent and metal count as bone, and bones that touch are not separated\n");
  return {std::move(labels.volume), std::move(labels.tissues), {"NRRD", "uint8", true}, ct.warnings};
}

void prepare(const PrepareOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  check_writable(options.out);
  if (!options.statistics.empty()) check_place(options.statistics);
  if (!options.seams.empty()) check_writable(options.seams);
  VolumeFile file = options.from_ct ? labels_of(options, progress) : read_volume(options.in, progress);
  warn(file.warnings);
  TissueTable user;
  if (!options.tissues.empty()) user = read_tissue_table(options.tissues);
  TissueTable tissues = merge_tissue_tables(file.tissues, options.tissues.empty() ? nullptr : &user);
  if (!options.from_ct) require_labels(file.volume, tissues, options.in);

  LabelVolume& volume = file.volume;
  if (!options.orientation.empty()) volume = reorient(volume, options.orientation);
  if (!options.flip.empty()) volume = flip(volume, options.flip[0] - 'x');
  for (const std::string& text : options.merges) merge(volume, tissues, text);
  if (options.spacing) volume = regrid(volume, glm::dvec3(*options.spacing), progress);
  if (options.specks > 0) volume = drop_specks(volume, options.specks);
  if (options.crop) volume = crop_to_tissue(volume);
  if (options.pad > 0) volume = pad(volume, options.pad);
  if (!options.close_skin.empty()) volume = with_closed_skin(volume, tissues, options);
  keep_present(tissues, volume);

  progress.update("write", 0);
  write_volume(volume, options.out, tissues, file.type);
  if (!options.seams.empty()) write_seams_found(volume, tissues, options, progress);
  if (!options.statistics.empty()) write_file_atomically(options.statistics, to_csv(label_statistics(volume), tissues));
  progress.update("write", 1);
}
}  // namespace

void add_prepare(CLI::App& app) {
  auto* command =
      app.add_subcommand("prepare",
                         "prepares a label volume; the options are applied in this order: --from-ct, --orient, --flip, "
                         "--merge, --spacing, --drop-specks, --crop, --pad, --close-skin, --seams, --statistics");
  auto options = std::make_shared<PrepareOptions>();
  command->add_option("IN", options->in, "label volume; with --from-ct: a CT")->required();
  writes(command->add_option("-o,--output", options->out, "label volume to write; its extension selects the format"))
      ->required();
  auto* from_ct = command->add_flag("--from-ct", options->from_ct,
                                    "IN is a CT: makes labels for skin, fat, soft tissue, lung, gas and bone by "
                                    "thresholds; leaves out the table and other thin things around the body");
  command
      ->add_option(
          "--thresholds", options->thresholds,
          "with --from-ct: smallest values, in Hounsfield units, of the body, fat, soft tissue and bone (default: "
          "-300,-190,-30,200)")
      ->delimiter(',')
      ->expected(4)
      ->type_name("BODY,FAT,SOFT,BONE")
      ->needs(from_ct);
  command->add_option("--tissues", options->tissues, "label table with names and densities");
  command->add_option("--orient", options->orientation, "reorient the voxel axes, without resampling: LPS, RAS ...");
  command->add_option("--flip", options->flip, "mirror the body along a world axis")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command
      ->add_option("--merge", options->merges,
                   "merge tissue A into tissue B, written as A=B; A and B are label values of the file, or names; 0 is "
                   "air (repeatable)")
      ->allow_extra_args(false);
  command->add_option("--spacing", options->spacing,
                      "resample to cubic voxels of this size, mm: a voxel gets the label with the largest share; thin "
                      "layers stay closed");
  command
      ->add_option("--drop-specks", options->specks,
                   "replace pieces with fewer voxels than this by the label around them")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--crop", options->crop, "crop the volume to the tissue, by removing the air around it");
  command->add_option("--pad", options->pad, "number of voxels of air to add on every side")
      ->check(CLI::NonNegativeNumber);
  auto* close = command
                    ->add_option("--close-skin", options->close_skin,
                                 "adds a closed skin of one voxel where soft tissue touches the outside air: inward "
                                 "turns the outermost tissue into skin, outward the air next to it; bone and enclosed "
                                 "air do not change, and the skin stays open where the volume's border cuts the body")
                    ->check(CLI::IsMember({"inward", "outward"}));
  command
      ->add_option(
          "--skin-label", options->skin_label,
          "with --close-skin: label value or name that new skin gets (default: the nearest tissue that is skin)")
      ->needs(close);
  auto* seams = writes(command->add_option(
      "--seams", options->seams,
      "finds where limbs touch without being connected (hand on hip, thigh on thigh) and writes "
      "the faces between them as a label volume: a voxel has the sum of 1, 2 and 4 for faces towards x, y and z"));
  auto* rig = command->add_option("--rig", options->rig, "with --seams: the rig whose bones define the limbs");
  seams->needs(rig);
  rig->needs(seams);
  writes(command->add_option("--statistics", options->statistics,
                             "CSV file to write: voxels, volume, mass, centre, bounding box, number of pieces and "
                             "surface area of each label"));
  add_run_options(*command, options->run);
  command->callback([options] { prepare(*options); });
}

}  // namespace limber::cmd
