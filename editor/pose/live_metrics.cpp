// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/live_metrics.h"

#include <algorithm>
#include <utility>

#include "core/report/metrics.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/pose/live_preview.h"
#include "editor/ui/ui.h"
#include "editor/volume/body_seams.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

std::optional<double> PoseMetrics::Row::change_percent() const {
  return mm3_before > 0 ? std::optional(100 * (mm3_after / mm3_before - 1)) : std::nullopt;
}

namespace {

PoseMetrics metrics_of(const DenseWish& wish, const LabelVolume& posed, std::int64_t overlap_voxels,
                       Progress& progress) {
  progress.update("measure", 0);
  const VolumeMetrics changes = compare(*wish.volume, posed, *wish.tissues);
  PoseMetrics metrics;
  metrics.overlap_voxels = overlap_voxels;
  metrics.total = {"Total", {}, changes.mm3_before, changes.mm3_after};
  std::optional<std::size_t> bone;
  for (const TissueChange& change : changes.tissues) {
    const Tissue* tissue = wish.tissues->find(change.label);
    if (!tissue) continue;
    if (is_bone(tissue->kind) && bone) {
      metrics.tissues[*bone].mm3_before += change.mm3_before;
      metrics.tissues[*bone].mm3_after += change.mm3_after;
      continue;
    }
    if (is_bone(tissue->kind)) bone = metrics.tissues.size();
    metrics.tissues.push_back(
        {is_bone(tissue->kind) ? "Bone" : shown_name(*tissue), tissue->colour, change.mm3_before, change.mm3_after});
  }
  std::stable_sort(metrics.tissues.begin(), metrics.tissues.end(),
                   [](const auto& a, const auto& b) { return a.mm3_before > b.mm3_before; });
  return metrics;
}

}  // namespace

PoseMetrics measure(const DenseWish& wish, Progress& progress) {
  const auto seams = body_seams().of({wish.volume, wish.tissues, wish.armature, wish.seams, wish.bone_map}, progress);
  const Posed posed = resample(*wish.volume, *wish.tissues, *wish.armature, *wish.weights, wish.pose, wish.blend,
                               {.seams = seams}, progress);
  return metrics_of(wish, posed.volume, posed.report.overlap_voxels, progress);
}

void LiveMetrics::stop(Context& context) {
  if (job_) context.jobs->cancel(job_);
  job_ = 0;
}

void LiveMetrics::follow(Context& context, const std::optional<DenseWish>& wish, bool settled) {
  const bool wanted = std::exchange(wanted_, false);
  const bool is_new = !wish || !(*wish == of_);
  if (is_new) {
    stop(context);
    is_known_ = false;
    trouble_.clear();
    of_ = wish.value_or(DenseWish{});
    refined_ = {};
    if (wish) context.ui->touch();  // the next frame knows whether the new pose is refined
  }
  if (!wanted) return stop(context);
  const bool waits = is_new || refined_.awaited || (!settled && !refined_.volume);
  if (waits || is_known_ || job_ || !trouble_.empty()) return;
  job_ = start_task(
      context, "",
      [wish = *wish, refined = refined_](Progress& progress) -> Finish {
        auto metrics = std::make_shared<PoseMetrics>(
            refined.volume ? metrics_of(wish, *refined.volume, refined.overlap_voxels, progress)
                           : measure(wish, progress));
        return [wish, metrics](Context& c) {
          LiveMetrics& mine = c.live->metrics();
          if (!(mine.of_ == wish)) return;
          mine.metrics_ = std::move(*metrics);
          mine.metrics_of_ = wish.volume;
          mine.is_known_ = true;
          mine.job_ = 0;
        };
      },
      [wish = *wish](Context& c, const std::string& error) {
        LiveMetrics& mine = c.live->metrics();
        if (!(mine.of_ == wish)) return;
        mine.trouble_ = error;
        mine.job_ = 0;
      });
}

}  // namespace limber::editor
