// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the overlays of the 3D view: its title, the axis ball, the scale bar and legends.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/deform/blend_rule.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/motion/constraint_overlay.h"
#include "editor/motion/motion_path_overlay.h"
#include "editor/motion/onion_skin_overlay.h"
#include "editor/pose/live_preview.h"
#include "editor/resample/refined_pose.h"
#include "editor/resample/results.h"
#include "editor/rig/bone_table.h"
#include "editor/rig/joint_axis_fit.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/preview_blend.h"
#include "editor/skin/painted_region.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/viewport/clipping_gizmo.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

// Radius of the axis ball, which shows the direction of view, and of the discs at its axes' ends, px at scale 1.
constexpr float kBall = 34, kEnd = 9;

struct AxisEnd {
  const char* letter;
  const char* operator_id;
  glm::dvec3 direction;  // direction from the ball's centre to the axis end, unit vector in the world
  int axis;
  bool positive;
};
constexpr AxisEnd kEnds[] = {{"L", "view.left", {1, 0, 0}, 0, true}, {"R", "view.right", {-1, 0, 0}, 0, false},
                             {"P", "view.back", {0, 1, 0}, 1, true}, {"A", "view.front", {0, -1, 0}, 1, false},
                             {"S", "view.top", {0, 0, 1}, 2, true},  {"I", "view.bottom", {0, 0, -1}, 2, false}};

void draw_axis_ball(Context& context, const Rect& rect) {
  if (!context.views->axes || rect.width() < context.ui->look.px(220) || rect.height() < context.ui->look.px(140))
    return;
  const Look& look = context.ui->look;
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const glm::vec2 centre{rect.high.x - look.px(52), rect.low.y + look.px(56)};
  const glm::dquat view_from_world = glm::conjugate(context.views->body.camera.world_from_view);

  std::array<std::pair<double, int>, 6> order;
  std::array<glm::vec2, 6> places;
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 seen = view_from_world * kEnds[i].direction;
    places[i] = centre + glm::vec2(seen.x, -seen.y) * look.px(kBall);
    order[i] = {seen.z, i};
  }
  std::sort(order.begin(), order.end());
  // If the discs of two axis ends overlap, only the disc that is nearer to the eye can be clicked.
  const float radius = look.px(kEnd);
  std::array<Pressed, 6> presses;
  for (auto nearest = order.rbegin(); nearest != order.rend(); ++nearest) {
    const int i = nearest->second;
    const auto hides = [&](const auto& other) {
      return other.first > nearest->first && glm::distance(places[other.second], places[i]) < 2 * radius;
    };
    if (std::any_of(order.begin(), order.end(), hides)) continue;
    presses[i] =
        press_area(context.ui, std::string("axis ") + kEnds[i].letter, {places[i] - radius, places[i] + radius});
    if (presses[i].hovered)
      operator_tooltip(context, *find_operator(context.operators, kEnds[i].operator_id),
                       {places[i] - radius, places[i] + radius});
  }
  for (const auto& [depth, i] : order) {
    const AxisEnd& end = kEnds[i];
    const Colour colour = look.theme.axis[end.axis];
    const Rect place{places[i] - radius, places[i] + radius};
    const Pressed& pressed = presses[i];
    if (end.positive) canvas.AddLine(im(centre), im(places[i]), colour, 2 * look.line());
    if (end.positive || pressed.hovered) canvas.AddCircleFilled(im(places[i]), radius, colour, 32);
    else {
      canvas.AddCircleFilled(im(places[i]), radius - look.px(1), look.theme.view_bottom, 32);
      canvas.AddCircleFilled(im(places[i]), radius - look.px(1), with_alpha(colour, 0.3f), 32);
      canvas.AddCircle(im(places[i]), radius - look.px(1), colour, 32, 1.2f * look.scale);
    }
    if (end.positive || pressed.hovered)
      put_text(context.ui, look.fonts.small, 0xFF141210, place, end.letter, Align::Centre);
    if (pressed.clicked) run(context, end.operator_id);
  }
}

