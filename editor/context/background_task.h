// SPDX-License-Identifier: AGPL-3.0-or-later
// Work beside the editor whose end the editor meets: reading, writing, rendering of files. Unlike a plain job its
// result is more than an edit of the document (another project, a saved one, a list of files).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/project/job.h"

namespace limber::editor {

struct Editor;

// What is to be done with the result, in the editor's own thread; may be empty.
using Finish = std::function<void(Editor&)>;
using TaskWork = std::function<Finish(Progress&)>;
// Meets a failure instead of the message that is shown otherwise. `error` is an Error's line.
using Failure = std::function<void(Editor&, const std::string& error)>;

// The steps from a volume to a posed one, for which a job may be at work.
enum class StepOfWork { Prepare, Rig, Skin, Pose, Resample };

struct Task {
  std::shared_ptr<Finish> finish;
  Failure failed;
};

// Touches nothing of the editor in `work`. Its label is shown while it runs; an empty one stays unseen.
int start_task(Editor& editor, std::string label, TaskWork work, Failure failed = {});
// Of a job that has ended: true when it was a task, whose end has now been met.
bool end_task(Editor& editor, const JobStatus& job);

}  // namespace limber::editor
