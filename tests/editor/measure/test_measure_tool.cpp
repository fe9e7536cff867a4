// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/measure/measure_tool.h"
#include "editor/ui/ui.h"

#include <cmath>
#include <numbers>

#include "core/project/project_io.h"
#include "editor/context/view_projection.h"
#include "editor/measure/measure_view.h"
#include "editor/measure/ruler_overlay.h"
#include "editor/shown/shown_pose.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

namespace {

using namespace limber::editor;

const Measurements& measured(const Document& document) {
  static const Measurements none;
  return document.measurements ? *document.measurements : none;
}
bool has_kind(Stage& s, MeasureKind kind) {
  const Measurements& all = measured(s.document());
  return !all.empty() && all.back().kind == kind && s.editor().measures->chosen == all.back().name;
}

// Clicks at a world point in one of the views.
void click_at(SmallEditor& test, ViewId id, const glm::dvec3& point) {
  const ViewProjection view(*test.editor, {id, *test.editor->screen->layout.place_of(id)});
  const glm::dvec2 at = view.pixel_of(point).value() / double(test.editor->ui->look.scale);
  char line[80];
  std::snprintf(line, sizeof line, "move %.4f %.4f", at.x, at.y);
  test.play(line);
  for (const bool down : {true, false}) {
    test.host->events.push(ButtonChanged{MouseButton::Left, down});
    test.player.settle();
  }
}

// Shows the ball of small_body() in four views: radius 40 mm, with bone of radius 12 mm inside. No slice lies on a
// border between voxels.
struct FourViews : SmallEditor {
  FourViews() : SmallEditor({1280, 900}) { play("key Ctrl+Alt+Q\n wait-idle\n key Num1\n wait 0.4\n wait-idle"); }
  double last_value() const {
    const Measurement& one = measured(editor->document()).back();
    return measure(one.kind, one.points);
  }
  double pixel(ViewId id) const {
    return ViewProjection(*editor, {id, *editor->screen->layout.place_of(id)}).millimetres_per_pixel(glm::dvec3(0));
  }
};

}  // namespace

TEST_CASE("measure: the strip shows the measure tool as the active one, and the tool before it again") {
  FourViews test;
  const auto colour_of = [&](const char* button) {
    const Rect& place = test.editor->ui->widgets.find(button)->rect;
    const glm::ivec2 at(std::round(place.low.x + 4), std::round(place.centre().y));
    const render::Image picture = test.host->picture();
    const std::size_t first = (static_cast<std::size_t>(at.y) * picture.size.x + at.x) * 4;
    return std::vector<std::uint8_t>(picture.rgba.begin() + first, picture.rgba.begin() + first + 3);
  };
  test.play("move Axial/view\n wait-idle");
  const auto active = colour_of("tool.select"), idle = colour_of("measure.menu");
  REQUIRE(active != idle);
  test.play("click View/Overlays/Measure/\"Measure distance\"\n move Axial/view\n wait-idle");
  CHECK(colour_of("measure.menu") == active);
  CHECK(colour_of("tool.select") == idle);
  test.play("key Escape\n wait-idle");
  CHECK(colour_of("measure.menu") == idle);
  CHECK(colour_of("tool.select") == active);
}

