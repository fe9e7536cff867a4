// SPDX-License-Identifier: AGPL-3.0-or-later
// Refines the shown pose at rest: while the pose does not change, a worker process resamples it at idle priority, and
// the views then show the posed volume instead of the preview (live_preview.h). It has the labels that `limber
// resample` writes with the selected method, so what the user sees at rest is what resampling gives. Any change of the
// body, the pose or the method cancels the worker, and the same frame shows the preview again.
//
// Only pictures show the refined volume (Views::refined_scene). The scene of the preview remains for all that needs
// positions at rest: hovering, measuring, brushes. A preview that is coloured by weights, or shows a grey image along
// with the labels, is not refined, and neither is a pose by finite elements, whose solve takes minutes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/project/document.h"
#include "core/rig/pose.h"
#include "editor/context/resampling_settings.h"

namespace limber::editor {

class BodyFiles;
struct Context;

// What is resampled: a body in a pose, and how. Equal pointers mean equal contents.
struct PoseToRefine {
  Document body;  // volume, tissues, rig, weights, seams and bone map; all other members are empty
  Pose pose;
  ResamplingSettings settings;

  bool operator==(const PoseToRefine&) const = default;
};

struct RefinedPose {
  bool on = false;  // true: poses are refined if the preference says so; off until a session of the editor begins
  std::int64_t most_voxels = 100'000'000;  // a larger volume is not refined: its worker would need about 2 GB and more

  std::optional<PoseToRefine> wanted;         // what the views show; empty: nothing that can be refined
  double since = 0;                           // time (Ui::now) at which `wanted` changed or the user last dragged, s
  int job = 0;                                // id of the task that resamples `wanted`; 0: none runs
  std::shared_ptr<const LabelVolume> volume;  // the body of `wanted` in its pose; null until it is computed
  std::int64_t overlap_voxels = 0;            // number of voxels of `volume` in which tissue or bones overlap
  std::string trouble;                        // why `wanted` is not refined; "": no reason
  std::shared_ptr<BodyFiles> files;           // the files of `files_of`, kept for further poses of the same body
  Document files_of;
  int poses = 0;  // number of tasks so far, for the names of their files
};

// Sets Views::refined_scene for this frame, and starts or cancels the task that resamples the pose. Call it once per
// frame after everything else is in the scene.
void show_refined(Context& context);
// Returns true while the shown pose is not refined yet, but will be without any action of the user.
bool awaits_refined(const Context& context);
// Returns a few words on the refinement for the title of the 3D view: "refining", "refined", or why the pose stays
// unrefined; "" if the views show nothing to refine.
std::string refinement_text(const Context& context);

}  // namespace limber::editor
