// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/refined_pose.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <utility>

#include "core/project/worker.h"
#include "core/volume_io/volume_io.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/preferences.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/motion/timeline.h"
#include "editor/pose/live_preview.h"
#include "editor/resample/resample_inputs.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

// The files of a body for the worker, written when the first pose of the body needs them.
class BodyFiles {
 public:
  // Returns the folder of the files. Called in the threads of tasks.
  std::shared_ptr<const ScratchFolder> of(const Document& body, const std::string& scratch, Progress& progress) {
    const std::lock_guard lock(mutex_);
    if (folder_) return folder_;
    const auto folder = std::make_shared<const ScratchFolder>(scratch);
    write_body(body, *folder, progress);
    return folder_ = folder;
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<const ScratchFolder> folder_;  // null until all files are written
};

namespace {

constexpr double kRest = 0.3;  // a pose that has not changed for this time is refined, s

// Returns what the views show if it can be refined, else nothing.
std::optional<PoseToRefine> refinable(const Context& context) {
  if (!context.refined->on || !context.preferences->refine_at_rest) return {};
  const Document& document = context.document();
  const render::Scene& scene = context.views->scene;
  const bool is_preview = scene.pose && scene.volume == document.volume && context.live->posed();
  const bool is_coloured = scene.weights || scene.grey || context.views->preview_weights;
  if (!is_preview || is_coloured || context.views->preview_armature || context.views->other_scene ||
      watched_solve(context) || context.workspace() == Workspace::Skin || context.timeline->play.on)
    return {};
  PoseToRefine shown;
  shown.body.volume = document.volume;
  shown.body.volume_type = document.volume_type;
  shown.body.tissues = document.tissues;
  shown.body.armature = document.armature;
  shown.body.weights = document.weights;
  shown.body.seams = document.seams;
  shown.body.bone_map = document.bone_map;
  shown.pose = shown_pose(context);
  shown.settings.method = context.resampling->method;
  shown.settings.bones_apart = context.resampling->bones_apart;
  shown.settings.mass_exact = context.resampling->mass_exact;
  return shown;
}

// Returns why the pose cannot be refined; "" when it can.
std::string why_not_refined(const RefinedPose& refined) {
  if (refined.wanted->settings.method == kFiniteElements) return "finite elements only when resampled";
  if (refined.wanted->body.volume->grid.voxel_count() > refined.most_voxels) return "too large to refine";
  return "";
}

void stop(Context& context) {
  RefinedPose& refined = *context.refined;
  if (refined.job) context.jobs->cancel(refined.job);
  refined.job = 0;
  refined.volume = nullptr;
  refined.trouble.clear();
}

struct Refinement {
  PoseToRefine wanted;
  std::shared_ptr<BodyFiles> files;
  std::string scratch, number;
  WorkerSettings worker;
};

struct Refined {
  std::shared_ptr<const LabelVolume> volume;
  std::int64_t overlap_voxels = 0;
};

std::int64_t count_labelled(const LabelVolume& volume) {
  return std::count_if(volume.voxels.begin(), volume.voxels.end(), [](Label label) { return label != 0; });
}

// Resamples the pose in a worker process.
Refined refined_in_worker(const Refinement& task, Progress& progress) {
  const Document& body = task.wanted.body;
  const auto folder = task.files->of(body, task.scratch, progress);
  const PoseFiles files{.job = "job" + task.number + ".json",
                        .pose = "pose" + task.number + ".json",
                        .posed = "posed" + task.number + ".nrrd",
                        .overlap = "overlap" + task.number + ".nrrd"};
  struct Removed {
    const ScratchFolder& folder;
    const PoseFiles& files;
    ~Removed() {
      std::error_code ignored;
      for (const std::string& name : {files.job, files.pose, files.posed, files.overlap})
        std::filesystem::remove(folder / name, ignored);
    }
  } const removed{*folder, files};
  write_job(body, task.wanted.pose, task.wanted.settings, files, *folder);
  run_worker(*folder / files.job, progress, task.worker);
  return {read_posed(*folder / files.posed, *body.tissues, progress),
          count_labelled(read_volume(*folder / files.overlap, progress).volume)};
}

void start(Context& context) {
  RefinedPose& refined = *context.refined;
  if (!refined.files || !(refined.files_of == refined.wanted->body)) {
    refined.files = std::make_shared<BodyFiles>();
    refined.files_of = refined.wanted->body;
  }
  Refinement task{*refined.wanted,
                  refined.files,
                  context.preferences->scratch_folder,
                  std::to_string(++refined.poses),
                  {.memory_limit_mb = context.preferences->worker_memory_mb,
                   .yields = context.background->workers_yield,
                   .program = context.background->worker_program}};
  refined.job = start_task(
      context, "",
      [task = std::move(task), visibility = context.document().visibility,
       make_ready = body_maker(context.views)](Progress& progress) -> Finish {
        Document posed = task.wanted.body;
        const Refined made = refined_in_worker(task, progress);
        posed.volume = made.volume;
        posed.visibility = visibility;
        make_ready(posed, progress, {});
        return [number = task.number, made](Context& c) {
          RefinedPose& mine = *c.refined;
          if (!mine.job || number != std::to_string(mine.poses)) return;
          mine.volume = made.volume;
          mine.overlap_voxels = made.overlap_voxels;
          mine.job = 0;
        };
      },
      [number = std::to_string(refined.poses)](Context& c, const std::string& error) {
        RefinedPose& mine = *c.refined;
        if (!mine.job || number != std::to_string(mine.poses)) return;
        mine.trouble = parts_of(error).what;
        mine.job = 0;
      },
      Lane::Quiet);
}

bool is_dragging(const Context& context) { return context.interaction->modal || context.interaction->drag; }

// Selects what is refined now, and cancels the task when that has changed.
void choose(Context& context) {
  RefinedPose& refined = *context.refined;
  const Document& document = context.document();
  if (refined.files_of.volume != document.volume || refined.files_of.weights != document.weights) {
    refined.files = nullptr;
    refined.files_of = {};
  }
  auto wanted = refinable(context);
  if (wanted == refined.wanted) return;
  stop(context);
  refined.wanted = std::move(wanted);
  refined.since = context.ui->now;
  if (refined.wanted) refined.trouble = why_not_refined(refined);
}

}  // namespace

void show_refined(Context& context) {
  choose(context);
  RefinedPose& refined = *context.refined;
  Views& views = *context.views;
  context.live->metrics().use({awaits_refined(context) || refined.job, refined.volume, refined.overlap_voxels});
  views.refined_scene.reset();
  if (refined.volume) {
    views.refined_scene = views.scene;
    views.refined_scene->volume = refined.volume;
    views.refined_scene->pose = nullptr;
    move_clip_box(views.refined_scene->clip, context.document().volume->grid, refined.volume->grid);
  } else {
    views.body.refined.reset();
    views.body.shows_refined = false;
    if (!refined.wanted || refined.job || !refined.trouble.empty()) return;
    if (is_dragging(context)) refined.since = context.ui->now;
    else if (context.ui->now < refined.since + kRest) context.ui->wake_at(refined.since + kRest);
    else start(context);
  }
}

bool awaits_refined(const Context& context) {
  const RefinedPose& refined = *context.refined;
  return refined.wanted && !refined.volume && refined.trouble.empty() && !is_dragging(context);
}

std::string refinement_text(const Context& context) {
  const RefinedPose& refined = *context.refined;
  if (!refined.wanted) return "";
  if (!refined.trouble.empty()) return "not refined: " + refined.trouble;
  return context.views->body.shows_refined ? "refined" : "refining";
}

}  // namespace limber::editor
