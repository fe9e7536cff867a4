// SPDX-License-Identifier: AGPL-3.0-or-later
// What is known about the results of a document: their figures, read from their reports, and whether they are stale.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/document.h"
#include "core/report/quality_gates.h"

namespace limber::editor {

struct Editor;

struct ResultTissue {
  std::string name;
  double mm3_before = 0, mm3_after = 0;
  std::optional<double> change_percent;
  std::int64_t overlap_voxels = 0;
};
struct ResultFacts {
  double seconds = 0;                    // of the method: not of weights that had to be computed first, of files or the report
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

// The same, read once for each result.
struct KnownResult {
  std::weak_ptr<const Result> result;
  std::shared_ptr<const ResultFacts> facts;
};
std::shared_ptr<const ResultFacts> facts_of(Editor& editor, const std::shared_ptr<const Result>& result);
// For people: gates, tissues, provenance, 100 columns wide.
std::string text_of_report(const std::string& name, const ResultFacts& facts);

// "lbs" -> "LBS"
std::string method_name(const std::string& method);
// What the result was made from is no longer what the document holds: "weights changed"; "" while it is. Its pose may be
// another one: a result stands for the pose it was made of.
std::string stale_reason(const Document& document, const Result& result);
bool is_of_this_pose(const Document& document, const Result& result);
// "Forearm 90°", "Forearm and 2 more", "Rest"
std::string name_of_pose(const Armature& armature, const Pose& pose);
// `name`, or with a number behind it when a result has that already.
std::string unique_name(const std::vector<std::shared_ptr<const Result>>& results, const std::string& name);

// What the views show in place of the volume at rest, and what that is compared with. Names of results; one that is
// empty or unknown is the volume at rest.
struct Comparison {
  std::string a, b;
  bool shows_a = false;  // else b
  enum class Views {
    One,         // a or b
    Wipe,        // a left of a line that is dragged, b right of it, in one picture
    SideBySide,  // each view twice, a left and b right, with one camera
  } views = Views::One;
  float share = 0.5f;    // of the view that a takes
};
// Where it is told by colour who is who, always with its letter.
inline constexpr std::uint32_t kColourOfA = 0xFFD97AB0, kColourOfB = 0xFFA8B63F;  // B07AD9, 3FB6A8, as ImGui packs them
std::shared_ptr<const Result> result_named(const Document& document, const std::string& name);  // null for none
// Why there is nothing to compare; "" when there is.
std::string why_no_comparison(const Editor& editor);
// In the Resample workspace alone: elsewhere there is work on one body.
bool wiping(const Editor& editor);
bool side_by_side(const Editor& editor);
bool comparing(const Editor& editor);     // either
// Name of a side as the views show it: "Fore 30°, DQ", "At rest".
std::string name_of_side(const Editor& editor, const std::string& result);

// The result that is seen in the views in place of the volume; null: the volume at rest, or as it follows the pose. Where
// poses are made a result stands back as soon as the pose is another than its own.
std::shared_ptr<const Result> shown_result(const Editor& editor);
// The one the tables are about: the shown one, else the last.
std::shared_ptr<const Result> chosen_result(const Editor& editor);
void show_result(Editor& editor, const std::string& name);  // "": the volume at rest
// Another name, made unique among the results. An edit.
void rename_result(Editor& editor, const std::shared_ptr<const Result>& result, const std::string& name);
// The grid and tissue of what the views show. Needs a volume.
std::shared_ptr<const LabelVolume> shown_volume(const Editor& editor);
// The document with that volume in place of its own.
Document shown_document(const Editor& editor);
// Puts the shown result, or the pose of the moment, into the scene of this frame, and side a of a comparison into the other one.
void show_posed(Editor& editor);

}  // namespace limber::editor
