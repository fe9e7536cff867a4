// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Clipping": number fields for the positions of the clip box and the clip plane, in mm. The user can
// also change these positions by handles in the 3D view.
#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/field_edit.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"
#include "editor/ui/input_fields.h"
#include "editor/viewport/clipping_gizmo.h"

namespace limber::editor {

namespace {

// Draws a number field. While the user drags the number, only a preview changes. The document changes once, when the
// drag ends.
void draw_number(Context& context, const Rect& rect, const std::string& name, double value, double low, double high,
                 const char* edit, const std::function<void(Visibility&, double)>& set) {
  auto& edited = context.field_edit->number;
  if (edited.name == name) value = edited.value;
  bool committed = false;
  const auto with = [&](double number) {
    Visibility next = *context.document().visibility;
    set(next, number);
    return next;
  };
  if (number_field(context.ui, name, rect, value, low, high, "%.1f", "mm", false, committed)) {
    edited = {name, value};
    context.views->preview_visibility = std::make_shared<const Visibility>(with(value));
    context.ui->touch();
  }
  if (!committed || edited.name != name) return;
  context.views->preview_visibility.reset();
  const Visibility next = with(edited.value);
  edited = {};
  Document document = context.document();
  if (next == *document.visibility) return;
  document.visibility = std::make_shared<const Visibility>(next);
  commit(context, edit, std::move(document));
}

// Returns the grid's axis that is nearest to a world axis, so that the panel's rows mean left-right, front-back and
// feet-head for every orientation of the grid.
int grid_axis_near(const Grid& grid, int world_axis) {
  int nearest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(grid.direction[axis][world_axis]) > std::abs(grid.direction[nearest][world_axis])) nearest = axis;
  return nearest;
}

void draw_box(Context& context, Column& column, const Grid& grid, const ClipBox& box) {
  const Look& look = context.ui->look;
  const AffineTransform world = world_from_voxel(grid);
  for (int w = 0; w < 3; ++w) {
    const int axis = grid_axis_near(grid, w);
    // The world coordinate of a voxel on this grid axis is first + step * voxel, in mm.
    const double step = world.linear[axis][w],
                 first = (world * ((glm::dvec3(grid.size) - 1.0) * 0.5))[w] - step * (grid.size[axis] - 1) * 0.5;
    const auto place = [&](double voxel) { return first + step * voxel; };
    const bool turned = step < 0;
    const double low = turned ? box.high[axis] : box.low[axis], high = turned ? box.low[axis] : box.high[axis];
    const double least = std::min(place(-0.5), place(grid.size[axis] - 0.5)),
                 most = std::max(place(-0.5), place(grid.size[axis] - 0.5));
    const Rect rect = column.property(std::string("Box ") + "XYZ"[w]);
    const float middle = std::round(rect.centre().x);
    const auto field = [&](const char* end, const Rect& at, double voxel, bool is_high) {
      fill({at.low, {at.low.x + look.px(3), at.high.y}}, look.theme.axis[w]);
      draw_number(context, {{at.low.x + look.px(4), at.low.y}, at.high}, std::string(1, "XYZ"[w]) + " " + end,
                  place(voxel), least, most, "Move clip box", [=](Visibility& visibility, double mm) {
                    move_face(visibility.clip_box, grid, axis, is_high, (mm - first) / step);
                  });
    };
    field("from", {rect.low, {middle - look.px(2), rect.high.y}}, low, turned);
    field("to", {{middle + look.px(2), rect.low.y}, rect.high}, high, !turned);
  }
}

void draw_plane(Context& context, Column& column, const Grid& grid, const ClipPlane& plane) {
  const AffineTransform world = world_from_voxel(grid);
  const double reach = glm::length(world.linear * glm::dvec3(grid.size)) / 2;
  const glm::dvec3 middle = world * ((glm::dvec3(grid.size) - 1.0) * 0.5);
  const double depth = glm::dot(plane.point - middle, plane.normal);
  draw_number(context, column.property("Plane"), "Plane", depth, -reach, reach, "Move clip plane",
              [=](Visibility& visibility, double mm) { visibility.clip_plane.point += plane.normal * (mm - depth); });
}

}  // namespace

void draw_clipping(Context& context, Column& column) {
  const auto visibility =
      context.views->preview_visibility ? context.views->preview_visibility : context.document().visibility;
  const auto volume = context.document().volume;
  if (!volume || !visibility || !(visibility->clip_box.enabled || visibility->clip_plane.enabled)) return;
  if (column.begin_section("Clipping")) {
    column.space(6);
    if (visibility->clip_box.enabled) draw_box(context, column, volume->grid, visibility->clip_box);
    if (visibility->clip_plane.enabled)
      draw_plane(context, column, volume->grid, context.document().visibility->clip_plane);
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
