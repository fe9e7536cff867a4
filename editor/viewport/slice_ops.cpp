// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that step through, shift and zoom the slices, and that move the cross-hair, in which the slices meet.
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/icons.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr double kWheelStep = 1.2;

// Returns the slice view under the pointer. If there is none, returns the view that was used last, provided that this
// is a slice view and on the screen.
std::optional<ViewId> slice_here(const Context& context) {
  if (const ViewPlace* view = hovered_view(context); view && view->id != ViewId::Body) return view->id;
  if (context.views->active != ViewId::Body && context.screen->layout.place_of(context.views->active))
    return context.views->active;
  return std::nullopt;
}

std::string needs_slice(const Context& context) {
  if (!context.document().volume) return "Open a volume first";
  return slice_here(context) ? "" : "Point at a slice view first";
}

void step(Context& context, double slices) {
  const auto view = slice_here(context);
  if (!view) return;
  const auto volume = shown_volume(context);
  const Grid& grid = volume->grid;
  const glm::dvec3 normal = render::frame_of(axis_of(*view)).normal;
  // Steps along the grid's axis that is nearest to the slice's normal. A positive step goes towards the head, the back
  // or the left of the body.
  const AffineTransform world = world_from_voxel(grid);
  int nearest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(glm::dot(grid.direction[axis], normal)) > std::abs(glm::dot(grid.direction[nearest], normal)))
      nearest = axis;
  glm::dvec3 voxel = voxel_from_world(grid) * context.views->cross_hair;
  const double sign = glm::dot(world.linear[nearest], glm::abs(normal)) < 0 ? -1 : 1;
  voxel[nearest] = glm::clamp(std::round(voxel[nearest]) + sign * slices, 0.0, grid.size[nearest] - 1.0);
  context.views->cross_hair = world * voxel;
}

// Returns the number of whole wheel steps and keeps the remaining fraction for the next call, since a touch pad sends
// fractions of a step.
double whole_steps(Context& context) {
  if (context.interaction->wheel_rest * context.ui->input.wheel < 0) context.interaction->wheel_rest = 0;
  context.interaction->wheel_rest += context.ui->input.wheel;
  const float whole = std::trunc(context.interaction->wheel_rest);
  context.interaction->wheel_rest -= whole;
  return whole;
}

void zoom(Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!place || place->id == ViewId::Body) return;
  render::SliceCamera& camera = slice_of(*context.views, place->id).camera;
  // Zooms so that the point under the pointer stays under the pointer.
  const glm::vec2 pixel = context.ui->input.pointer - place->rect.low, size = place->rect.size();
  const glm::dvec3 before = world_of(camera, pixel, size);
  camera.millimetres_per_pixel =
      glm::clamp(camera.millimetres_per_pixel * std::pow(kWheelStep, -context.ui->input.wheel), 1e-4, 100.0);
  camera.centre += before - world_of(camera, pixel, size);
}

void drag_slice(Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!place || place->id == ViewId::Body) return;
  const glm::dvec3 before = slice_of(*context.views, place->id).camera.centre;
  context.interaction->drag =
      Drag{MouseButton::Middle,
           [id = place->id](Context& c, const glm::vec2& by) { shift(slice_of(*c.views, id), glm::dvec2(by)); },
           {},
           [id = place->id, before](Context& c) { slice_of(*c.views, id).camera.centre = before; },
           PointerWrap(place->rect, context.ui->look.px(2))};
}

// Moves the cross-hair to the point under the pointer. In the 3D view this is a point of the body's surface, in a slice
// view a point in the plane of the slice.
void put_cross_hair(Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!place) return;
  if (place->id == ViewId::Body) {
    if (context.views->hover.inside) context.views->cross_hair = context.views->hover.point;
    return;
  }
  const Box box = world_box(shown_document(context));
  const glm::dvec3 point = world_of(slice_of(*context.views, place->id).camera,
                                    context.ui->input.pointer - place->rect.low, place->rect.size());
  context.views->cross_hair = glm::clamp(point, box.low, box.high);
}

void place_cross_hair(Context& context) {
  put_cross_hair(context);
  const MouseButton button = context.ui->input.down(MouseButton::Right) ? MouseButton::Right : MouseButton::Left;
  context.interaction->drag = Drag{button, [](Context& c, const glm::vec2&) { put_cross_hair(c); }};
}

void toggle_outline(Context& context) {
  auto& display = context.views->slice_display;
  display = display == render::SliceDisplay::Labels ? render::SliceDisplay::Outline : render::SliceDisplay::Labels;
}

Operator display_operator(const char* id, const char* label, const char* description, render::SliceDisplay display) {
  return {id,          label,
          "",          "View",
          description, [display](Context& c) { c.views->slice_display = display; },
          nullptr,     [display](const Context& c) { return c.views->slice_display == display; }};
}

}  // namespace

std::vector<Operator> slice_operators() {
  return {
      {"slice.step", "Step slice by wheel", "", "View", "Move to the next or the previous slice.",
       [](Context& c) { step(c, whole_steps(c)); }, needs_slice},
      {"slice.step_five", "Step five slices by wheel", "", "View", "Move forward or back by five slices.",
       [](Context& c) { step(c, 5 * whole_steps(c)); }, needs_slice},
      {"slice.next", "Next slice", "", "View", "Move to the next slice.", [](Context& c) { step(c, 1); }, needs_slice},
      {"slice.previous", "Previous slice", "", "View", "Move to the previous slice.", [](Context& c) { step(c, -1); },
       needs_slice},
      {"slice.zoom", "Zoom slice by wheel", "", "View", "Zoom the slice in or out about the pointer.", zoom,
       needs_slice},
      {"slice.pan", "Pan slice", "", "View", "Drag to move the slice within its view.", drag_slice, needs_slice},
      {"slice.outline", "Toggle outlines", "", "View", "Switch the slices between filled tissues and their outlines.",
       toggle_outline, nullptr,
       [](const Context& c) { return c.views->slice_display == render::SliceDisplay::Outline; }},
      display_operator("slice.show_labels", "Labels", "Show tissues in the slices as filled areas.",
                       render::SliceDisplay::Labels),
      display_operator("slice.show_outlines", "Outline", "Show tissues in the slices as outlines.",
                       render::SliceDisplay::Outline),
      {"view.place_cross_hair", "Move cross-hair", icon::kCrossHair, "View",
       "Move the cross-hair, the point where the slices meet, to the pointer.", place_cross_hair, needs_volume},
  };
}

}  // namespace limber::editor
