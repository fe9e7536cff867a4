// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the figures of the document's results from their reports, finds out whether a result is stale, and shows or
// renames results.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/document.h"
#include "core/report/quality_gates.h"
#include "editor/shown/shown_result.h"
#include "render/scene/scene.h"

namespace limber::editor {

struct Comparison;
struct Context;

struct ResultTissue {
  std::string name;
  double mm3_before = 0, mm3_after = 0;
  std::optional<double> change_percent;
  std::int64_t overlap_voxels = 0;
};
struct ResultFacts {
  double seconds = 0;                    // run time of the deformation method alone, s
  std::optional<double> change_percent;  // change of the total tissue volume, percent
  std::int64_t overlap_voxels = 0, hole_voxels = 0, dropped_voxels = 0, trapped_air_voxels = 0;
  std::optional<std::int64_t> inverted;  // FEM only: number of inverted tets of the mesh
  std::vector<ResultTissue> tissues;
  std::vector<std::string> warnings;
  std::vector<QualityGate> gates;
  // One line of the result's provenance (method, settings, inputs, times): a name and a value.
  struct Line {
    std::string name, value, whole;  // name, value as shown, and the full value if `value` is shortened
  };
  std::vector<Line> settings, inputs, stages;
  std::string version;
  std::optional<double> peak_memory_mb;
};
ResultFacts facts_of_report(const std::string& json);  // reads a report; a figure that the report lacks stays empty

std::shared_ptr<const ResultFacts> facts_of(Context& context, const std::shared_ptr<const Result>& result);
// Returns the report as readable text, 100 columns wide: gates, tissues, provenance.
std::string text_of_report(const std::string& name, const ResultFacts& facts);

// Returns the display name of a method: "lbs" -> "LBS".
std::string method_name(const std::string& method);
// Returns which input of the result has changed in the document since the result was made, such as "weights changed";
// "" if none has. The pose is not compared, because a result belongs to the pose that it was made from.
std::string stale_reason(const Document& document, const Result& result);
bool is_of_this_pose(const Document& document, const Result& result);
// Returns a name for a pose: "Forearm 90 deg", "Forearm 90 deg and 2 more" (with a degree sign), "Rest".
std::string name_of_pose(const Armature& armature, const Pose& pose);
// Returns `name`, with a number appended if a result already has that name.
std::string unique_name(const std::vector<std::shared_ptr<const Result>>& results, const std::string& name);

// Shows the newest result of the current pose that is up to date. Does so only if the views show a result of another
// pose, or show the volume at rest although the user did not select it.
void show_result_of_pose(Context& context);
void show_result(Context& context, const std::string& name);  // shows a result by its name; "": the volume at rest
// Makes the views show the volume at rest, and marks it as selected by the user: show_result_of_pose() then keeps it.
void show_rest(Comparison& comparison);
// Renames a result as one edit; makes the name unique among the results.
void rename_result(Context& context, const std::shared_ptr<const Result>& result, const std::string& name);
// Converts the box of a clip from voxel coordinates of one grid to those of another. Removes the box if the grids' axes
// differ.
void move_clip_box(render::Clip& clip, const Grid& from, const Grid& to);
// Puts the shown result or the current pose into this frame's scene, and side A of a comparison into the second scene.
void show_posed(Context& context);

}  // namespace limber::editor
