// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the overlays of a slice view: the slice's name and number, orientation letters, the crosshair, the slice bar (a
// slider that selects the slice) and the scale bar.
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/measure/ruler_overlay.h"
#include "editor/resample/results.h"
#include "editor/shown/compare_wipe.h"
#include "editor/skin/weight_display.h"

namespace limber::editor {

namespace {

char letter_of(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  if (size.x > size.y && size.x > size.z) return direction.x > 0 ? 'L' : 'R';
  if (size.y > size.z) return direction.y > 0 ? 'P' : 'A';
  return direction.z > 0 ? 'S' : 'I';
}

void draw_letters(Context& context, const render::SliceFrame& frame, const Rect& rect) {
  if (!context.views->letters) return;
  const Look& look = context.ui->look;
  const auto put = [&](const glm::vec2& centre, const glm::dvec3& direction) {
    const char text[2] = {letter_of(direction), 0};
    fill({centre - look.px(9), centre + look.px(9)}, with_alpha(look.theme.view_plate, 0.5f), look.px(4));
    put_text(context.ui, look.fonts.semibold, look.theme.view_text, Rect{centre - look.px(10), centre + look.px(10)},
             text, Align::Centre);
  };
  const glm::vec2 middle = rect.centre();
  put({rect.low.x + look.px(15), middle.y}, -frame.right);
  put({rect.high.x - look.px(44), middle.y}, frame.right);  // 44 px from the edge, because the slice bar is beside it
  put({middle.x, rect.low.y + look.px(14)}, -frame.down);
  put({middle.x, rect.high.y - look.px(14)}, frame.down);
}

// Draws the crosshair. Each of its two lines marks a position on a world axis and has the colour of this axis. The
// lines have a gap of 24 px at the centre.
void draw_cross_hair(Context& context, const render::SliceCamera& camera, const render::SliceFrame& frame,
                     const Rect& rect) {
  if (!context.views->show_cross_hair) return;
  const Look& look = context.ui->look;
  const glm::vec2 at = glm::round(rect.low + pixel_of(camera, context.views->cross_hair, rect.size()));
  const auto axis_of = [](const glm::dvec3& v) { return std::abs(v.x) > 0.5 ? 0 : std::abs(v.y) > 0.5 ? 1 : 2; };
  const Colour upright = look.theme.axis[axis_of(frame.right)], level = look.theme.axis[axis_of(frame.down)];
  const float gap = look.px(12), line = look.line();
  fill({{at.x, rect.low.y}, {at.x + line, std::min(at.y - gap, rect.high.y)}}, upright);
  fill({{at.x, std::max(at.y + gap, rect.low.y)}, {at.x + line, rect.high.y}}, upright);
  fill({{rect.low.x, at.y}, {std::min(at.x - gap, rect.high.x), at.y + line}}, level);
  fill({{std::max(at.x + gap, rect.low.x), at.y}, {rect.high.x, at.y + line}}, level);
}

// Returns the grid axis that is closest to the slice's normal. The slice bar moves the slice along this axis, voxel by
// voxel.
int grid_axis_of(const Grid& grid, const glm::dvec3& normal) {
  int nearest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(glm::dot(grid.direction[axis], normal)) > std::abs(glm::dot(grid.direction[nearest], normal)))
      nearest = axis;
  return nearest;
}

void draw_slice_bar(Context& context, const Grid& grid, int axis, const Rect& rect) {
  const Look& look = context.ui->look;
  const float height = std::min(look.px(280), rect.height() - look.px(120));
  if (height < look.px(60)) return;
  const float x = rect.high.x - look.px(20), top = std::round(rect.centre().y - height / 2);
  const Rect track{{x, top}, {x + look.px(4), top + height}};
  const Rect grip{{track.low.x - look.px(6), track.low.y}, {track.high.x + look.px(6), track.high.y}};
  const Pressed pressed = press_area(context.ui, "slice bar", grip);
  const AffineTransform world = world_from_voxel(grid);
  glm::dvec3 voxel = voxel_from_world(grid) * context.views->cross_hair;
  const double last = std::max(grid.size[axis] - 1, 1);
  // True if the grid axis points to the body's left, back or head.
  const bool upward = glm::dot(glm::dvec3(grid.direction[axis]), glm::dvec3(1)) > 0;
  if (pressed.held) {
    const double share =
        glm::clamp(static_cast<double>((context.ui->input.pointer.y - track.low.y) / track.height()), 0.0, 1.0);
    voxel[axis] = std::round((upward ? 1 - share : share) * last);
    context.views->cross_hair = world * voxel;
  }
  const double share = glm::clamp(voxel[axis] / last, 0.0, 1.0);
  const float y = track.low.y + static_cast<float>(upward ? 1 - share : share) * track.height();
  fill(track, with_alpha(look.theme.view_plate, 0.85f), look.px(2));
  fill({{x - look.px(3), y - look.px(10)}, {x + look.px(7), y + look.px(10)}},
       pressed.hovered || pressed.held ? look.theme.view_text : look.theme.view_text2, look.px(3));
}

}  // namespace

void draw_slice_overlay(Context& context, const ViewPlace& place) {
  const auto& [id, rect, side_a] = place;
  const render::SliceCamera& camera = slice_of(*context.views, id).camera;
  const render::SliceFrame frame = render::frame_of(camera.axis);
  if (!context.document().volume) return draw_view_title(context.ui, rect, name_of(id), "");
  const render::Scene& scene = scene_of(context, place);
  const Grid& grid = scene.volume->grid;
  const int axis = grid_axis_of(grid, frame.normal);
  const int slice = static_cast<int>(std::lround((voxel_from_world(grid) * context.views->cross_hair)[axis]));
  draw_cross_hair(context, camera, frame, rect);
  draw_rulers(context, place);
  const Rect free = beside_rulers(context, rect);
  std::string state =
      std::string(1, "xyz"[axis]) + " " + std::to_string(slice) + " of " + std::to_string(grid.size[axis]);
  if (rect.width() > context.ui->look.px(300)) {
    if (!is_of_document(context, scene.volume) || scene.pose) state += " \u00b7 posed";
    const std::string& note = context.views->renderer.note();
    if (!note.empty()) state += " \u00b7 " + note.substr(0, note.find(':'));
  }
  draw_view_title(context.ui, free,
                  (context.screen->layout.by_sides ? side_a ? "A \u00b7 " : "B \u00b7 " : "") + name_of(id), state);
  draw_letters(context, frame, free);
  draw_slice_bar(context, grid, axis, rect);
  draw_scale_bar(context, free, camera.millimetres_per_pixel);
  if (context.screen->layout.place_of(ViewId::Body) || side_a) return;
  draw_fem_legend(context, rect);
  draw_marks_legend(context, rect);
}

}  // namespace limber::editor
