// SPDX-License-Identifier: AGPL-3.0-or-later
// Background tasks, such as reading and writing files. A task is a job whose work runs in a thread of its own and whose
// result is handled in the editor's thread. The result of any other job is an edit of the document. The result of a
// task may be anything, such as another project or a list of files.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/platform/module.h"
#include "core/project/job.h"

namespace limber::editor {

struct Context;

// The function that handles a task's result in the editor's own thread. An empty function means that the result needs
// no handling.
using Finish = std::function<void(Context&)>;
using TaskWork = std::function<Finish(Progress&)>;
// The function that handles a task's failure. If it is empty, an error message is shown instead. `error` is the text of
// the Error in one line.
using Failure = std::function<void(Context&, const std::string& error)>;

// The step of the workflow (from a volume at rest to a posed volume) in which a job is started.
enum class StepOfWork { Prepare, Rig, Skin, Pose, Resample };

struct Task {
  std::shared_ptr<Finish> finish;
  Failure failed;
};

struct BackgroundWork {
  std::map<int, std::function<void(Context&, const JobStatus&)>> after_job;  // called when a job of this id ends
  std::map<int, Task> tasks;                                                 // tasks, by the id of their job
  std::map<int, StepOfWork> step_of_job;    // workflow step in which a job was started, by the job's id
  std::map<int, double> stopping_since;     // time at which a job that still runs was cancelled, s, by the job's id
  Path worker_program = running_program();  // the program that runs `limber job`
  bool workers_yield = true;                // true: worker processes run at low priority
  // Functions that are called once in every frame. A function that returns false is removed.
  std::vector<std::function<bool(Context&)>> each_frame;
};

// Starts a task and returns the id of its job. `work` runs in another thread and must not touch the editor. The label
// is shown to the user while the task runs. A task with an empty label is not shown.
int start_task(Context& context, std::string label, TaskWork work, Failure failed = {}, Lane lane = Lane::Common);
// Handles the end of a task's job: calls the task's Finish or its Failure. Returns false if the job belongs to no task.
bool end_task(Context& context, const JobStatus& job);

}  // namespace limber::editor
