// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/tour.h"

#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/preferences.h"
#include "editor/context/recent_files.h"
#include "editor/context/screen.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/views.h"
#include "editor/files/import.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

int hidden_tissues(const Document& document) {
  int count = 0;
  if (document.visibility)
    for (const auto& [label, look] : document.visibility->looks) count += !look.visible;
  return count;
}

int statistics_opened(const Preferences& preferences) {
  const auto count = preferences.command_counts.find("prepare.statistics");
  return count == preferences.command_counts.end() ? 0 : count->second;
}

bool turned(const Context& context, const TourStart& start) {
  return std::abs(glm::dot(context.views->body.camera.world_from_view, start.turn)) < 0.999 &&
         !context.interaction->drag;
}
bool sees_through(const Context& context, const TourStart&) { return context.views->display == render::Display::XRay; }
bool clipped(const Context& context, const TourStart&) {
  return context.document().visibility && context.document().visibility->clip_box.enabled;
}
bool hid_one(const Context& context, const TourStart& start) {
  return hidden_tissues(context.document()) > start.hidden;
}
bool undid(const Context& context, const TourStart& start) { return context.history->position() < start.position; }
bool sees_slices(const Context& context, const TourStart&) {
  return context.screen->arrangement().views == ViewLayout::Four;
}
bool moved_cross_hair(const Context& context, const TourStart& start) {
  return glm::distance(context.views->cross_hair, start.cross_hair) > 1 && !context.interaction->drag;
}

bool counted(const Context& context, const TourStart& start) {
  return statistics_opened(context.preferences) > start.statistics && !context.dialogs->shown;
}
bool weighted(const Context& context, const TourStart&) { return context.document().weights != nullptr; }
bool bent(const Context& context, const TourStart&) {
  const Document& document = context.document();
  return document.armature && document.pose && *document.pose != rest_pose(*document.armature);
}
bool resampled(const Context& context, const TourStart& start) {
  return context.document().results.size() > start.results;
}

bool in_skin(const Context& context, const TourStart&) { return context.workspace() == Workspace::Skin; }
bool in_pose(const Context& context, const TourStart&) { return context.workspace() == Workspace::Pose; }
bool sees_result(const Context& context, const TourStart&) {
  return context.workspace() == Workspace::Resample && (shown_result(context) || context.document().results.empty());
}

TourStart start_of(const Context& context) {
  return {context.views->body.camera.world_from_view,
          context.views->cross_hair,
          context.history->position(),
          hidden_tissues(context.document()),
          context.document().results.size(),
          statistics_opened(context.preferences)};
}

void show_tour(Context& context) {
  context.start_screen->shown = false;
  context.tour->shown = true;
  const int kept = context.recent_files->tour_step;
  go_to_step(context, kept < std::ssize(tour_steps()) ? kept : 0);
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
       "In the Skin workspace, colours show how strongly tissue follows the selected bone. The brushes change the "
       "weights.",
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

void start_tour(Context& context) {
  if (context.document().volume) return show_tour(context);
  open_sample(context, Sample::Arm, show_tour);
}

void go_to_step(Context& context, int step) {
  context.recent_files->tour_step = step;
  if (step >= std::ssize(tour_steps())) {
    context.tour->shown = false;
    context.recent_files->tour_step = 0;
    context.messages->ok("The tour is finished", "Help > Tour starts it again");
    return;
  }
  context.tour->step = step;
  context.tour->start = start_of(context);
  context.ui->touch();
}

void end_tour(Context& context) {
  context.tour->shown = false;
  context.ui->touch();
}

void follow_tour(Context& context) {
  if (!context.tour->shown || !context.document().volume) return;
  if (tour_steps()[context.tour->step].done(context, context.tour->start)) go_to_step(context, context.tour->step + 1);
}

}  // namespace limber::editor
