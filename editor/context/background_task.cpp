// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/background_task.h"

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

int start_task(Context& context, std::string label, TaskWork work, Failure failed, Lane lane) {
  auto finish = std::make_shared<Finish>();
  const int id = context.jobs->start(
      std::move(label),
      [finish, work = std::move(work)](Progress& progress) -> Edit {
        *finish = work(progress);
        return {};
      },
      lane);
  context.background->tasks[id] = {finish, std::move(failed)};
  context.ui->touch();
  return id;
}

bool end_task(Context& context, const JobStatus& job) {
  const auto found = context.background->tasks.find(job.id);
  if (found == context.background->tasks.end()) return false;
  const Task task = std::move(found->second);
  context.background->tasks.erase(found);
  if (job.state == JobState::Cancelled) {
    if (!job.label.empty()) context.messages->info(job.label, "Cancelled");
  } else if (job.state == JobState::Failed) {
    if (task.failed) task.failed(context, job.message);
    else context.messages->show_error(job.message, job.label);
  } else if (*task.finish) {
    attempt(context, job.label, *task.finish);
  }
  return true;
}

}  // namespace limber::editor
