// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/project.h"

#include <utility>

#include <backends/imgui_impl_opengl3.h>

#include "editor/opening.h"

namespace limber::editor {

namespace {

void tell_of_ended(Editor& editor, const JobStatus& job) {
  if (job.state == JobState::Failed) editor.messages.toast_failure(job.message, job.label);
  if (job.state == JobState::Cancelled) editor.messages.info(job.label, "cancelled");
}

}  // namespace

float scale_for(const Preferences& preferences, const Host& host) {
  constexpr double kStep = 0.25;  // so that fonts are not built at every pixel of a resize
  const glm::dvec2 most = glm::dvec2(host.size()) / glm::dvec2(800, 520);
  const double fitting = std::floor(std::min(most.x, most.y) / kStep) * kStep;
  return static_cast<float>(glm::clamp(std::min(preferences.scale * host.monitor_scale(), fitting), 0.75, 6.0));
}

void open_waiting_files(Editor& editor) {
  if (!editor.to_open.empty()) open_files(editor, std::exchange(editor.to_open, {}));
}

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

void commit(Editor& editor, const std::string& label, Document next) {
  editor.history.commit(label, std::move(next));
  editor.touch();
}

void frame_all(Editor& editor, bool animated) {
  Views& views = *editor.views;
  const Box box = tissue_box(views, shown_document(editor), std::nullopt);
  const Rect* place = editor.layout.place_of(ViewId::Body);
  const double aspect = place && place->height() > 0 ? place->width() / place->height() : 1.5;
  const render::Camera framed = render::framing(views.body.camera, box.low, box.high, aspect);
  if (animated && !editor.preferences.reduce_motion) views.body.move = CameraMove{views.body.camera, framed, editor.now};
  else views.body.camera = framed;
  if (!animated) views.cross_hair = middle_of_body(editor.document(), box);
  for (SliceState& slice : views.slices) {
    slice.fitted = false;
    if (const Rect* shown = editor.layout.place_of(view_of(slice.camera.axis))) fit(slice, box, shown->size());
  }
  editor.touch();
}

bool apply_look_if_changed(Editor& editor) {
  const float scale = scale_for(editor.preferences, editor.host);
  if (scale == editor.look.scale && editor.shown_theme == editor.preferences.theme) return false;
  editor.shown_theme = editor.preferences.theme;
  if (apply_look(editor.look, editor.preferences.theme, scale)) ImGui_ImplOpenGL3_DestroyFontsTexture(), ImGui_ImplOpenGL3_CreateFontsTexture();
  return true;
}

}  // namespace limber::editor
