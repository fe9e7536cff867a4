// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that step through, shift and zoom the slices, and that move the cross-hair, in which the slices meet.
#include <cmath>

#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr double kWheelStep = 1.2;

// Returns the slice view under the pointer. If there is none, returns the view that was used last, provided that this
// is a slice view and on the screen.
std::optional<ViewId> slice_here(const Editor& editor) {
  if (const ViewPlace* view = hovered_view(editor); view && view->id != ViewId::Body) return view->id;
  if (editor.views->active != ViewId::Body && editor.layout.place_of(editor.views->active)) return editor.views->active;
  return std::nullopt;
}

std::string needs_slice(const Editor& editor) {
  if (!editor.document().volume) return "Open a volume first";
  return slice_here(editor) ? "" : "Point at a slice view first";
}

void step(Editor& editor, double slices) {
  const auto view = slice_here(editor);
  if (!view) return;
  const auto volume = shown_volume(editor);
  const Grid& grid = volume->grid;
  const glm::dvec3 normal = render::frame_of(axis_of(*view)).normal;
  // Steps along the grid's axis that is nearest to the slice's normal. A positive step goes towards the head, the back
  // or the left of the body.
  const AffineTransform world = world_from_voxel(grid);
  int nearest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(glm::dot(grid.direction[axis], normal)) > std::abs(glm::dot(grid.direction[nearest], normal)))
      nearest = axis;
  glm::dvec3 voxel = voxel_from_world(grid) * editor.views->cross_hair;
  const double sign = glm::dot(world.linear[nearest], glm::abs(normal)) < 0 ? -1 : 1;
  voxel[nearest] = glm::clamp(std::round(voxel[nearest]) + sign * slices, 0.0, grid.size[nearest] - 1.0);
  editor.views->cross_hair = world * voxel;
}

// Returns the number of whole wheel steps and keeps the remaining fraction for the next call, since a touch pad sends
// fractions of a step.
double whole_steps(Editor& editor) {
  if (editor.wheel_rest * editor.input.wheel < 0) editor.wheel_rest = 0;
  editor.wheel_rest += editor.input.wheel;
  const float whole = std::trunc(editor.wheel_rest);
  editor.wheel_rest -= whole;
  return whole;
}

void zoom(Editor& editor) {
  const ViewPlace* place = hovered_view(editor);
  if (!place || place->id == ViewId::Body) return;
  render::SliceCamera& camera = slice_of(*editor.views, place->id).camera;
  // Zooms so that the point under the pointer stays under the pointer.
  const glm::vec2 pixel = editor.input.pointer - place->rect.low, size = place->rect.size();
  const glm::dvec3 before = world_of(camera, pixel, size);
  camera.millimetres_per_pixel =
      glm::clamp(camera.millimetres_per_pixel * std::pow(kWheelStep, -editor.input.wheel), 1e-4, 100.0);
  camera.centre += before - world_of(camera, pixel, size);
}

void drag_slice(Editor& editor) {
  const ViewPlace* place = hovered_view(editor);
  if (!place || place->id == ViewId::Body) return;
  const glm::dvec3 before = slice_of(*editor.views, place->id).camera.centre;
  editor.drag =
      Drag{MouseButton::Middle,
           [id = place->id](Editor& e, const glm::vec2& by) { shift(slice_of(*e.views, id), glm::dvec2(by)); },
           {},
           [id = place->id, before](Editor& e) { slice_of(*e.views, id).camera.centre = before; },
           PointerWrap(place->rect, editor.look.px(2))};
}

// Moves the cross-hair to the point under the pointer. In the 3D view this is a point of the body's surface, in a slice
// view a point in the plane of the slice.
void put_cross_hair(Editor& editor) {
  const ViewPlace* place = hovered_view(editor);
  if (!place) return;
  if (place->id == ViewId::Body) {
    if (editor.views->hover.inside) editor.views->cross_hair = editor.views->hover.point;
    return;
  }
  const Box box = world_box(shown_document(editor));
  const glm::dvec3 point =
      world_of(slice_of(*editor.views, place->id).camera, editor.input.pointer - place->rect.low, place->rect.size());
  editor.views->cross_hair = glm::clamp(point, box.low, box.high);
}

void place_cross_hair(Editor& editor) {
  put_cross_hair(editor);
  const MouseButton button = editor.input.down(MouseButton::Right) ? MouseButton::Right : MouseButton::Left;
  editor.drag = Drag{button, [](Editor& e, const glm::vec2&) { put_cross_hair(e); }};
}

void toggle_outline(Editor& editor) {
  auto& display = editor.views->slice_display;
  display = display == render::SliceDisplay::Labels ? render::SliceDisplay::Outline : render::SliceDisplay::Labels;
}

Operator display_operator(const char* id, const char* label, const char* description, render::SliceDisplay display) {
  return {id,          label,
          "",          "View",
          description, [display](Editor& e) { e.views->slice_display = display; },
          nullptr,     [display](const Editor& e) { return e.views->slice_display == display; }};
}

}  // namespace

std::vector<Operator> slice_operators() {
  return {
      {"slice.step", "Step slice by wheel", "", "View", "Move to the next or the previous slice.",
       [](Editor& e) { step(e, whole_steps(e)); }, needs_slice},
      {"slice.step_five", "Step five slices by wheel", "", "View", "Move forward or back by five slices.",
       [](Editor& e) { step(e, 5 * whole_steps(e)); }, needs_slice},
      {"slice.next", "Next slice", "", "View", "Move to the next slice.", [](Editor& e) { step(e, 1); }, needs_slice},
      {"slice.previous", "Previous slice", "", "View", "Move to the previous slice.", [](Editor& e) { step(e, -1); },
       needs_slice},
      {"slice.zoom", "Zoom slice by wheel", "", "View", "Zoom the slice in or out about the pointer.", zoom,
       needs_slice},
      {"slice.pan", "Pan slice", "", "View", "Drag to move the slice within its view.", drag_slice, needs_slice},
      {"slice.outline", "Toggle outlines", "", "View", "Switch the slices between filled tissues and their outlines.",
       toggle_outline, nullptr,
       [](const Editor& e) { return e.views->slice_display == render::SliceDisplay::Outline; }},
      display_operator("slice.show_labels", "Labels", "Show tissues in the slices as filled areas.",
                       render::SliceDisplay::Labels),
      display_operator("slice.show_outlines", "Outline", "Show tissues in the slices as outlines.",
                       render::SliceDisplay::Outline),
      {"view.place_cross_hair", "Move cross-hair", icon::kCrossHair, "View",
       "Move the cross-hair, the point where the slices meet, to the pointer.", place_cross_hair, needs_volume},
  };
}

}  // namespace limber::editor
