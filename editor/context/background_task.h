// SPDX-License-Identifier: AGPL-3.0-or-later
// Background tasks, such as reading and writing files. A task is a job whose work runs in a thread of its own and whose
// result is handled in the editor's thread. The result of any other job is an edit of the document. The result of a
// task may be anything, such as another project or a list of files.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/project/job.h"

namespace limber::editor {

struct Editor;

// The function that handles a task's result in the editor's own thread. An empty function means that the result needs
// no handling.
using Finish = std::function<void(Editor&)>;
using TaskWork = std::function<Finish(Progress&)>;
// The function that handles a task's failure. If it is empty, an error message is shown instead. `error` is the text of
// the Error in one line.
using Failure = std::function<void(Editor&, const std::string& error)>;

// The step of the workflow (from a volume at rest to a posed volume) in which a job is started.
enum class StepOfWork { Prepare, Rig, Skin, Pose, Resample };

struct Task {
  std::shared_ptr<Finish> finish;
  Failure failed;
};

// Starts a task and returns the id of its job. `work` runs in another thread and must not touch the editor. The label
// is shown to the user while the task runs. A task with an empty label is not shown.
int start_task(Editor& editor, std::string label, TaskWork work, Failure failed = {});
// Handles the end of a task's job: calls the task's Finish or its Failure. Returns false if the job belongs to no task.
bool end_task(Editor& editor, const JobStatus& job);

}  // namespace limber::editor
