// SPDX-License-Identifier: AGPL-3.0-or-later
// What is known about the results of a document: their figures, read from their reports, and whether they are stale.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/document.h"
#include "core/report/quality_gates.h"
#include "editor/shown/shown_result.h"

namespace limber::editor {

struct Editor;

struct ResultTissue {
  std::string name;
  double mm3_before = 0, mm3_after = 0;
  std::optional<double> change_percent;
  std::int64_t overlap_voxels = 0;
};
struct ResultFacts {
  double seconds = 0;  // of the method: not of weights that had to be computed first, of files or the report
  std::optional<double> change_percent;  // of all tissue
  std::int64_t overlap_voxels = 0, hole_voxels = 0, dropped_voxels = 0, trapped_air_voxels = 0;
  std::optional<std::int64_t> inverted;  // cells of a mesh, by finite elements
  std::vector<ResultTissue> tissues;
  std::vector<std::string> warnings;
  std::vector<QualityGate> gates;
  // Where it comes from, as words: sections with their lines.
  struct Line {
    std::string name, value, whole;  // `whole`: the value in full, where it is shortened
  };
  std::vector<Line> settings, inputs, stages;
  std::string version;
  std::optional<double> peak_memory_mb;
};
ResultFacts facts_of_report(const std::string& json);  // what is missing there stays empty

std::shared_ptr<const ResultFacts> facts_of(Editor& editor, const std::shared_ptr<const Result>& result);
// For people: gates, tissues, provenance, 100 columns wide.
std::string text_of_report(const std::string& name, const ResultFacts& facts);

// "lbs" -> "LBS"
std::string method_name(const std::string& method);
// What the result was made from is no longer what the document holds: "weights changed"; "" while it is. Its pose may
// be another one: a result stands for the pose it was made of.
std::string stale_reason(const Document& document, const Result& result);
bool is_of_this_pose(const Document& document, const Result& result);
// "Forearm 90°", "Forearm and 2 more", "Rest"
std::string name_of_pose(const Armature& armature, const Pose& pose);
// `name`, or with a number behind it when a result has that already.
std::string unique_name(const std::vector<std::shared_ptr<const Result>>& results, const std::string& name);

void show_result(Editor& editor, const std::string& name);  // "": the volume at rest
// Another name, made unique among the results. An edit.
void rename_result(Editor& editor, const std::shared_ptr<const Result>& result, const std::string& name);
// Puts the shown result, or the pose of the moment, into the scene of this frame, and side a of a comparison into the
// other one.
void show_posed(Editor& editor);

}  // namespace limber::editor
