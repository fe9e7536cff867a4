// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/tour.h"

#include "editor/context/editor.h"
#include "editor/files/import.h"
#include "editor/shown/shown_result.h"

namespace limber::editor {

namespace {

int hidden_tissues(const Editor& editor) {
  int count = 0;
  if (editor.document().visibility)
    for (const auto& [label, look] : editor.document().visibility->looks) count += !look.visible;
  return count;
}

int statistics_opened(const Editor& editor) {
  const auto count = editor.preferences.command_counts.find("prepare.statistics");
  return count == editor.preferences.command_counts.end() ? 0 : count->second;
}

bool turned(const Editor& editor, const TourStart& start) {
  return std::abs(glm::dot(editor.views->body.camera.world_from_view, start.turn)) < 0.999 && !editor.drag;
}
bool sees_through(const Editor& editor, const TourStart&) { return editor.views->display == render::Display::XRay; }
bool clipped(const Editor& editor, const TourStart&) {
  return editor.document().visibility && editor.document().visibility->clip_box.enabled;
}
bool hid_one(const Editor& editor, const TourStart& start) { return hidden_tissues(editor) > start.hidden; }
bool undid(const Editor& editor, const TourStart& start) { return editor.history.position() < start.position; }
bool sees_slices(const Editor& editor, const TourStart&) { return editor.arrangement().views == ViewLayout::Four; }
bool moved_cross_hair(const Editor& editor, const TourStart& start) {
  return glm::distance(editor.views->cross_hair, start.cross_hair) > 1 && !editor.drag;
}

bool counted(const Editor& editor, const TourStart& start) {
  return statistics_opened(editor) > start.statistics && !editor.dialog;
}
bool weighted(const Editor& editor, const TourStart&) { return editor.document().weights != nullptr; }
bool bent(const Editor& editor, const TourStart&) {
  const Document& document = editor.document();
  return document.armature && document.pose && *document.pose != rest_pose(*document.armature);
}
bool resampled(const Editor& editor, const TourStart& start) {
  return editor.document().results.size() > start.results;
}

bool in_skin(const Editor& editor, const TourStart&) { return editor.workspace == Workspace::Skin; }
bool in_pose(const Editor& editor, const TourStart&) { return editor.workspace == Workspace::Pose; }
bool sees_result(const Editor& editor, const TourStart&) {
  return editor.workspace == Workspace::Resample && (shown_result(editor) || editor.document().results.empty());
}

TourStart start_of(const Editor& editor) {
  return {editor.views->body.camera.world_from_view,
          editor.views->cross_hair,
          editor.history.position(),
          hidden_tissues(editor),
          editor.document().results.size(),
          statistics_opened(editor)};
}

void show_tour(Editor& editor) {
  editor.start_screen = false;
  editor.tour.shown = true;
  const int kept = editor.recent_files.tour_step;
  go_to_step(editor, kept < std::ssize(tour_steps()) ? kept : 0);
}

}  // namespace

const std::vector<TourStep>& tour_steps() {
  static const std::vector<TourStep> steps = {
      {"Turn the view", "Hold the middle mouse button and drag. Alt with the left button does the same.",
       "3D view/view", "view.orbit", turned},
      {"Look inside", "X-ray makes flesh transparent, so that you see the bones.", "view.xray_display", "view.xray",
       sees_through},
      {"Cut the body open", "The clip box hides everything outside it. Drag the squares on its faces.", "3D view/view",
       "view.clip_box", clipped},
      {"Hide a tissue", "Click the eye in front of a tissue, or point at it and press H.",
       "sidebar/sections/Tissues/fold", "view.hide", hid_one},
      {"Undo an edit", "You can undo and redo every edit.", "top/Edit", "edit.undo", undid},
      {"See slices", "Four views: the body and three slices through it, linked by the cross-hair.", "view.four",
       "view.four", sees_slices},
      {"Move the cross-hair", "Shift and the right mouse button move the cross-hair in any view; the slices follow it.",
       "3D view/view", "view.place_cross_hair", moved_cross_hair},
      {"See tissue statistics",
       "The steps lead from a volume to a posed volume. Statistics lists the volume of each tissue. Advanced shows "
       "tools that prepare a volume.",
       "Steps/Prepare/Statistics", "prepare.statistics", counted},
      {"Let tissue follow the bones",
       "Click Compute. It spreads weights from the bones through the tissue around them while you go on working.",
       "Steps/Skin/Compute", "skin.heat", weighted},
      {"See the weights",
       "In the Skin workspace, colours show how strongly tissue follows the selected bone. Its brushes change that.",
       "top/Skin", "workspace.skin", in_skin},
      {"Pose the body", "In the Pose workspace, the body follows its bones, and motions move them.", "top/Pose",
       "workspace.pose", in_pose},
      {"Bend the elbow", "Flex turns a bone about its joint by an angle in degrees. Select Forearm.",
       "Steps/Pose/Flex...", "pose.flex", bent},
      {"Resample", "Writes the posed arm as a new label volume, with a report of what changed.",
       "Steps/Resample/Resample", "resample.run", resampled},
      {"See the result", "Go to the Resample workspace: it shows the posed arm, and what changed.", "top/Resample",
       "workspace.resample", sees_result},
  };
  return steps;
}

void start_tour(Editor& editor) {
  if (editor.document().volume) return show_tour(editor);
  open_sample(editor, Sample::Arm, show_tour);
}

void go_to_step(Editor& editor, int step) {
  editor.recent_files.tour_step = step;
  if (step >= std::ssize(tour_steps())) {
    editor.tour.shown = false;
    editor.recent_files.tour_step = 0;
    editor.messages.ok("The tour is finished", "Help > Tour starts it again");
    return;
  }
  editor.tour.step = step;
  editor.tour.start = start_of(editor);
  editor.touch();
}

void end_tour(Editor& editor) {
  editor.tour.shown = false;
  editor.touch();
}

void follow_tour(Editor& editor) {
  if (!editor.tour.shown || !editor.document().volume) return;
  if (tour_steps()[editor.tour.step].done(editor, editor.tour.start)) go_to_step(editor, editor.tour.step + 1);
}

}  // namespace limber::editor
