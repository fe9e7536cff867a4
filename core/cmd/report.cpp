// SPDX-License-Identifier: AGPL-3.0-or-later
// limber report BEFORE AFTER [--tissues T] [--field F.nrrd [--rig RIG [--bone-map FILE] POSE-OPTIONS]] [--strict]
// [--json]: measures what changed between two volumes.
#include "core/report/report.h"

#include <memory>

#include "core/bones/input_doubts.h"
#include "core/cmd/command.h"
#include "core/cmd/pose_options.h"
#include "core/report/dice.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/grey_image.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

namespace {
constexpr double kSamePlaceMm = 1e-3;

// Makes the labels of a volume match those of `table`. A label of `file` changes to the label that `table` has for the
// same file value. Tissues whose file value `table` lacks are added to `table` with a new label.
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

struct ReportOptions {
  std::string before, after, tissues, field, rig, bone_map;
  PoseOptions pose;
  bool json = false, strict = false;
};

void note(Report& report, const std::vector<std::string>& warnings) {
  warn(warnings);
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
}

VectorVolume read_field(const std::string& path, const LabelVolume& after, Report& report) {
  VectorVolume field = read_vector_volume(path);
  report.inputs.push_back(describe_input(path));
  note(report, field.warnings);
  if (field.grid.size != after.grid.size || glm::distance(field.grid.origin, after.grid.origin) > kSamePlaceMm ||
      glm::distance(field.grid.spacing, after.grid.spacing) > kSamePlaceMm)
    throw Error("the field and the posed volume have different grids", path,
                "give the field that was written with this volume");
  return field;
}

// Measures, for the report, all figures that need the displacement field, and those that need rig and pose if these are
// given.
void measure_with_field(const ReportOptions& options, const LabelVolume& before, const LabelVolume& after,
                        const TissueTable& tissues, Report& report) {
  JudgedPose judged{.rest = before, .posed = after, .tissues = tissues};
  const VectorVolume field = read_field(options.field, after, report);
  judged.displacement = {field.voxels.data(), field.voxels.size()};
  ArmatureFile rig;
  BoneMap map;
  if (!options.rig.empty()) {
    rig = read_armature_file(options.rig);
    report.inputs.push_back(describe_input(options.rig));
    note(report, rig.warnings);
    report.doubts = input_doubts(before, tissues, rig.armature);
    note(report, *report.doubts);
    const Pose pose = read_pose_options(options.pose, rig.armature);
    report.joints = turned_joints(rig.armature, pose);
    judged.armature = &rig.armature;
    judged.asked = judged.applied = posed_from_rest(rig.armature, pose);
    if (!options.bone_map.empty()) map = read_bone_map(options.bone_map);
  }
  measure_body(judged, map, report);
}

void run_report(const ReportOptions& options) {
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
  require_labels(before.volume, tissues, options.before);
  require_labels(after.volume, merge_tissue_tables(after.tissues, user ? &*user : nullptr), options.after);
  report.seconds.read = total.seconds();
  for (const VolumeFile* file : {&before, &after}) note(report, file->warnings);

  report.metrics = compare(before.volume, after.volume, tissues);
  if (!options.field.empty()) measure_with_field(options, before.volume, after.volume, tissues, report);
  else measure_body({.rest = before.volume, .posed = after.volume, .tissues = tissues}, {}, report);
  if (before.volume.grid == after.volume.grid) report.dice = dice_by_label(before.volume, after.volume);
  progress.update("report", 1);
  report.seconds.total = total.seconds();
  judge(report);
  if (options.json) print_json(to_json(report));
  else print_table(report);
  if (!options.strict) return;
  tell_failed_gates(failed_gates(report));
  if (!failed_gates(report).empty()) throw GateFailed();
}
}  // namespace

void add_report(CLI::App& app) {
  auto* command = app.add_subcommand("report", "reports what changed between two label volumes");
  auto options = std::make_shared<ReportOptions>();
  command->add_option("BEFORE", options->before, "label volume")->required();
  command->add_option("AFTER", options->after, "label volume")->required();
  command->add_option("--tissues", options->tissues, "tissue table: names, kinds, densities");
  auto* field =
      command
          ->add_option("--field", options->field,
                       "the displacement at each voxel of AFTER, from rest to posed or from posed to rest, as "
                       "`limber resample --field` writes it; adds a check for deep tissue that is now at "
                       "the surface")
          ->type_name("F.nrrd");
  auto* rig = command
                  ->add_option("--rig", options->rig,
                               "with --field: the rig; adds checks of bones, limbs and bands (tissue stretched between "
                               "parts of the body); also give the pose, as for resample")
                  ->needs(field);
  command
      ->add_option("--bone-map", options->bone_map,
                   "JSON file that says which rig bone each bone label follows, as for resample")
      ->type_name("FILE")
      ->needs(rig);
  add_pose_options(*command, options->pose);
  command->add_flag("--strict", options->strict, "exit with code 5 when a quality gate fails");
  command->add_flag("--json", options->json, "print the report as JSON (schema limber-report/1)");
  command->callback([options] { run_report(*options); });
}

}  // namespace limber::cmd
