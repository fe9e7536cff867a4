// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the overlays of the 3D view: its title, the axis ball, the scale bar and legends.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/deform/blend_rule.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/motion/constraint_overlay.h"
#include "editor/motion/motion_path_overlay.h"
#include "editor/motion/onion_skin_overlay.h"
#include "editor/pose/live_preview.h"
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

void draw_axis_ball(Editor& editor, const Rect& rect) {
  if (!editor.views->axes || rect.width() < editor.look.px(220) || rect.height() < editor.look.px(140)) return;
  const Look& look = editor.look;
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const glm::vec2 centre{rect.high.x - look.px(52), rect.low.y + look.px(56)};
  const glm::dquat view_from_world = glm::conjugate(editor.views->body.camera.world_from_view);

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
    presses[i] = press_area(editor, std::string("axis ") + kEnds[i].letter, {places[i] - radius, places[i] + radius});
    if (presses[i].hovered)
      operator_tooltip(editor, *find_operator(editor, kEnds[i].operator_id), {places[i] - radius, places[i] + radius});
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
      put_text(editor, look.fonts.small, 0xFF141210, place, end.letter, Align::Centre);
    if (pressed.clicked) run(editor, end.operator_id);
  }
}

std::string state_of(const Editor& editor) {
  if (editor.modal && !editor.modal->title().empty()) return editor.modal->title();
  if (!editor.document().volume) return "";
  if (editor.views->scene.weights && editor.views->scene.weights->weights)
    return std::string(name_of(editor.skin->display)) + " \u00b7 " +
           grouped(editor.views->scene.weights->weights->size()) + " tissue voxels" +
           (painted_region(editor) ? " \u00b7 region of " + grouped(painted_region_voxels(editor)) : "");
  if (const ProposedJoint* proposed = proposed_joint(editor))
    return std::string("X-ray \u00b7 bone overlap about the axis ") +
           (proposed->shows_after ? "after the fit" : "before the fit");
  if (editor.bone_table->coloured && editor.workspace == Workspace::Rig && editor.views->scene.weights)
    return "X-ray \u00b7 bone tissue coloured by its rig bone";
  std::string state = editor.views->display == render::Display::Solid   ? "Solid"
                      : editor.views->display == render::Display::XRay  ? "X-ray"
                      : editor.views->display == render::Display::Image ? "Image"
                                                                        : "Tissue";
  if (const auto posed = shown_result(editor); posed && !comparing(editor)) state += " \u00b7 " + posed->name;
  if (const Solve* solve = watched_solve(editor)) state += " \u00b7 solving, " + progress_text(*solve);
  else if (const PreviewMap* map = editor.views->scene.pose.get())
    state += std::string(" \u00b7 ") + rule_of(preview_blend(editor)).label + " preview, " + std::to_string(map->step) +
             "-voxel lattice";
  if (editor.document().armature)
    state += " \u00b7 " + std::to_string(editor.document().armature->bones.size()) + " bones";
  if (!editor.views->renderer.note().empty()) state += " \u00b7 " + editor.views->renderer.note();
  return state;
}

}  // namespace

void draw_body_overlay(Editor& editor, const ViewPlace& place) {
  const Rect& rect = place.rect;
  const BodyView& body = editor.views->body;
  const double visible_height = 2 * body.camera.distance * std::tan(body.camera.field_of_view / 2);
  if (editor.layout.by_sides) draw_side_chip(editor, place);
  // In a side-by-side comparison, the view of side A has only its title, clip handles and scale bar.
  if (place.side_a) {
    draw_clip_handles(editor, rect);
    return draw_scale_bar(editor, rect, visible_height / rect.height());
  }
  const std::string projection = body.camera.projection == render::Projection::Perspective ? "Perspective" : "Parallel";
  std::string title = body.name.empty() ? projection : body.name + " \u00b7 " + projection;
  if (!editor.name.empty()) title += " \u00b7 " + editor.name;
  if (!editor.layout.by_sides) draw_view_title(editor, rect, title, state_of(editor));
  draw_onion_skin(editor);
  draw_motion_paths(editor);
  draw_constraint_lines(editor);
  draw_axis_ball(editor, rect);
  if (!editor.document().volume) return draw_empty_view(editor, rect);
  draw_clip_handles(editor, rect);
  draw_proposed_joint(editor, rect);
  Rect above = rect;  // the part of the view above the legends at its lower edge
  if (draw_weight_legend(editor, rect) || draw_fem_legend(editor, rect)) above.high.y -= editor.look.px(60);
  above.high.y -= editor.look.px(draw_marks_legend(editor, rect));
  if (!proposed_joint(editor)) draw_last_operation(editor, above);
  draw_scale_bar(editor, rect, visible_height / rect.height());
}

}  // namespace limber::editor
