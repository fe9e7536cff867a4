// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/fem_live_view.h"

#include <cstdio>
#include <utility>

#include "editor/context/context.h"
#include "editor/context/workspace.h"
#include "editor/ui/ui.h"

namespace limber::editor {

void SolveFeed::tell(const WorkerProgress& progress) {
  const std::lock_guard lock(mutex_);
  seen_.progress = progress;
}

void SolveFeed::show(const std::shared_ptr<const FemMesh>& rest, FemStep step) {
  auto posed = std::make_shared<const Eigen::MatrixX3d>(std::move(step.V));
  const std::lock_guard lock(mutex_);
  seen_.rest = rest;
  seen_.mesh = {std::shared_ptr<const TetMesh>(rest, &rest->tets), std::move(posed)};
  seen_.motions = std::move(step.motions);
  seen_.reached = step.reached;
}

SolveFeed::Seen SolveFeed::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

const Solve* watched_solve(const Context& context) {
  if (context.workspace() != Workspace::Resample) return nullptr;
  const auto found = context.fem->solves.find(context.fem->watched);
  if (found == context.fem->solves.end()) return nullptr;
  const Solve& solve = found->second;
  return solve.from.volume == context.document().volume && solve.feed->seen().mesh.posed ? &solve : nullptr;
}

std::string progress_text(const Solve& solve) {
  const WorkerProgress progress = solve.feed->seen().progress;
  if (!progress.iteration || !progress.angle_degrees || !progress.residual_mm) return "";
  char text[96];
  std::snprintf(text, sizeof text, "%.1f of %.1f\u00b0, iteration %d, nodes move up to %.2f mm",
                *progress.angle_degrees, solve.angle_degrees, *progress.iteration, *progress.residual_mm);
  return text;
}

void watch(Context& context) {
  if (!context.fem->solves.empty()) context.fem->watched = context.fem->solves.rbegin()->first;
  context.ui->touch();
}

void stop_watching(FemView& fem) { fem.watched = 0; }

}  // namespace limber::editor
