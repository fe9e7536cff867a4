// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/background_task.h"

#include "editor/context/editor.h"

namespace limber::editor {

int start_task(Editor& editor, std::string label, TaskWork work, Failure failed) {
  auto finish = std::make_shared<Finish>();
  const int id = editor.jobs.start(std::move(label), [finish, work = std::move(work)](Progress& progress) -> Edit {
    *finish = work(progress);
    return {};
  });
  editor.tasks[id] = {finish, std::move(failed)};
  editor.touch();
  return id;
}

bool end_task(Editor& editor, const JobStatus& job) {
  const auto found = editor.tasks.find(job.id);
  if (found == editor.tasks.end()) return false;
  const Task task = std::move(found->second);
  editor.tasks.erase(found);
  if (job.state == JobState::Cancelled) {
    if (!job.label.empty()) editor.messages.info(job.label, "Cancelled");
  } else if (job.state == JobState::Failed) {
    if (task.failed) task.failed(editor, job.message);
    else editor.messages.show_error(job.message, job.label);
  } else if (*task.finish) {
    attempt(editor, job.label, *task.finish);
  }
  return true;
}

}  // namespace limber::editor
