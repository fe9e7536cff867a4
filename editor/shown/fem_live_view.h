// SPDX-License-Identifier: AGPL-3.0-or-later
// Shows a finite element solve while it runs in a worker process. After each iteration, the views of the Resample
// workspace show the volume deformed by the mesh's new node positions. The deformed volume is computed as in the
// preview of a pose (live_preview.h), by a map from posed to rest positions. The document changes only when the solve
// has ended.
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

struct Context;

// Passes the progress of the worker process from the job's thread to the editor's thread.
class SolveFeed {
 public:
  struct Seen {
    WorkerProgress progress;
    std::shared_ptr<const FemMesh> rest;
    MeshPose mesh;  // tets and node positions after the last iteration; empty: no iteration has ended yet
    std::vector<RigidTransform> motions;  // transform from rest to posed of each bone, as of the last iteration
    double reached = 0;                   // fraction of the pose that the last iteration applied, [0, 1]; 0: rest
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
  Document from;             // document from which the solve was started, with the pose that the solve applies
  double angle_degrees = 0;  // largest angle by which the pose turns a joint, degrees
  std::shared_ptr<SolveFeed> feed;
};

struct FemView {
  std::map<int, Solve> solves;  // the finite element solves that are queued or running; key: id of the solve's job
  int watched = 0;              // id of the job whose solve the views show; 0: they show no solve
};

// Returns the solve that the views show. Returns null if they show no solve, or if the document's volume has been
// replaced since the solve was started.
const Solve* watched_solve(const Context& context);
// Returns the progress of a solve as text, such as "34.5 of 90.0 ..., iteration 12, moving 0.80 mm". The numbers are
// the joint angle reached so far, the pose's joint angle, the iteration, and the longest move of a mesh node in this
// iteration. Returns "" before the first iteration.
std::string progress_text(const Solve& solve);
// Makes the views show the finite element solve that was started last, in place of a resampled volume.
void watch(Context& context);
void stop_watching(FemView& fem);

}  // namespace limber::editor