std::vector<Proof> proofs_of_measuring() {
  const char* four = "key Ctrl+1\n key Ctrl+Alt+Q\n wait-idle";
  const auto has = [](MeasureKind kind) { return [kind](Stage& s, const Seen&) { return has_kind(s, kind); }; };
  return {
      {"measure.menu", "click \"strip/measure.menu\"\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Measure"; }, Shows::Nothing, four},
      {"measure.distance",
       "click View/Overlays/Measure/\"Measure distance\"\n click Axial/view\n click \"3D view/view\"\n key Return\n "
       "wait-idle",
       has(MeasureKind::Distance), Shows::Nothing, four},
      {"measure.angle",
       "click View/Overlays/Measure/\"Measure angle\"\n click Axial/view\n click \"3D view/view\"\n click "
       "Coronal/view\n key "
       "Escape\n wait-idle",
       has(MeasureKind::Angle), Shows::Nothing, four},
      {"measure.girth",
       "click View/Overlays/Measure/\"Measure girth\"\n click \"3D view/view\"\n key Escape\n wait-idle",
       has(MeasureKind::Girth), Shows::Nothing, four},
      {"measure.thickness",
       "click View/Overlays/Measure/\"Measure thickness\"\n click \"3D view/view\"\n key Escape\n wait-idle",
       has(MeasureKind::Thickness), Shows::Nothing, four},
      {"measure.show", "click View/Overlays/Measure/\"Show measurements\"\n wait-idle",
       [](Stage& s, const Seen&) { return !s.editor().measures->shown; }},
      {"measure.rename",
       "click View/Overlays/Measure/\"Rename measurement...\"\n wait-idle\n key Ctrl+A\n type Waist\n key Return\n "
       "wait-idle",
       [](Stage& s, const Seen&) {
         return s.editor().measures->chosen == "Waist" && measured(s.document()).back().name == "Waist";
       }},
      {"measure.copy", "click View/Overlays/Measure/\"Copy measurements\"\n wait-idle",
       [](Stage& s, const Seen&) {
         const std::string text = s.sitting.test.host->clipboard();
         return text.starts_with("name\tkind\tat rest") && text.find("\nWaist\tthickness\t") != std::string::npos;
       }},
      {"measure.delete", "click View/Overlays/Measure/\"Delete measurement\"\n wait-idle",
       [](Stage& s, const Seen& before) {
         return measured(s.document()).size() + 1 == measured(before.document).size();
       }},
      {"measure.clear", "click View/Overlays/Measure/\"Delete all measurements\"\n wait-idle",
       [](Stage& s, const Seen&) { return !s.document().measurements; }},
      {"view.rulers", "click View/Overlays/Rulers\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().views->rulers; }},
  };
}

TEST_CASE("operators: measuring, and the list of measurements") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_measuring());
}

TEST_CASE("measure tool: what is clicked in slices and in 3D is measured, to a pixel") {
  FourViews test;
  test.play("click View/Overlays/Measure/\"Measure distance\"\n wait-idle");
  click_at(test, ViewId::Axial, {-20, 10, 0});
  click_at(test, ViewId::Axial, {25, -15, 0});
  const double pixel = test.pixel(ViewId::Axial);
  CHECK(std::abs(test.last_value() - std::hypot(45.0, 25.0)) < 2 * pixel);
  // Measures from one view to another. The slices meet at the cross-hair.
  const glm::dvec3 meet = test.editor->views->cross_hair;
  click_at(test, ViewId::Axial, {-20, 10, meet.z});
  click_at(test, ViewId::Coronal, {10, meet.y, 22});
  CHECK(std::abs(test.last_value() - glm::distance(glm::dvec3(-20, 10, meet.z), glm::dvec3(10, meet.y, 22))) <
        2 * pixel);
  // In the 3D view, a click hits the surface: here the front of the ball.
  click_at(test, ViewId::Body, {0, 0, 0});
  click_at(test, ViewId::Axial, {0, 0, meet.z});
  CHECK(std::abs(test.last_value() - 40) < 5);  // mm; voxels are 4 x 5 x 3 mm
  test.play("key Escape\n click View/Overlays/Measure/\"Measure angle\"\n wait-idle");
  click_at(test, ViewId::Axial, {30, 0, meet.z});
  click_at(test, ViewId::Axial, {0, 0, meet.z});
  click_at(test, ViewId::Axial, {20, 20, meet.z});
  CHECK(std::abs(test.last_value() - 45) < 3);
  CHECK(measured(test.editor->document()).size() == 4);
  test.play("key Escape\n expect error none");
}

TEST_CASE("measure tool: a slice's girth is that of the ball's cut, and a skin's thickness that of the shell") {
  FourViews test;
  test.play("click View/Overlays/Measure/\"Measure girth\"\n wait-idle");
  click_at(test, ViewId::Axial, {0, 15, 0});
  CHECK(test.last_value() == doctest::Approx(2 * std::numbers::pi * 40).epsilon(0.03));
  for (const glm::dvec3& corner : measured(test.editor->document()).back().points)
    CHECK(std::abs(corner.z - test.editor->views->cross_hair.z) < 1e-6);
  test.play("key Escape\n click View/Overlays/Measure/\"Measure thickness\"\n wait-idle");
  click_at(test, ViewId::Axial, {0, 0, 0});  // on the bone, a ball of radius 12 mm
  CHECK(test.last_value() == doctest::Approx(24).epsilon(0.25));
  // A click in air gives one message and adds nothing.
  const std::size_t before = measured(test.editor->document()).size();
  click_at(test, ViewId::Axial, {44, -46, 0});
  CHECK(measured(test.editor->document()).size() == before);
  CHECK(test.editor->messages->toasts.back().line == "The pointer is not on the body");
  test.play("expect error none");
}

