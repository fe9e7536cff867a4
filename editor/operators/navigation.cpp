// SPDX-License-Identifier: AGPL-3.0-or-later
// Turning, shifting and zooming the 3D view, with Blender's keys.
#include <cmath>
#include <numbers>

#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/project.h"

namespace limber::editor {

namespace {

constexpr double kWheelStep = 1.2;                            // closer by that factor, as in Blender
constexpr double kZoomPerPixel = 0.006;                       // e-folds
constexpr double kKeyOrbit = 15 * std::numbers::pi / 180;     // radians for one press
constexpr double kOrbitPixels = 180 / std::numbers::pi / 0.4;  // pixels for a radian: 0.4 degrees a pixel

glm::ivec2 view_size(const Editor& editor) {
  const Rect* place = editor.layout.place_of(ViewId::Body);
  return place ? glm::ivec2(place->size()) : glm::ivec2(1);
}

void start_drag(Editor& editor, MouseButton button, std::function<void(Editor&, const glm::vec2&)> moved) {
  editor.views->body.move.reset();
  editor.drag = Drag{button, std::move(moved), {}, {}};
}

// The button that began it: middle, or left together with Alt.
MouseButton pressed_button(const Editor& editor) { return editor.input.down(MouseButton::Middle) ? MouseButton::Middle : MouseButton::Left; }

void orbit(Editor& editor) {
  start_drag(editor, pressed_button(editor), [](Editor& e, const glm::vec2& by) {
    e.views->body.camera = render::orbited(e.views->body.camera, glm::dvec2(by) / static_cast<double>(e.look.scale));
    e.views->body.name.clear();
  });
}

void pan(Editor& editor) {
  start_drag(editor, pressed_button(editor),
             [](Editor& e, const glm::vec2& by) { e.views->body.camera = render::panned(e.views->body.camera, glm::dvec2(by), view_size(e)); });
}

void zoom(Editor& editor) {
  start_drag(editor, pressed_button(editor), [](Editor& e, const glm::vec2& by) {
    e.views->body.camera = render::zoomed(e.views->body.camera, std::exp(kZoomPerPixel * by.y / e.look.scale));
  });
}

void go_to(Editor& editor, const render::Camera& camera) {
  BodyView& body = editor.views->body;
  if (editor.preferences.reduce_motion) body.camera = camera;
  else body.move = CameraMove{body.camera, camera, editor.now};
}

const render::Camera& goal(const Editor& editor) {
  const BodyView& body = editor.views->body;
  return body.move ? body.move->to : body.camera;
}

Operator standard_view(const char* id, const char* label, render::StandardView side, const char* sentence) {
  return {id, label, icon::kCamera, "View", sentence, [label, side](Editor& e) {
            go_to(e, render::looking_from(side, goal(e)));
            e.views->body.name = label;
          }};
}

Operator orbit_step(const char* id, const char* label, glm::dvec2 direction) {
  return {id, label, "", "View", "Turns the view by 15 degrees.", [direction](Editor& e) {
            // orbited() turns by pixels; as many as make the step.
            go_to(e, render::orbited(goal(e), direction * kKeyOrbit * kOrbitPixels));
            e.views->body.name.clear();
          }};
}

void frame_selected(Editor& editor) {
  const Box box = tissue_box(*editor.views, editor.document(), editor.selection.tissue);
  const glm::vec2 size(view_size(editor));
  go_to(editor, render::framing(goal(editor), box.low, box.high, size.x / std::max(1.0f, size.y)));
}

void toggle_projection(Editor& editor) {
  auto& projection = editor.views->body.camera.projection;
  editor.views->body.move.reset();
  projection = projection == render::Projection::Perspective ? render::Projection::Orthographic : render::Projection::Perspective;
}

void opposite(Editor& editor) {
  render::Camera camera = goal(editor);
  camera.world_from_view = glm::angleAxis(std::numbers::pi, glm::dvec3(0, 0, 1)) * camera.world_from_view;
  go_to(editor, camera);
  editor.views->body.name.clear();
}

void centre_on_pick(Editor& editor) {
  const Hover& hover = editor.views->hover;
  if (!hover.inside) return;
  render::Camera camera = goal(editor);
  camera.centre = hover.point;
  go_to(editor, camera);
}

}  // namespace

std::vector<Operator> navigation_operators() {
  using render::StandardView;
  return {
      {"view.orbit", "Turn view", "", "View", "Drag to turn the view about its centre.", orbit},
      {"view.pan", "Shift view", "", "View", "Drag to shift the view.", pan},
      {"view.zoom", "Zoom view", "", "View", "Drag up or down to come closer or go back.", zoom},
      {"view.zoom_step", "Zoom by wheel", "", "View", "Comes closer or goes back by a step.",
       [](Editor& e) {
         e.views->body.move.reset();
         e.views->body.camera = render::zoomed(e.views->body.camera, std::pow(kWheelStep, -e.input.wheel));
       }},
      {"view.centre_on_pick", "Centre on point", icon::kCrossHair, "View", "Turns about the point of the body under the pointer from now on.", centre_on_pick,
       needs_volume},
      standard_view("view.front", "Front", StandardView::Front, "Looks at the body from the front."),
      standard_view("view.back", "Back", StandardView::Back, "Looks at the body from the back."),
      standard_view("view.left", "Left", StandardView::Left, "Looks at the body's left side."),
      standard_view("view.right", "Right", StandardView::Right, "Looks at the body's right side."),
      standard_view("view.top", "Top", StandardView::Top, "Looks at the body from above."),
      standard_view("view.bottom", "Bottom", StandardView::Bottom, "Looks at the body from below."),
      {"view.ortho", "Perspective", icon::kCamera, "View", "Changes between perspective and parallel projection.", toggle_projection, nullptr,
       [](const Editor& e) { return e.views->body.camera.projection == render::Projection::Perspective; }},
      orbit_step("view.orbit_down", "Turn down", {0, -1}),
      orbit_step("view.orbit_up", "Turn up", {0, 1}),
      orbit_step("view.orbit_left", "Turn left", {1, 0}),
      orbit_step("view.orbit_right", "Turn right", {-1, 0}),
      {"view.opposite", "Opposite side", icon::kCamera, "View", "Looks from the other side.", opposite},
      {"view.frame_selected", "Frame selected", icon::kExpand, "View", "Brings the chosen tissue to fill the view.", frame_selected, needs_tissue},
      {"view.frame_all", "Frame all", icon::kExpand, "View", "Brings all that is visible to fill the views.", [](Editor& e) { frame_all(e, true); }},
  };
}

}  // namespace limber::editor
