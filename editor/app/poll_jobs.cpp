// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/poll_jobs.h"

#include "editor/shown/frame_all.h"

namespace limber::editor {

namespace {

void tell_of_ended(Editor& editor, const JobStatus& job) {
  if (job.state == JobState::Failed) editor.messages.toast_failure(job.message, job.label);
  if (job.state == JobState::Cancelled) editor.messages.info(job.label, "cancelled");
}

// Deselects the tissues that the document does not have.
void keep_present_tissues(Editor& editor) {
  Selection& selection = editor.selection;
  const auto tissues = editor.document().tissues;
  std::erase_if(selection.tissues, [&](Label label) { return !tissues || !tissues->find(label); });
  if (selection.tissue && (!tissues || !tissues->find(*selection.tissue))) selection.tissue.reset();
}

}  // namespace

bool poll_jobs(Editor& editor) {
  const auto volume_before = editor.document().volume;
  const bool changed = editor.jobs.poll(editor.history);
  if (!changed) return false;
  const auto volume = editor.document().volume;
  if (volume != volume_before) {
    // If the grid stays the same, only labels were edited, so the cameras and the selection do not change.
    if (volume && volume_before && volume->grid == volume_before->grid) {
      keep_present_tissues(editor);
    } else {
      editor.selection = {};
      frame_all(editor, false);
    }
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
