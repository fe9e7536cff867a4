// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators of workspaces, layouts, displays, overlays, cameras and slices.
#include "editor/context/outliner_state.h"
#include "editor/context/screen.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

const Views& views(Stage& s) { return *s.editor().views; }
const render::Camera& camera(Stage& s) { return views(s).body.camera; }

std::function<bool(Stage&, const Seen&)> becomes(const char* fact, const char* value = "shown") {
  return [=](Stage& s, const Seen&) { return s.is(fact, value); };
}
std::function<bool(Stage&, const Seen&)> goes(bool Views::*shown) {
  return [=](Stage& s, const Seen&) { return !(views(s).*shown); };
}
// Returns a check that the camera looks from this side of the body and has stopped moving.
std::function<bool(Stage&, const Seen&)> looks_from(const char* name, const glm::dvec3& side) {
  return [=](Stage& s, const Seen&) {
    const glm::dvec3 from = glm::normalize(render::eye_of(camera(s)) - camera(s).centre);
    return s.is("view", name) && glm::distance(from, side) < 1e-6 && !views(s).body.move;
  };
}
// Returns the angle in degrees by which the eye has turned about the centre.
double turned(Stage& s, const Seen& before) {
  const auto side = [](const render::Camera& c) { return glm::normalize(render::eye_of(c) - c.centre); };
  return glm::degrees(std::acos(glm::clamp(glm::dot(side(camera(s)), side(before.camera)), -1.0, 1.0)));
}
// Returns how far the cross-hair has moved along z, mm.
double stepped(Stage& s, const Seen& before) { return views(s).cross_hair.z - before.cross_hair.z; }

}  // namespace

std::vector<Proof> proofs_of_views() {
  return {
      {"workspace.skin", "key Ctrl+2", becomes("workspace", "skin")},
      {"workspace.pose", "click top/Pose", becomes("workspace", "pose")},
      {"workspace.next", "key Ctrl+PageDown", becomes("workspace", "resample")},
      {"workspace.previous", "key Ctrl+PageUp", becomes("workspace", "pose")},
      {"workspace.resample", "key Ctrl+4", becomes("workspace", "resample")},
      {"workspace.pie", "key Ctrl+Tab", becomes("widget:Workspaces/Rig"), Shows::Nothing, "move \"3D view/view\""},
      {"workspace.rig", "move \"3D view/view\"\n key Ctrl+Tab\n click Workspaces/Rig", becomes("workspace", "rig")},

      {"view.split", "click \"View/3D and slices\"",
       [](Stage& s, const Seen&) {
         return s.is("layout", "split") && s.editor().screen->layout.view_places.size() == 3;
       }},
      {"view.four", "key Ctrl+Alt+Q",
       [](Stage& s, const Seen&) {
         return s.is("layout", "four") && s.editor().screen->layout.view_places.size() == 4;
       }},
      {"view.maximize", "key Ctrl+Space",
       [](Stage& s, const Seen&) {
         return s.is("maximized", "Coronal") && s.editor().screen->layout.view_places.size() == 1;
       },
       Shows::Nothing, "move Coronal/view"},
      {"view.one", "click view.one",
       [](Stage& s, const Seen&) {
         return s.is("layout", "one") && s.editor().screen->layout.place_of(ViewId::Body) && s.is("maximized", "no");
       }},

      {"view.xray_display", "click view.xray_display", becomes("display", "xray"), Shows::InBody},
      {"view.tissue", "click View/Display/Tissue", becomes("display", "tissue"), Shows::InBody},
      {"view.solid", "move \"3D view/view\"\n key Z\n click Display/Solid", becomes("display", "solid"), Shows::InBody,
       "click view.xray_display"},
      {"view.xray", "key Alt+Z", becomes("display", "xray"), Shows::InBody},

      {"view.grid", "click View/Overlays/Grid", goes(&Views::grid), Shows::InBody},
      {"view.bones", "click View/Overlays/Bones", [](Stage& s, const Seen&) { return !views(s).bones; }, Shows::InBody},
      {"view.axes", "click \"View/Overlays/Axes\"",
       [](Stage& s, const Seen&) { return s.is("widget:axis S", "absent"); }},
      {"view.scale_bar", "click \"View/Overlays/Scale bar\"", goes(&Views::scale_bar)},
      {"view.letters", "click \"View/Overlays/Orientation letters\"", goes(&Views::letters)},
      {"view.bones_cylinder", "click View/Bones/Cylinders",
       [](Stage& s, const Seen&) { return views(s).bone_shape == render::BoneShape::Cylinder; }, Shows::InBody, "",
       [](Stage& s) { s.editor().views->bones = true; }},
      {"view.bones_stick", "click View/Bones/Sticks",
       [](Stage& s, const Seen&) { return views(s).bone_shape == render::BoneShape::Stick; }, Shows::InBody},
      {"view.bones_octahedron", "click View/Bones/Octahedra",
       [](Stage& s, const Seen&) { return views(s).bone_shape == render::BoneShape::Octahedron; }, Shows::InBody},
      {"view.bones_in_front", "click \"View/Bones/Bones in front\"",
       [](Stage& s, const Seen&) { return views(s).bones_in_front; }, Shows::InBody, "",
       [](Stage& s) { s.editor().views->display = render::Display::Solid; }},
      {"view.bone_names", "click \"View/Bones/Bone names\"", becomes("widget:bone name Fore")},
      {"view.bone_axes", "click \"View/Bones/Bone axes\"",
       [](Stage& s, const Seen&) { return views(s).bone_axes && s.is("text:X"); }},
      {"view.cross_hair", "click View/Overlays/Cross-hair", goes(&Views::show_cross_hair)},

      {"view.find", "key F3\n type \"search the project\"\n key Return",
       [](Stage& s, const Seen&) { return s.editor().outliner->searching; }},
      {"view.sidebar", "key N",
       [](Stage& s, const Seen&) { return s.is("sidebar", "no") && s.is("text:Steps", "absent"); }},
      {"view.tool_strip", "key T", becomes("strip", "no")},
      {"view.console", "click Help/Console", becomes("console", "yes")},
      {"view.results", "click \"View/Bottom panel/Results\"", becomes("widget:Close results")},
      {"view.context_menu", "right-click \"3D view/view\"", becomes("widget:context/Hide"), Shows::Nothing, "wait-idle",
       [](Stage& s) { s.editor().views->bones = false; }},
      {"view.pie", "move \"3D view/view\"\n key `", becomes("widget:Views/Front")},
      {"view.shading_pie", "move \"3D view/view\"\n key Z", becomes("widget:Display/X-ray")},
      {"view.full_screen", "key F11", [](Stage& s, const Seen&) { return s.sitting.test.host->full_screen(); }},
  };
}

