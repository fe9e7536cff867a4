// SPDX-License-Identifier: AGPL-3.0-or-later
// Background tasks, such as reading and writing files. A task's work runs in a job's thread, and its result is handled
// in the editor's thread. The result of a plain job is an edit of the document; the result of a task may be anything,
// such as another project or a list of files.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/project/job.h"

namespace limber::editor {

struct Editor;

// Handles a task's result in the editor's own thread. May be empty.
using Finish = std::function<void(Editor&)>;
using TaskWork = std::function<Finish(Progress&)>;
// Handles a task's failure. If it is empty, an error message is shown instead. `error` is an Error's line.
using Failure = std::function<void(Editor&, const std::string& error)>;

// The step of the workflow (from a volume at rest to a posed volume) that a job belongs to.
enum class StepOfWork { Prepare, Rig, Skin, Pose, Resample };

struct Task {
  std::shared_ptr<Finish> finish;
  Failure failed;
};

// Starts a task and returns its job's id. `work` runs in another thread and must not touch the editor. The label is
// shown to the user while the task runs; with an empty label, the task is not shown.
int start_task(Editor& editor, std::string label, TaskWork work, Failure failed = {});
// Handles the end of a task: calls its Finish or its Failure. Returns false if the job is no task.
bool end_task(Editor& editor, const JobStatus& job);

}  // namespace limber::editor
