// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/cell_result.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

template <class T>
std::optional<T> optional_of(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? std::optional(json[key].get<T>()) : std::nullopt;
}
glm::dvec3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

void read_body(const Json& json, CellResult& result) {
  for (const Json& row : json.value("tissues", Json::array()))
    result.tissues.push_back({row.at("label"), row.at("name"), row.at("voxels_before"), row.at("voxels_after"),
                              optional_of<double>(row, "volume_change_percent"),
                              optional_of<double>(row, "mass_change_percent"), row.at("components_before"),
                              row.at("components_after"), row.value("overlap_voxels", std::int64_t{0})});
  const Json& total = json.at("total");
  result.voxels_before = total.at("voxels_before");
  result.voxels_after = total.at("voxels_after");
  result.volume_percent = total.value("volume_change_percent", 0.0);
  result.mass_percent = total.value("mass_change_percent", 0.0);
  for (const auto& [key, to] : {std::pair{"overlap_voxels", &result.overlap_voxels},
                                {"bone_overlap_voxels", &result.bone_overlap_voxels},
                                {"new_hole_voxels", &result.new_hole_voxels},
                                {"dropped_voxels", &result.dropped_voxels},
                                {"trapped_air_voxels", &result.trapped_air_voxels},
                                {"mended_voxels", &result.mended_voxels}})
    *to = total.value(key, std::int64_t{0});
  if (json.contains("mass_exact")) result.mass_exact_voxels = json["mass_exact"].at("changed_voxels");
  if (json.contains("skin")) {
    result.skin_share_before = json["skin"].at("surface_share_before");
    result.skin_share_after = json["skin"].at("surface_share_after");
  }
  for (const Json& bone : json.value("bones", Json::array()))
    if (const double residual = bone.at("rigid_residual_mm");
        !result.bone_residual_mm || residual > *result.bone_residual_mm) {
      result.bone_residual_mm = residual;
      result.worst_bone = bone.at("name");
    }
}

void read_solve(const Json& json, CellResult& result) {
  if (json.contains("mesh")) {
    const Json& mesh = json["mesh"];
    result.mesh = {mesh.at("tets"),
                   mesh.at("nodes"),
                   mesh.at("inverted"),
                   mesh.at("min_det_f"),
                   optional_of<std::int64_t>(mesh, "self_intersections"),
                   optional_of<double>(mesh, "min_gap_mm"),
                   optional_of<double>(mesh, "median_gap_mm")};
  }
  if (json.contains("solve")) {
    const Json& solve = json["solve"];
    result.solve = {solve.at("converged"), solve.at("reached"), solve.value("blocked_by", ""), solve.at("iterations"),
                    solve.at("residual")};
  }
}
}  // namespace

std::vector<QualityGate> gates_of(const std::string& report, const QualityLimits& limits) {
  return all_gates(report, limits);
}

std::optional<bool> label_passes(const TissueFigures& tissue, const QualityLimits& limits) {
  if (tissue.voxels_before < limits.least_voxels || !tissue.volume_percent) return {};
  return std::abs(*tissue.volume_percent) <= limits.tissue_percent;
}

CellResult read_result(const Study& study, const CellOutcome& outcome) {
  CellResult result{.cell = outcome.cell, .folder = outcome.folder, .failure = outcome.failure};
  if (!result.done()) return result;
  result.report = read_file(outcome.folder / "report.json");
  result.cell_json = read_file(outcome.folder / "cell.json");
  try {
    const Json report = Json::parse(checked_json(result.report, outcome.folder.string())),
               cell = Json::parse(checked_json(result.cell_json, outcome.folder.string()));
    result.cpu_seconds = cell.at("cpu_seconds");
    result.wall_seconds = cell.at("wall_seconds");
    result.cpu_repeats = {result.cpu_seconds};
    if (cell.contains("repeats")) result.cpu_repeats = cell["repeats"].at("cpu_seconds").get<std::vector<double>>();
    if (result.cpu_repeats.empty()) result.cpu_repeats = {result.cpu_seconds};
    result.machine = cell.at("machine");
    result.peak_memory_mb = report.at("peak_memory_mb");
    for (const auto& [stage, value] : report.at("seconds").items()) result.seconds[stage] = value;
    read_body(report, result);
    read_solve(report, result);
    for (const Json& row : report.value("joints", Json::array()))
      result.joints.push_back({row.at("bone"), row.at("degrees"), vector_of(row.at("axis")), vector_of(row.at("head")),
                               vector_of(row.at("tail")), vector_of(row.at("parent_head")),
                               optional_of<double>(row, "excess_degrees")});
    for (const Json& input : report.value("inputs", Json::array()))
      result.inputs[input.at("path")] = input.at("sha256");
    result.warnings = report.value("warnings", std::vector<std::string>{});
  } catch (const Json::exception& error) {
    throw Error("a result of the study is damaged", outcome.folder.string(),
                std::string("delete the folder and run the same command again (") + error.what() + ")");
  }
  result.gates = gates_of(result.report, study.gates);
  return result;
}

std::optional<double> weights_seconds(const Path& out, const CellResult& cell) {
  for (const auto& [path, hash] : cell.inputs) {
    if (!path.ends_with("weights.nrrd")) continue;
    const Path file = out / "bodies" / Path(path).parent_path().filename() / "body.json";
    if (!std::filesystem::exists(file)) return {};
    const Json json = Json::parse(sound_json(read_file(file)), nullptr, false);
    if (json.is_object() && json.contains("cpu_seconds")) return json["cpu_seconds"].value("weights", 0.0);
  }
  return {};
}

}  // namespace limber
