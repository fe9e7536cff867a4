// SPDX-License-Identifier: AGPL-3.0-or-later
// The figures of a computed cell, read from its folder, and whether they keep to the study's gates.
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
  double label = 0;  // as in files
  std::string name;
  std::int64_t voxels_before = 0, voxels_after = 0;
  std::optional<double> volume_percent, mass_percent;  // none where it was not there before
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
  glm::dvec3 axis{0}, head{0}, tail{0}, parent_head{0};  // as report.h has them
  std::optional<double> excess_degrees;
};

struct CellResult {
  StudyCell cell;
  Path folder;
  std::string failure;  // why there are no figures; empty otherwise
  double cpu_seconds = 0, wall_seconds = 0, peak_memory_mb = 0;
  std::string machine;
  std::map<std::string, double> seconds;  // by stage
  std::vector<TissueFigures> tissues;
  std::int64_t voxels_before = 0, voxels_after = 0;
  double volume_percent = 0, mass_percent = 0;
  std::int64_t overlap_voxels = 0, bone_overlap_voxels = 0, new_hole_voxels = 0, dropped_voxels = 0,
               trapped_air_voxels = 0, mended_voxels = 0;
  std::optional<std::int64_t> mass_exact_voxels;  // that changed hands; none where masses were not made exact
  std::optional<double> skin_share_before, skin_share_after;
  std::string worst_bone;
  std::optional<double> bone_residual_mm;  // of that
  std::optional<MeshFigures> mesh;
  std::optional<SolveFigures> solve;
  std::vector<JointFigures> joints;
  std::vector<std::string> warnings;
  std::vector<QualityGate> gates;
  std::map<std::string, std::string> inputs;  // SHA-256 by path
  std::string report, cell_json;              // as they lie in the folder

  bool done() const { return failure.empty(); }
};

// What a cell of a study must pass: all that is judged from its report.
std::vector<QualityGate> gates_of(const std::string& report, const QualityLimits& limits);

// Throws Error where the folder's files cannot be read.
CellResult read_result(const Study& study, const CellOutcome& outcome);

// Of the body at a spacing, processor seconds. None where the file is not there.
std::optional<double> weights_seconds(const Path& out, const CellResult& cell);

}  // namespace limber