// Returns how the pose is shown: " (dot) Mixed preview, 2-voxel grid, refining" or " (dot) Mixed, refined".
std::string preview_text(const Context& context, const PreviewMap& map) {
  const std::string blend = std::string(" \u00b7 ") + rule_of(preview_blend(context.resampling)).label;
  const std::string refinement = refinement_text(context);
  if (context.views->body.shows_refined) return blend + ", " + refinement;
  return blend + " preview, " + std::to_string(map.step) + "-voxel grid" +
         (refinement.empty() ? "" : ", " + refinement);
}

std::string state_of(const Context& context) {
  if (context.interaction->modal && !context.interaction->modal->title().empty())
    return context.interaction->modal->title();
  if (!context.document().volume) return "";
  if (context.views->scene.weights && context.views->scene.weights->weights)
    return std::string(name_of(context.skin->display)) + " \u00b7 " +
           grouped(context.views->scene.weights->weights->size()) + " tissue voxels" +
           (painted_region(context) ? " \u00b7 region of " + grouped(painted_region_voxels(context)) : "");
  if (const ProposedJoint* proposed = proposed_joint(context))
    return std::string("X-ray \u00b7 bone collisions ") + (proposed->shows_after ? "after the fit" : "before the fit");
  if (context.bone_table->coloured && context.workspace() == Workspace::Rig && context.views->scene.weights)
    return "X-ray \u00b7 bone tissue coloured by its rig bone";
  std::string state = context.views->display == render::Display::Solid   ? "Solid"
                      : context.views->display == render::Display::XRay  ? "X-ray"
                      : context.views->display == render::Display::Image ? "Image"
                                                                         : "Tissue";
  if (const auto posed = shown_result(context); posed && !comparing(context)) state += " \u00b7 " + posed->name;
  if (const Solve* solve = watched_solve(context)) state += " \u00b7 solving, " + progress_text(*solve);
  else if (const PreviewMap* map = context.views->scene.pose.get()) state += preview_text(context, *map);
  if (context.document().armature)
    state += " \u00b7 " + std::to_string(context.document().armature->bones.size()) + " bones";
  if (!context.views->renderer.note().empty()) state += " \u00b7 " + context.views->renderer.note();
  return state;
}

}  // namespace

void draw_body_overlay(Context& context, const ViewPlace& place) {
  const Rect& rect = place.rect;
  const Rect seen = context.screen->layout.uncovered(rect);
  const BodyView& body = context.views->body;
  const double visible_height = 2 * body.camera.distance * std::tan(body.camera.field_of_view / 2);
  if (context.screen->layout.by_sides) draw_side_chip(context, place);
  // In a side-by-side comparison, the view of result A has only its title, clip handles and scale bar.
  if (place.side_a) {
    draw_clip_handles(context, rect);
    return draw_scale_bar(context, rect, visible_height / rect.height());
  }
  const std::string projection = body.camera.projection == render::Projection::Perspective ? "Perspective" : "Parallel";
  std::string title = body.name.empty() ? projection : body.name + " \u00b7 " + projection;
  if (!context.project->name.empty()) title += " \u00b7 " + context.project->name;
  if (!context.screen->layout.by_sides) draw_view_title(context.ui, rect, title, state_of(context));
  draw_onion_skin(context);
  draw_motion_paths(context);
  draw_constraint_lines(context);
  draw_axis_ball(context, seen);
  if (!context.document().volume) return draw_empty_view(context, rect);
  draw_clip_handles(context, rect);
  draw_proposed_joint(context, rect);
  Rect above = rect;  // the part of the view above the legends at its lower edge
  if (draw_weight_legend(context, rect) || draw_fem_legend(context, rect)) above.high.y -= context.ui->look.px(60);
  above.high.y -= context.ui->look.px(draw_marks_legend(context, rect));
  if (!proposed_joint(context)) draw_last_operation(context, above);
  draw_scale_bar(context, seen, visible_height / rect.height());
}

}  // namespace limber::editor
