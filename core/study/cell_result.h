// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the figures of one computed cell of a study from the cell's folder, and judges them by the study's quality
// gates. A cell is one combination of spacing, pose and technique.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/report/quality_gates.h"
#include "core/study/run_study.h"

namespace limber {

struct TissueFigures {
  double label = 0;  // value of the tissue's voxels in the volume file
  std::string name;
  std::int64_t voxels_before = 0, voxels_after = 0;
  std::optional<double> volume_percent, mass_percent;  // change in %; empty where the tissue has no voxels at rest
  int components_before = 0, components_after = 0;
  std::int64_t overlap_voxels = 0;
};

struct MeshFigures {
  std::int64_t tets = 0, nodes = 0, inverted = 0;
  double min_det_f = 1;
  std::optional<std::int64_t> self_intersections;
  std::optional<double> min_gap_mm, median_gap_mm;
};

struct SolveFigures {
  bool converged = false;
  double reached = 0;
  std::string blocked_by;
  int iterations = 0;
  double residual_mm = 0;
};

struct JointFigures {
  std::string bone;
  double degrees = 0;
  glm::dvec3 axis{0}, head{0}, tail{0}, parent_head{0};  // axis: unit vector in world space; others: mm, world space
  std::optional<double> excess_degrees;
};

struct CellResult {
  StudyCell cell;
  Path folder;
  std::string failure;  // why the cell could not be computed; empty if it was computed
  double cpu_seconds = 0, wall_seconds = 0, peak_memory_mb = 0;  // medians of the repeats; memory: of the last repeat
  std::vector<double> cpu_repeats;                               // processor seconds of each repeat, at least one
  std::string machine;
  std::map<std::string, double> seconds;  // wall-clock seconds of each stage
  std::vector<TissueFigures> tissues;
  std::int64_t voxels_before = 0, voxels_after = 0;
  double volume_percent = 0, mass_percent = 0;
  std::int64_t overlap_voxels = 0, bone_overlap_voxels = 0, new_hole_voxels = 0, dropped_voxels = 0,
               trapped_air_voxels = 0, mended_voxels = 0;
  std::optional<std::int64_t> mass_exact_voxels;  // voxels that were changed to make masses exact; empty: not done
  std::optional<double> skin_share_before, skin_share_after;
  std::string worst_bone;
  std::optional<double> bone_residual_mm;  // deviation of worst_bone from a rigid motion, mm
  std::optional<MeshFigures> mesh;
  std::optional<SolveFigures> solve;
  std::vector<JointFigures> joints;
  std::vector<std::string> warnings;
  std::vector<QualityGate> gates;
  std::map<std::string, std::string> inputs;  // SHA-256 of each input file, by its path
  std::string report, cell_json;              // the contents of report.json and cell.json in the cell's folder

  bool done() const { return failure.empty(); }
};

// Judges a cell's report. Returns each quality gate (a check of one figure against a limit) with its outcome.
std::vector<QualityGate> gates_of(const std::string& report, const QualityLimits& limits);

// Returns whether the change of a label's volume is within the study's limit. Returns nothing if the label has fewer
// voxels than `limits.least_voxels`, or its change is unknown.
std::optional<bool> label_passes(const TissueFigures& tissue, const QualityLimits& limits);

// Reads the result of a cell of the study. Throws Error if files in the cell's folder cannot be read.
CellResult read_result(const Study& study, const CellOutcome& outcome);

// Returns the processor seconds that it took to compute the skin weights used by the cell. Returns nothing if body.json
// is missing.
std::optional<double> weights_seconds(const Path& out, const CellResult& cell);

}  // namespace limber