TEST_CASE("measure tool: Backspace takes a point back, Escape ends, and undo takes a measurement back") {
  FourViews test;
  test.play("click View/Overlays/Measure/\"Measure distance\"\n wait-idle");
  click_at(test, ViewId::Axial, {-20, 10, 0});
  test.play("key Backspace\n wait-idle");
  click_at(test, ViewId::Axial, {0, 0, 0});
  click_at(test, ViewId::Axial, {30, 0, 0});
  CHECK(std::abs(test.last_value() - 30) < 2 * test.pixel(ViewId::Axial));
  click_at(test, ViewId::Axial, {10, 0, 0});
  test.play("key Escape\n wait-idle\n key Ctrl+Z\n wait-idle");
  CHECK(measured(test.editor->document()).empty());
  test.play("key Ctrl+Shift+Z\n wait-idle");
  CHECK(measured(test.editor->document()).size() == 1);
}

TEST_CASE("measurements stay on the tissue when the body is posed, and are kept with the project") {
  LimbEditor test;
  Document document = test.editor->document();
  document.weights = half_weights(*document.volume);
  document.measurements = std::make_shared<const Measurements>(
      Measurements{{"Across the joint", MeasureKind::Distance, {{0, 6, 26}, {4, 8, -26}}},
                   {"In the fore", MeasureKind::Angle, {{0, 0, -10}, {0, 0, -20}, {8, 0, -20}}}});
  test.editor->history->reset(document, "Open limb");
  test.play("key Ctrl+3\n wait-idle");
  Pose pose = pose_of(test.editor->document());
  pose.rotation[1] = glm::angleAxis(glm::radians(70.0), glm::dvec3(1, 0, 0));
  const auto moved = posed_from_rest(*document.armature, pose);
  document.pose = std::make_shared<const Pose>(pose);
  test.editor->history->commit("Bend", document);
  test.play("wait-idle");
  REQUIRE(test.editor->views->scene.pose);
  const auto placed = placed_measurements(*test.editor, test.editor->views->scene);
  REQUIRE(placed.size() == 2);
  const Measurement& across = (*document.measurements)[0];
  CHECK(glm::distance(placed[0][0], across.points[0]) < 1e-9);
  CHECK(glm::distance(placed[0][1], moved[1] * across.points[1]) < 1e-9);
  CHECK(std::abs(measure(across.kind, placed[0]) - measure(across.kind, across.points)) > 5);
  CHECK(measure(MeasureKind::Angle, placed[1]) == doctest::Approx(90).epsilon(1e-9));

  const TemporaryFolder folder;
  DocumentWriter writer;
  create_project({.document = test.editor->document()}, folder / "limb.limber", writer);
  CHECK(*read_project(folder / "limb.limber").document.measurements == *document.measurements);
}

TEST_CASE("measure tool: between two clicks the view can be turned, zoomed and looked at from another side") {
  FourViews test;
  test.play("click View/Overlays/Measure/\"Measure distance\"\n wait-idle");
  click_at(test, ViewId::Body, {0, 0, 0});
  const render::Camera before = test.editor->views->body.camera;
  test.play("drag \"3D view/view\" 120 30 MMB\n wait-idle");
  CHECK(glm::distance(test.editor->views->body.camera.world_from_view * glm::dvec3(1, 0, 0),
                      before.world_from_view * glm::dvec3(1, 0, 0)) > 0.1);
  CHECK_FALSE(test.editor->interaction->drag);
  const double distance = test.editor->views->body.camera.distance;
  test.play("wheel \"3D view/view\" 2\n wait-idle");
  CHECK(test.editor->views->body.camera.distance < distance);
  test.play("move \"3D view/view\"\n key Ctrl+Num1\n wait 0.4\n wait-idle");
  CHECK(test.editor->interaction->modal);
  click_at(test, ViewId::Body, {0, 0, 0});
  CHECK(std::abs(test.last_value() - 80) < 8);  // mm from the front of the ball to its back
  test.play("key Escape\n wait-idle");
  CHECK_FALSE(test.editor->interaction->modal);
}

