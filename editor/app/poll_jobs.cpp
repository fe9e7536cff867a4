// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/poll_jobs.h"

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/shown/frame_all.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

void tell_of_ended(Messages& messages, const JobStatus& job) {
  if (job.state == JobState::Failed) messages.toast_failure(job.message, job.label);
  if (job.state == JobState::Cancelled) messages.info(job.label, "cancelled");
}

// Deselects the tissues that the document does not have.
void keep_present_tissues(Context& context) {
  Selection& selection = context.selection;
  const auto tissues = context.document().tissues;
  std::erase_if(selection.tissues, [&](Label label) { return !tissues || !tissues->find(label); });
  if (selection.tissue && (!tissues || !tissues->find(*selection.tissue))) selection.tissue.reset();
}

}  // namespace

bool poll_jobs(Context& context) {
  const auto volume_before = context.document().volume;
  const bool changed = context.jobs->poll(context.history);
  if (!changed) return false;
  const auto volume = context.document().volume;
  if (volume != volume_before) {
    // If the grid stays the same, only labels were edited. Then the cameras do not move, and tissues stay selected if
    // they still exist.
    if (volume && volume_before && volume->grid == volume_before->grid) {
      keep_present_tissues(context);
    } else {
      *context.selection = {};
      frame_all(context, false);
    }
  }
  for (const JobStatus& job : context.jobs->statuses()) {
    if (job.active()) continue;
    if (const auto follow = context.background->after_job.extract(job.id)) follow.mapped()(context, job);
    context.jobs->dismiss(job.id);
    context.background->step_of_job.erase(job.id);
    if (!end_task(context, job)) tell_of_ended(context.messages, job);
  }
  return true;
}

}  // namespace limber::editor
