// SPDX-License-Identifier: AGPL-3.0-or-later
// Shows a finite element solve while it runs in a worker process. After each iteration, the views of the Resample
// workspace show the volume deformed by the mesh's new node positions. They use the same inverse map as the preview of
// a pose (live_preview.h). The document changes only when the solve has ended.
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

// Passes the progress of the worker process from the job's thread to the editor's thread.
class SolveFeed {
 public:
  struct Seen {
    WorkerProgress progress;
    std::shared_ptr<const FemMesh> rest;
    MeshPose mesh;                        // tets and node positions after the last iteration; empty: none yet
    std::vector<RigidTransform> motions;  // rest to posed, for each bone of the weights, in the last iteration
    double reached = 0;                   // fraction of the pose that the last iteration applies, [0, 1]; 0: rest
  };

  void tell(const WorkerProgress& progress);
  void show(const std::shared_ptr<const FemMesh>& rest, FemStep step);
  Seen seen() const;

 private:
  mutable std::mutex mutex_;
  Seen seen_;
};

// A finite element solve that is queued or running.
struct Solve {
  Document from;             // the document whose pose is solved for
  double angle_degrees = 0;  // largest angle by which the pose turns a joint, degrees
  std::shared_ptr<SolveFeed> feed;
};

struct FemView {
  std::map<int, Solve> solves;  // the solve of each job, by the job's id
  int watched = 0;              // id of the job whose solve the views show; 0: none
};

// Returns the solve that the views show. Null if there is none, or if the document now has another volume than the
// solve.
const Solve* watched_solve(const Editor& editor);
// Returns the progress of a solve as text, such as "34.5 of 90.0 ..., iteration 12, moving 0.80 mm": the joint angle
// reached and the pose's, the iteration, and the longest move of a node in it. Returns "" before the first iteration.
std::string progress_text(const Solve& solve);
// Makes the views show the newest solve in place of a resampled volume.
void watch(Editor& editor);
void stop_watching(Editor& editor);

}  // namespace limber::editor