TEST_CASE("measure tool: in a posed body the points are those of the body at rest under the pointer") {
  LimbEditor test;
  Document document = test.editor->document();
  document.weights = half_weights(*document.volume);
  Pose pose = rest_pose(*document.armature);
  pose.rotation[1] = glm::angleAxis(glm::radians(50.0), glm::dvec3(1, 0, 0));
  document.pose = std::make_shared<const Pose>(pose);
  test.editor->history->reset(document, "Open limb");
  test.play("key Ctrl+3\n key Ctrl+Alt+Q\n wait-idle");
  REQUIRE(test.editor->views->scene.pose);
  const glm::dvec3 rest(0, 0, -25), shown = posed_from_rest(*document.armature, pose)[1] * rest;
  test.editor->views->cross_hair = shown;
  test.play("wait-idle\n click View/Overlays/Measure/\"Measure distance\"\n wait-idle");
  click_at(test, ViewId::Sagittal, shown);
  click_at(test, ViewId::Sagittal, {0, 0, 20});
  const Measurements& all = measured(test.editor->document());
  REQUIRE(all.size() == 1);
  CHECK(glm::distance(all[0].points[0], rest) < 3);  // mm; the map is exact to about a voxel of 4 x 5 x 3 mm
  CHECK(glm::distance(all[0].points[1], {0, 0, 20}) < 3);
  test.play("key Escape");
}

TEST_CASE("measure tool: a dialog that opens gets the keyboard, and undo works between two measurements") {
  FourViews test;
  test.play("click View/Overlays/Measure/\"Measure distance\"\n wait-idle");
  for (const double x : {10.0, 20.0}) {
    click_at(test, ViewId::Axial, {-20, 10, 0});
    click_at(test, ViewId::Axial, {x, 10, 0});
  }
  CHECK(measured(test.editor->document()).size() == 2);
  test.play("key Ctrl+Z\n wait-idle");
  CHECK(test.editor->interaction->modal);
  CHECK(measured(test.editor->document()).size() == 1);
  test.editor->measures->chosen = "Distance 1";
  run(*test.editor, "measure.rename");
  test.play("wait-idle\n expect dialog yes");
  CHECK_FALSE(test.editor->interaction->modal);
  test.play("key Ctrl+A\n type hint\n key Return\n wait-idle\n expect dialog no");
  CHECK(measured(test.editor->document()).back().name == "hint");
  // If the h of "hint" were taken as the command H, it would hide a tissue.
  CHECK_FALSE(test.editor->document().visibility);
}

TEST_CASE("measurements: points in the air stay where they are, and results that do not fit are left at rest") {
  LimbEditor test;
  Document document = test.editor->document();
  document.weights = half_weights(*document.volume);
  Pose pose = rest_pose(*document.armature);
  pose.rotation[1] = glm::angleAxis(glm::radians(50.0), glm::dvec3(1, 0, 0));
  document.pose = std::make_shared<const Pose>(pose);
  const std::vector<glm::dvec3> points{{0, 0, -20}, {900'000, 0, 0}};
  document.measurements = std::make_shared<const Measurements>(Measurements{{"Far", MeasureKind::Distance, points}});
  Result result;
  result.name = "Result";
  result.method = "dqs";
  result.volume = std::make_shared<const LabelVolume>(*document.volume);
  result.from_volume = document.volume;
  result.from_tissues = document.tissues;
  result.from_armature = document.armature;
  result.from_weights = document.weights;
  Pose wrong = pose;
  wrong.rotation.pop_back();
  result.from_pose = std::make_shared<const Pose>(wrong);
  document.results = {std::make_shared<const Result>(result)};
  result.name = "Whole";
  result.volume = std::make_shared<const LabelVolume>(*document.volume);
  result.from_pose = document.pose;
  document.results.push_back(std::make_shared<const Result>(result));
  test.editor->history->reset(document, "Open limb");
  test.play("key Ctrl+3\n wait-idle");
  const auto moved = posed_from_rest(*document.armature, pose);
  const auto posed = placed_measurements(*test.editor, test.editor->views->scene);
  REQUIRE(test.editor->views->scene.pose);
  CHECK(glm::distance(posed[0][0], moved[1] * points[0]) < 1e-9);
  CHECK(posed[0][1] == points[1]);
  render::Scene scene;
  scene.volume = document.results[0]->volume;
  CHECK(placed_measurements(*test.editor, scene)[0] == points);
  scene.volume = document.results[1]->volume;
  CHECK(glm::distance(placed_measurements(*test.editor, scene)[0][0], moved[1] * points[0]) < 1e-6);
}

TEST_CASE("rulers: numbers are round and far enough apart at any zoom") {
  for (double least = 0.003; least < 3000; least *= 1.3) {
    const double step = ruler_step(least);
    CHECK(step >= least * (1 - 1e-9));
    CHECK(step <= 2.5 * least);
    const double leading = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    CHECK(std::min({std::abs(leading - 1), std::abs(leading - 2), std::abs(leading - 5)}) < 1e-9);
  }
}

}  // namespace limber::test
