// SPDX-License-Identifier: AGPL-3.0-or-later
// limber info FILE [--json]: prints a description of a file. Each kind of file is described once, as JSON; without
// --json the same description is printed as text.
#include <cmath>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/bake/baked_joint_io.h"
#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/cmd/command.h"
#include "core/cmd/info_project.h"
#include "core/cmd/info_rig.h"
#include "core/project/project_io.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_io.h"
#include "core/volume_io/volume_reader.h"

namespace limber::cmd {

namespace {
using Json = nlohmann::ordered_json;

Json as_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// Returns whole numbers as integers, so that they are written without a decimal point.
Json as_json(double value) {
  if (value == std::floor(value) && std::abs(value) < 9e15) return static_cast<std::int64_t>(value);
  return value;
}

// Describes how the process that parses volume files is protected against hostile files.
Json describe_reader() {
  const Protection reader = reader_protection();
  return {{"own_process", reader.own_process},
          {"system_calls_filtered", reader.system_calls},
          {"landlock", reader.landlock}};
}

Json describe_volume(const Path& path) {
  VolumeSummary summary = summarize_volume(path);
  warn(summary.warnings);
  const Grid& grid = summary.grid;
  Json direction = Json::array();
  for (int row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis) direction.push_back(grid.direction[axis][row]);
  Json json = {{"kind", "volume"},
               {"size", {grid.size.x, grid.size.y, grid.size.z}},
               {"spacing", as_json(grid.spacing)},
               {"origin", as_json(grid.origin)},
               {"direction", direction},
               {"type", summary.type.voxel_type},
               {"format", summary.type.format},
               {"compressed", summary.type.compressed},
               {"reader", describe_reader()}};
  if (summary.looks_grey) json["grey"] = true;
  json["minimum"] = as_json(summary.minimum);
  json["maximum"] = as_json(summary.maximum);
  if (!summary.is_label) return json;
  json["labels"] = Json::array();
  for (const auto& count : summary.labels) {
    Json label = {{"value", as_json(count.value)}, {"voxels", count.voxels}};
    if (!count.name.empty()) label["name"] = count.name;
    json["labels"].push_back(std::move(label));
  }
  return json;
}

Json describe_tissues(const Path& path) {
  const TissueTable table = read_tissue_table(path);
  Json labels = Json::array();
  for (const Tissue& tissue : table.tissues)
    labels.push_back({{"value", as_json(tissue.file_value)}, {"name", tissue.name}, {"kind", to_string(tissue.kind)}});
  return {{"kind", "tissues"}, {"labels", labels}};
}

Json describe_weights(const Path& path) {
  const WeightsSummary weights = summarize_weights(path);
  const Json bones = Json::parse(checked_json(weights.bones, path.string()), nullptr, false);
  if (!bones.is_array())
    throw Error("the weights name no bones", path.string(), "compute the weights again with `limber weights`");
  return {{"kind", "weights"}, {"bones", bones}, {"voxels", weights.voxels}};
}

Json describe_baked_joint(const Path& path) {
  const BakedJoint joint = read_baked_joint(path);
  const auto errors = [](const std::vector<BakeError>& given) {
    Json list = Json::array();
    for (const BakeError& error : given)
      list.push_back({{"degrees", error.degrees},
                      {"flesh_95_mm", error.flesh_mm},
                      {"skin_95_mm", error.skin_mm},
                      {"largest_mm", error.largest_mm}});
    return list;
  };
  return {{"kind", "baked joint"},
          {"bone", joint.bone},
          {"axis", as_json(joint.axis)},
          {"baked_at_degrees", joint.degrees},
          {"quality", joint.quality},
          {"contact", joint.contact},
          {"glide", joint.glide},
          {"nodes", joint.nodes.size()},
          {"errors_baked", errors(joint.at_baked)},
          {"errors_between", errors(joint.between)}};
}

Json describe(const Path& path) {
  if (is_project(path) || path.extension() == ".limber") return Json::parse(describe_project(path));
  if (is_tissue_table(path)) return describe_tissues(path);
  if (path.extension() == ".json" || is_rig_or_motion(path)) return Json::parse(describe_rig_or_motion(path));
  if (path.extension() == kBakeEnding) return describe_baked_joint(path);
  if (is_weights_path(path)) return describe_weights(path);
  return describe_volume(path);
}
}  // namespace

void add_info(CLI::App& app) {
  struct Options {
    std::string file;
    bool json = false;
  };
  auto* command = app.add_subcommand("info", "prints what a file contains: header, labels, bones, joints");
  auto options = std::make_shared<Options>();
  command
      ->add_option(
          "FILE", options->file,
          "a volume, a folder with DICOM images, a rig, motion, weights, baked joint, mesh, label table or project")
      ->required();
  command->add_flag("--json", options->json, "print as JSON");
  command->callback([options] {
    print_description(describe(options->file).dump(-1, ' ', false, Json::error_handler_t::replace), options->json);
  });
}

}  // namespace limber::cmd