std::vector<Proof> proofs_of_navigation() {
  const char* four = "click view.four\n move Axial/view";
  return {
      {"view.orbit", "drag \"3D view/view\" 60 0 MMB",
       [](Stage& s, const Seen& b) { return turned(s, b) > 15 && camera(s).centre == b.camera.centre; }, Shows::InBody},
      {"view.pan", "drag \"3D view/view\" 60 0 MMB Shift",
       [](Stage& s, const Seen& b) { return camera(s).centre != b.camera.centre && turned(s, b) < 1e-3; },
       Shows::InBody},
      {"view.zoom", "drag \"3D view/view\" 0 60 LMB Ctrl Alt",
       [](Stage& s, const Seen& b) { return camera(s).distance > b.camera.distance * 1.3; }, Shows::InBody},
      {"view.zoom_step", "wheel \"3D view/view\" 2",
       [](Stage& s, const Seen& b) {
         return std::abs(camera(s).distance * 1.44 - b.camera.distance) < 1e-6 * b.camera.distance;
       },
       Shows::InBody},
      {"view.zoom_in", "key Num+", [](Stage& s, const Seen& b) { return camera(s).distance < b.camera.distance * 0.9; },
       Shows::InBody},
      {"view.zoom_out", "key Num-",
       [](Stage& s, const Seen& b) { return camera(s).distance > b.camera.distance * 1.1; }, Shows::InBody},
      {"view.pan_step", "wheel \"3D view/view\" 1 Shift",
       [](Stage& s, const Seen& b) { return camera(s).centre != b.camera.centre && turned(s, b) < 1e-3; },
       Shows::InBody},
      {"view.pan_sideways_step", "wheel \"3D view/view\" 1 Ctrl",
       [](Stage& s, const Seen& b) { return camera(s).centre != b.camera.centre && turned(s, b) < 1e-3; },
       Shows::InBody},
      {"view.walk", "key Shift+`\n key-down W\n wait 0.5\n key-up W",
       [](Stage& s, const Seen& b) {
         return s.is("text:Walking") && glm::distance(render::eye_of(camera(s)), render::eye_of(b.camera)) > 1;
       },
       Shows::InBody, "move \"3D view/view\""},
      {"view.front", "key Num1", looks_from("Front", {0, -1, 0}), Shows::InBody},
      {"view.back", "click \"View/Standard views/Back\"", looks_from("Back", {0, 1, 0}), Shows::InBody},
      {"view.left", "key Num3", looks_from("Left", {1, 0, 0}), Shows::InBody},
      {"view.right", "key Ctrl+Num3", looks_from("Right", {-1, 0, 0}), Shows::InBody},
      {"view.top", "click \"axis S\"", looks_from("Top", {0, 0, 1}), Shows::InBody},
      {"view.bottom", "move \"3D view/view\"\n key `\n click Views/Bottom", looks_from("Bottom", {0, 0, -1}),
       Shows::InBody},
      {"view.ortho", "key Num5", becomes("projection", "parallel"), Shows::InBody, "key Num1"},
      {"view.orbit_down", "key Num2",
       [](Stage& s, const Seen& b) {
         return std::abs(turned(s, b) - 15) < 0.01 && render::eye_of(camera(s)).z < render::eye_of(b.camera).z;
       },
       Shows::InBody},
      {"view.orbit_up", "key Num8",
       [](Stage& s, const Seen& b) {
         return std::abs(turned(s, b) - 15) < 0.01 && render::eye_of(camera(s)).z > render::eye_of(b.camera).z;
       },
       Shows::InBody},
      {"view.orbit_left", "key Num4",
       [](Stage& s, const Seen& b) {
         return std::abs(turned(s, b) - 15) < 0.01 && render::eye_of(camera(s)).x < render::eye_of(b.camera).x;
       },
       Shows::InBody},
      {"view.orbit_right", "key Num6",
       [](Stage& s, const Seen& b) {
         return std::abs(turned(s, b) - 15) < 0.01 && render::eye_of(camera(s)).x > render::eye_of(b.camera).x;
       },
       Shows::InBody},
      {"view.opposite", "key Num9", [](Stage& s, const Seen& b) { return turned(s, b) > 179; }, Shows::InBody},
      {"view.centre_on_pick", "drag \"3D view/view\" 0 0 MMB Alt",
       [](Stage& s, const Seen& b) { return glm::distance(camera(s).centre, b.camera.centre) > 20; }, Shows::Nothing,
       "key Home\n wait-idle\n move \"3D view/view\""},
      {"view.frame_selected", "key Num.",
       [](Stage& s, const Seen& b) { return camera(s).distance < b.camera.distance * 0.6; }, Shows::InBody,
       "click \"sidebar/sections/Outliner/fold\"\n wait-idle\n click \"Cortical bone/111/name\"\n move \"3D "
       "view/view\""},
      {"view.frame_all", "key Home",
       [](Stage& s, const Seen& b) { return camera(s).distance > b.camera.distance * 1.6; }, Shows::InBody,
       "click \"sidebar/sections/Outliner/fold\"\n move \"3D view/view\"\n wait-idle"},

      {"slice.step", "wheel Axial/view 1",
       [](Stage& s, const Seen& b) { return std::abs(stepped(s, b)) > 0.5 && std::abs(stepped(s, b)) < 5; },
       Shows::Nothing, four},
      {"slice.step_five", "wheel Axial/view 1 Shift",
       [](Stage& s, const Seen& b) { return std::abs(stepped(s, b) - 15) < 1e-6; }, Shows::Nothing, four},
      {"slice.next", "key PageUp", [](Stage& s, const Seen& b) { return std::abs(stepped(s, b) - 3) < 1e-6; },
       Shows::Nothing, four},
      {"slice.previous", "key PageDown", [](Stage& s, const Seen& b) { return std::abs(stepped(s, b) + 3) < 1e-6; },
       Shows::Nothing, four},
      {"slice.zoom", "wheel Coronal/view 2 Ctrl",
       [](Stage& s, const Seen& b) {
         return views(s).slices[1].camera.millimetres_per_pixel < b.slices[1].millimetres_per_pixel * 0.7;
       },
       Shows::InSlice, four},
      {"slice.pan", "drag Coronal/view 30 0 MMB",
       [](Stage& s, const Seen& b) { return std::abs(views(s).slices[1].camera.centre.x - b.slices[1].centre.x) > 5; },
       Shows::InSlice, four},
      {"slice.show_outlines", "click View/Slices/Outline", becomes("slices", "outline"), Shows::InSlice, four},
      {"slice.show_labels", "click View/Slices/Labels", becomes("slices", "labels"), Shows::InSlice, four},
      {"slice.outline", "move Axial/view\n key O", becomes("slices", "outline"), Shows::InSlice, four},
      {"view.place_cross_hair", "drag Coronal/view 20 30 RMB Shift",
       [](Stage& s, const Seen& b) {
         return std::abs(views(s).cross_hair.x - b.cross_hair.x) > 2 && std::abs(stepped(s, b)) > 2 &&
                views(s).cross_hair.y == b.cross_hair.y;
       },
       Shows::Nothing, four},
  };
}

TEST_CASE("operators: workspaces, layouts, displays and overlays") {
  Stage stage;
  prove(stage, proofs_of_views());
}

TEST_CASE("operators: the body is turned, slices are stepped") {
  Stage stage;
  prove(stage, proofs_of_navigation());
}

}  // namespace limber::test
