// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/session_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/report/fem_measures.h"
#include "core/report/report.h"
#include "core/study/html_report.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace {

using Json = nlohmann::json;

Technique technique_of(const Result& result, const Json& report) {
  const Json settings = report.is_object() ? report.value("settings", Json::object()) : Json::object();
  const bool exact = settings.is_object() && settings.value("mass_exact", Json(false)) == Json(true);
  const std::vector<Technique> found = techniques_of({result.method + (exact ? "-mass-exact" : "")}, result.name);
  return found.front();
}

// Returns a volume that marks overlaps: 1 at voxels to which the pose moves two separate pieces of tissue, 2 at voxels
// to which it moves two bones.
LabelVolume volume_of(const Overlap& overlap, const Grid& grid) {
  LabelVolume marks{grid, ZeroedVector<Label>(static_cast<std::size_t>(grid.voxel_count()))};
  for (const std::int64_t voxel : overlap.tissue) marks.voxels[static_cast<std::size_t>(voxel)] = 1;
  for (const std::int64_t voxel : overlap.bones) marks.voxels[static_cast<std::size_t>(voxel)] = 2;
  return marks;
}

// Returns, for each voxel of tissue, the volume ratio of the tet that contains the voxel, coded by code_of_ratio(). The
// ratio is 1 outside of all tets, since tissue there moves rigidly with its bone.
LabelVolume ratios_of(const SolvedMesh& solved, const LabelVolume& volume) {
  const TissueVoxels tissue(volume);
  const std::vector<std::int32_t> tets = tets_of_voxels(solved.mesh.tets.T, solved.V, volume.grid, tissue);
  const std::vector<float> ratio = fem_measure(FemMeasure::VolumeRatio, solved.mesh, solved.V);
  LabelVolume codes{volume.grid, ZeroedVector<Label>(volume.voxels.size())};
  const glm::ivec3 size = volume.grid.size;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const std::int32_t tet = tets[static_cast<std::size_t>(place)];
    const float value =
        tet < 0 || std::isnan(ratio[static_cast<std::size_t>(tet)]) ? 1 : ratio[static_cast<std::size_t>(tet)];
    codes.voxels[static_cast<std::size_t>((std::int64_t{v.z} * size.y + v.y) * size.x + v.x)] = code_of_ratio(value);
  });
  return codes;
}

// Writes a result of the session to a folder, in the same files in which a study stores a cell (one spacing, pose and
// technique). The page can then be made by the functions that make a study's page.
void write_cell(const SessionResult& one, const TissueTable& tissues, const Path& folder) {
  const Result& result = *one.result;
  std::filesystem::create_directories(folder);
  const TissueTable& table = result.from_tissues ? *result.from_tissues : tissues;
  write_volume(*result.volume, folder / "posed.nrrd", table, {"NRRD", "uint16", false});
  write_tissue_table(table, folder / "tissues.json");
  if (result.overlap)
    write_volume(volume_of(*result.overlap, result.volume->grid), folder / "overlap.nrrd", {},
                 {"NRRD", "uint8", false});
  if (result.solved)
    write_volume(ratios_of(*result.solved, *result.volume), folder / "ratio.nrrd", {}, {"NRRD", "uint8", false});
  write_file_atomically(folder / "report.json", result.report);
  const double seconds = method_seconds(result.report);
  write_file_atomically(folder / "cell.json",
                        Json{{"cpu_seconds", seconds}, {"wall_seconds", seconds}, {"machine", ""}}.dump());
}

template <class T>
int index_of(std::vector<T>& all, const T& one) {
  const auto found = std::find(all.begin(), all.end(), one);
  if (found != all.end()) return static_cast<int>(found - all.begin());
  all.push_back(one);
  return static_cast<int>(all.size()) - 1;
}

}  // namespace

std::string session_page(const SessionPage& session, const Path& scratch, const StartPictures& start,
                         Progress& progress) {
  Study study{.name = session.name, .volume = session.name, .spacings = {std::nullopt}};
  std::vector<std::string> poses;
  std::vector<CellOutcome> outcomes;
  std::set<std::pair<int, int>> taken;
  for (const SessionResult& one : session.results) {
    progress.update("results", double(outcomes.size()) / double(session.results.size()));
    const Json report = Json::parse(sound_json(one.result->report), nullptr, false);
    const int technique = index_of(study.techniques, technique_of(*one.result, report));
    // If the page already has a result of this pose and technique, made with other settings or another rig, appends a
    // number to the pose's name.
    int pose = index_of(poses, one.pose);
    for (int again = 2; !taken.insert({pose, technique}).second; ++again)
      pose = index_of(poses, one.pose + " (" + std::to_string(again) + ")");
    const Path folder = scratch / std::to_string(outcomes.size());
    write_cell(one, *session.tissues, folder);
    outcomes.push_back({{0, pose, technique}, folder, ""});
  }
  for (const std::string& name : poses) study.poses.push_back({.name = name});
  std::vector<CellResult> cells;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const std::string& name = session.results[i].result->name;
    try {
      cells.push_back(read_result(study, outcomes[i]));
    } catch (const Error&) {
      throw Error("a result has no complete report", name, "resample the pose again, or delete the result");
    }
  }
  const StudyFigures figures = make_figures(study, cells, start, progress);
  return html_report(study, cells, figures, {.out = scratch, .date = date_text(), .of_session = true});
}

}  // namespace limber
