// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/poll_jobs.h"

#include "editor/shown/frame_all.h"

namespace limber::editor {

namespace {

void tell_of_ended(Editor& editor, const JobStatus& job) {
  if (job.state == JobState::Failed) editor.messages.toast_failure(job.message, job.label);
  if (job.state == JobState::Cancelled) editor.messages.info(job.label, "cancelled");
}

}  // namespace

bool poll_jobs(Editor& editor) {
  const auto volume_before = editor.document().volume;
  const bool changed = editor.jobs.poll(editor.history);
  if (!changed) return false;
  if (editor.document().volume != volume_before) {
    editor.selection = {};
    frame_all(editor, false);
  }
  for (const JobStatus& job : editor.jobs.statuses()) {
    if (job.active()) continue;
    if (const auto follow = editor.after_job.extract(job.id)) follow.mapped()(editor, job);
    editor.jobs.dismiss(job.id);
    editor.step_of_job.erase(job.id);
    if (!end_task(editor, job)) tell_of_ended(editor, job);
  }
  return true;
}

}  // namespace limber::editor
