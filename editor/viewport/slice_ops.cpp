// SPDX-License-Identifier: AGPL-3.0-or-later
// Stepping, shifting and zooming the slices, and the cross-hair that links them.
#include <cmath>

#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr double kWheelStep = 1.2;

// The slice under the pointer, else the one used last.
std::optional<ViewId> slice_here(const Editor& editor) {
  if (const ViewPlace* view = hovered_view(editor); view && view->id != ViewId::Body) return view->id;
  if (editor.views->active != ViewId::Body && editor.layout.place_of(editor.views->active)) return editor.views->active;
  return std::nullopt;
}

std::string needs_slice(const Editor& editor) {
  if (!editor.document().volume) return "Open a volume first";
  return slice_here(editor) ? "" : "Point at a slice";
}

void step(Editor& editor, double slices) {
  const auto view = slice_here(editor);
  if (!view) return;
  const auto volume = shown_volume(editor);
  const Grid& grid = volume->grid;
  const glm::dvec3 normal = render::frame_of(axis_of(*view)).normal;
  // Up is towards the head, the front, the left: along the axis nearest to the normal.
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

// A wheel makes whole steps, a pad parts of them.
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
  // The point under the pointer stays there.
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

// Where the pointer is in the body, or in a slice's plane.
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
      {"slice.step", "Step slice by wheel", "", "View", "Goes one slice further or back.",
       [](Editor& e) { step(e, whole_steps(e)); }, needs_slice},
      {"slice.step_five", "Step five slices by wheel", "", "View", "Goes five slices further or back.",
       [](Editor& e) { step(e, 5 * whole_steps(e)); }, needs_slice},
      {"slice.next", "Next slice", "", "View", "Goes one slice further.", [](Editor& e) { step(e, 1); }, needs_slice},
      {"slice.previous", "Previous slice", "", "View", "Goes one slice back.", [](Editor& e) { step(e, -1); },
       needs_slice},
      {"slice.zoom", "Zoom slice by wheel", "", "View", "Enlarges the slice about the pointer.", zoom, needs_slice},
      {"slice.pan", "Shift slice", "", "View", "Drag to shift the slice.", drag_slice, needs_slice},
      {"slice.outline", "Toggle outlines", "", "View", "Changes the slices between filled labels and their outlines.",
       toggle_outline, nullptr,
       [](const Editor& e) { return e.views->slice_display == render::SliceDisplay::Outline; }},
      display_operator("slice.show_labels", "Labels", "Slices show tissues as filled areas.",
                       render::SliceDisplay::Labels),
      display_operator("slice.show_outlines", "Outline", "Slices show the outlines of tissues.",
                       render::SliceDisplay::Outline),
      {"view.place_cross_hair", "Place cross-hair", icon::kCrossHair, "View",
       "Moves the point where the slices meet under the pointer.", place_cross_hair, needs_volume},
  };
}

}  // namespace limber::editor
