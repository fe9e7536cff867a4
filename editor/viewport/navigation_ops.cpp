// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that turn, shift and zoom the 3D view, as in Blender.
#include <cmath>
#include <numbers>

#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
#include "editor/context/preferences.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/shown/frame_all.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/icons.h"
#include "editor/ui/ui.h"
#include "editor/viewport/walk_navigation.h"

namespace limber::editor {

namespace {

constexpr double kWheelStep = 1.2;                         // factor by which one wheel step zooms, as in Blender
constexpr double kZoomPerPixel = 0.006;                    // a drag by n pixels zooms by the factor e^(n times this)
constexpr double kKeyOrbit = 15 * std::numbers::pi / 180;  // angle by which a key turns the view, radians
constexpr double kOrbitPixels = 180 / std::numbers::pi / 0.4;  // pixels of a drag that turn the view by 1 radian

glm::ivec2 view_size(const Screen& screen) {
  const Rect* place = screen.layout.place_of(ViewId::Body);
  return place ? glm::ivec2(place->size()) : glm::ivec2(1);
}

PointerWrap wrap_in_view(const Context& context) {
  const Rect* place = context.screen->layout.place_of(ViewId::Body);
  return place ? PointerWrap(*place, context.ui->look.px(2)) : PointerWrap();
}

// Begins a drag that changes the 3D view's camera. Escape restores the camera.
void start_drag(Context& context, MouseButton button, std::function<void(Context&, const glm::vec2&)> moved) {
  BodyView& body = context.views->body;
  body.move.reset();
  const auto back = [camera = body.camera, name = body.name](Context& c) {
    c.views->body.camera = camera;
    c.views->body.name = name;
  };
  context.interaction->drag = Drag{button, std::move(moved), {}, back, wrap_in_view(context)};
}

// Returns the mouse button that began the drag: the middle button, or the left button together with Alt.
MouseButton pressed_button(const Ui& ui) {
  return ui.input.down(MouseButton::Middle) ? MouseButton::Middle : MouseButton::Left;
}

void orbit(Context& context) {
  start_drag(context, pressed_button(context.ui), [](Context& c, const glm::vec2& by) {
    c.views->body.camera =
        render::orbited(c.views->body.camera, glm::dvec2(by) / static_cast<double>(c.ui->look.scale));
    c.views->body.name.clear();
  });
}

void pan(Context& context) {
  start_drag(context, pressed_button(context.ui), [](Context& c, const glm::vec2& by) {
    c.views->body.camera = render::panned(c.views->body.camera, glm::dvec2(by), view_size(c.screen));
  });
}

void zoom(Context& context) {
  start_drag(context, pressed_button(context.ui), [](Context& c, const glm::vec2& by) {
    c.views->body.camera = render::zoomed(c.views->body.camera, std::exp(kZoomPerPixel * by.y / c.ui->look.scale));
  });
}

// Zooms the 3D view so that the point under the pointer stays under the pointer.
void zoom_about_pointer(Context& context, double factor) {
  BodyView& body = context.views->body;
  body.move.reset();
  const Rect* place = context.screen->layout.place_of(ViewId::Body);
  const glm::vec2 pointer = context.ui->input.pointer;
  body.camera = place && place->contains(pointer)
                    ? render::zoomed(body.camera, factor, pointer - place->low, glm::ivec2(place->size()))
                    : render::zoomed(body.camera, factor);
}

// Shifts the view under the pointer by steps of the wheel or of a touch pad.
void pan_step(Context& context, const glm::vec2& steps) {
  constexpr float kStep = 40;
  const glm::vec2 pixels = steps * context.ui->look.px(kStep);
  const ViewPlace* place = hovered_view(context);
  if (place && place->id != ViewId::Body) {
    shift(slice_of(*context.views, place->id), glm::dvec2(pixels));
    return;
  }
  context.views->body.move.reset();
  context.views->body.camera =
      render::panned(context.views->body.camera, glm::dvec2(pixels), view_size(context.screen));
}

void walk(Context& context) {
  context.interaction->modal = begin_walk(context);
  context.interaction->modal_wrap = wrap_in_view(context);
}

void go_to(Context& context, const render::Camera& camera) {
  BodyView& body = context.views->body;
  if (context.preferences->reduce_motion) body.camera = camera;
  else body.move = CameraMove{body.camera, camera, context.ui->now};
}

const render::Camera& goal(const Context& context) {
  const BodyView& body = context.views->body;
  return body.move ? body.move->to : body.camera;
}

Operator standard_view(const char* id, const char* label, render::StandardView side, const char* description) {
  return {id, label, icon::kCamera, "View", description, [label, side](Context& c) {
            go_to(c, render::looking_from(side, goal(c)));
            c.views->body.name = label;
          }};
}

Operator orbit_step(const char* id, const char* label, glm::dvec2 direction) {
  return {id, label, "", "View", "Turn the 3D view by 15 degrees.", [direction](Context& c) {
            // The angle is converted to pixels, because orbited() expects the pixels of a pointer drag.
            go_to(c, render::orbited(goal(c), direction * kKeyOrbit * kOrbitPixels));
            c.views->body.name.clear();
          }};
}

std::optional<Box> box_of_selection(Context& context) {
  std::optional<Box> all;
  const auto add = [&](const glm::dvec3& low, const glm::dvec3& high) {
    all = all ? Box{glm::min(all->low, low), glm::max(all->high, high)} : Box{low, high};
  };
  const Document shown = shown_document(context);
  for (const Label tissue : context.selection->tissues) {
    const Box box = tissue_box(*context.views, shown, tissue);
    add(box.low, box.high);
  }
  if (const auto& armature = context.document().armature)
    for (const int b : context.selection->bones) {
      if (b >= std::ssize(armature->bones)) continue;
      const Bone& bone = armature->bones[b];
      const double thickness = glm::distance(bone.head, bone.tail) * 0.1;
      add(glm::min(bone.head, bone.tail) - thickness, glm::max(bone.head, bone.tail) + thickness);
    }
  return all;
}

std::string needs_aim(const Context& context) {
  if (!context.document().volume) return "Open a volume first";
  const bool aim =
      !context.selection->tissues.empty() || !context.selection->bones.empty() || context.views->hover.inside;
  return aim ? "" : "Select a tissue, or point at one";
}

// Zooms the 3D view to the selection. If nothing is selected, centres the view on the point under the pointer.
void frame_selected(Context& context) {
  const auto chosen = box_of_selection(context);
  if (!chosen) return run(context, "view.centre_on_pick");
  const Box box = *chosen;
  const glm::vec2 size(view_size(context.screen));
  go_to(context, render::framing(goal(context), box.low, box.high, size.x / std::max(1.0f, size.y)));
}

void toggle_projection(Context& context) {
  auto& projection = context.views->body.camera.projection;
  context.views->body.move.reset();
  projection = projection == render::Projection::Perspective ? render::Projection::Orthographic
                                                             : render::Projection::Perspective;
}

void opposite(Context& context) {
  render::Camera camera = goal(context);
  camera.world_from_view = glm::angleAxis(std::numbers::pi, glm::dvec3(0, 0, 1)) * camera.world_from_view;
  go_to(context, camera);
  context.views->body.name.clear();
}

void centre_on_pick(Context& context) {
  const Hover& hover = context.views->hover;
  if (!hover.inside) return;
  render::Camera camera = goal(context);
  camera.centre = hover.point;
  go_to(context, camera);
}

}  // namespace

std::vector<Operator> navigation_operators() {
  using render::StandardView;
  return {
      {"view.orbit", "Turn view", "", "View", "Drag to turn the 3D view about its centre.", orbit},
      {"view.pan", "Pan view", "", "View", "Drag to move the 3D view sideways, up or down.", pan},
      {"view.zoom", "Zoom view", "", "View", "Drag up to zoom in, down to zoom out.", zoom},
      {"view.zoom_step", "Zoom by wheel", "", "View", "Zoom in or out by one step.",
       [](Context& c) {
         c.views->body.move.reset();
         zoom_about_pointer(c, std::pow(kWheelStep, -c.ui->input.wheel));
       }},
      {"view.zoom_in", "Zoom in", "", "View", "Move the view closer by one step.",
       [](Context& c) { zoom_about_pointer(c, 1 / kWheelStep); }},
      {"view.zoom_out", "Zoom out", "", "View", "Move the view back by one step.",
       [](Context& c) { zoom_about_pointer(c, kWheelStep); }},
      {"view.pan_step", "Pan by wheel", "", "View", "Move the view up or down.",
       [](Context& c) {
         pan_step(c, {0, c.ui->input.wheel});
       }},
      {"view.pan_sideways_step", "Pan sideways by wheel", "", "View", "Move the view to the left or right.",
       [](Context& c) {
         pan_step(c, {c.ui->input.wheel_sideways != 0 ? c.ui->input.wheel_sideways : c.ui->input.wheel, 0});
       }},
      {"view.walk", "Walk", "", "View", "Walk through the 3D view with W A S D; look around with the mouse.", walk,
       needs_volume},
      {"view.centre_on_pick", "Centre on point", icon::kCrossHair, "View",
       "Centre the view on the body's point under the pointer. The view then turns about this point.", centre_on_pick,
       needs_volume},
      standard_view("view.front", "Front", StandardView::Front, "Look at the body from the front."),
      standard_view("view.back", "Back", StandardView::Back, "Look at the body from the back."),
      standard_view("view.left", "Left", StandardView::Left, "Look at the body's left side."),
      standard_view("view.right", "Right", StandardView::Right, "Look at the body's right side."),
      standard_view("view.top", "Top", StandardView::Top, "Look at the body from above."),
      standard_view("view.bottom", "Bottom", StandardView::Bottom, "Look at the body from below."),
      {"view.ortho", "Perspective", icon::kCamera, "View",
       "Switch the 3D view between perspective and parallel projection.", toggle_projection, nullptr,
       [](const Context& c) { return c.views->body.camera.projection == render::Projection::Perspective; }},
      orbit_step("view.orbit_down", "Turn down", {0, -1}),
      orbit_step("view.orbit_up", "Turn up", {0, 1}),
      orbit_step("view.orbit_left", "Turn left", {1, 0}),
      orbit_step("view.orbit_right", "Turn right", {-1, 0}),
      {"view.opposite", "Opposite side", icon::kCamera, "View", "Look at the body from the opposite side.", opposite},
      {"view.frame_selected", "Frame selected", icon::kExpand, "View",
       "Zoom the view to the selection, or centre it on the point under the pointer.", frame_selected, needs_aim},
      {"view.frame_all", "Frame all", icon::kExpand, "View", "Zoom the views to everything that is visible.",
       [](Context& c) { frame_all(c, true); }},
  };
}

}  // namespace limber::editor
