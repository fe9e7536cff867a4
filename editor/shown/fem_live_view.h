// SPDX-License-Identifier: AGPL-3.0-or-later
// What is seen of finite elements. While a solve runs in the worker, the Resample workspace shows the volume settle:
// the places of the mesh's nodes after each iteration lead the views through the same inverse map as a pose does
// (live_preview.h). What follows is for the eye alone; the document changes when the result is there.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/deform/preview_map.h"
#include "core/project/document.h"
#include "core/project/worker.h"
#include "core/resample/fem_steps.h"

namespace limber::editor {

struct Editor;

// What the worker tells, from the job's thread to the editor's.
class SolveFeed {
 public:
  struct Seen {
    WorkerProgress progress;
    std::shared_ptr<const FemMesh> rest;
    MeshPose mesh;                        // its tets and where they are; empty: no step yet
    std::vector<RigidTransform> motions;  // of the weights' bones, in that step
    double reached = 0;                   // of the way to the pose, in that step
  };

  void tell(const WorkerProgress& progress);
  void show(const std::shared_ptr<const FemMesh>& rest, FemStep step);
  Seen seen() const;

 private:
  mutable std::mutex mutex_;
  Seen seen_;
};

// A solve that waits or is at work.
struct Solve {
  Document from;             // with the pose
  double angle_degrees = 0;  // of the joint that turns furthest
  std::shared_ptr<SolveFeed> feed;
};

struct FemView {
  std::map<int, Solve> solves;  // by job
  int watched = 0;              // the job whose tissue is seen; 0: none
};

// The solve that the views show; null: none, as where its volume is no longer the document's.
const Solve* watched_solve(const Editor& editor);
// "34.5 of 90.0°, iteration 12, moving 0.80 mm"; "" before the first iteration.
std::string progress_text(const Solve& solve);
// The newest solve; no result hides it.
void watch(Editor& editor);
void stop_watching(Editor& editor);

}  // namespace limber::editor
