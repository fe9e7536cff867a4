// SPDX-License-Identifier: AGPL-3.0-or-later
// Keys go to the area under the pointer, and the widget under the pointer does not move.
#include <future>

#include "editor/context/background_task.h"
#include "editor/context/interaction.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/motion/timeline.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/ui.h"
#include "tests/editor/keyboard.h"
#include "tests/editor/small_clip.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

glm::vec2 place_of(const Context& editor, const std::string& name) {
  const Widget* widget = editor.ui->widgets.find(name);
  REQUIRE(widget);
  return widget->rect.low;
}

}  // namespace

TEST_CASE("areas: a view's keys act over the view alone, those of the whole window everywhere") {
  LimbEditor test;
  test.play(R"(
    move "3D view/view"
    key Num1
    expect view Front
    move Outliner/volume/name
    key Num3
    expect view Front
    key Ctrl+2
    expect workspace skin
    key Ctrl+3
    move Motion/fold
    key Num3
    expect view Front
    move "3D view/view"
    key Num3
    expect view Left
  )");
}

TEST_CASE("areas: a click in a number field types there, Ctrl+A chooses its text, a drag changes it") {
  LimbEditor test;
  test.play("key Ctrl+3\nclick \"Outliner/bone Fore/name\"\nwait-idle");
  test.editor->ui->open_sections["Bone"] = true;
  const Pose bent = [&] {
    Pose pose = rest_pose(*test.editor->document().armature);
    pose.rotation[1] = glm::angleAxis(glm::radians(40.0), glm::dvec3(1, 0, 0));
    return pose;
  }();
  Document next = test.editor->document();
  next.pose = std::make_shared<const Pose>(bent);
  test.editor->history->commit("Bend", next);
  const auto armature = test.editor->document().armature;
  test.play("key Ctrl+1\nwait-idle\nclick \"Bone/Length\"");
  test.host->events.push(KeyChanged{Key::Ctrl, true});
  press_key(*test.host, Key::A);
  test.host->events.push(KeyChanged{Key::Ctrl, false});
  type_keys(*test.host, "42");
  press_key(*test.host, Key::Return);
  test.player.settle();
  const Bone& fore = test.editor->document().armature->bones[1];
  CHECK(glm::distance(fore.head, fore.tail) == doctest::Approx(42));
  test.play("drag \"Bone/Length\" 20 0");
  const Bone& longer = test.editor->document().armature->bones[1];
  CHECK(glm::distance(longer.head, longer.tail) > 43);
  CHECK_FALSE(test.editor->ui->keyboard.typed);
}

TEST_CASE("areas: one Escape closes a menu, wherever it was opened") {
  LimbEditor test;
  for (const char* open : {"click top/File", "click top/Edit", "right-click \"Outliner/bone Fore/name\""}) {
    INFO(open);
    test.play(open);
    CHECK(std::any_of(test.editor->ui->widgets.widgets().begin(), test.editor->ui->widgets.widgets().end(),
                      [](const Widget& widget) { return widget.region == Region::Popup; }));
    test.play("key Escape");
    CHECK(std::none_of(test.editor->ui->widgets.widgets().begin(), test.editor->ui->widgets.widgets().end(),
                       [](const Widget& widget) { return widget.region == Region::Popup; }));
  }
}

TEST_CASE("areas: what is pointed at in the sidebar stays where it is when something above it grows or goes") {
  LimbEditor test;
  test.play("key Ctrl+1\nwait-idle\nmove Display/fold");
  const glm::vec2 before = place_of(*test.editor, "Display/fold");
  const float above = place_of(*test.editor, "Outliner/fold").y;
  // Selects a bone, so that the panel of the bone's numbers appears above the panel under the pointer.
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  test.player.step();
  CHECK(test.editor->ui->widgets.find("Bone/Length"));
  CHECK(place_of(*test.editor, "Display/fold") == before);
  *test.editor->selection = {};
  test.player.step();
  CHECK(place_of(*test.editor, "Display/fold") == before);
  CHECK(place_of(*test.editor, "Outliner/fold").y == above);
  // The sidebar was scrolled to keep the panel under the pointer in place, so nothing jumps when the pointer leaves.
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  test.player.step();
  test.play("move \"3D view/view\"\nwait-idle");
  CHECK(place_of(*test.editor, "Display/fold") == before);
}

TEST_CASE("areas: each workspace's sidebar is scrolled by itself") {
  LimbEditor test;
  test.play("wait-idle\nmove Outliner/volume/name\nwheel Outliner/volume/name -20\nmove \"3D view/view\"");
  const glm::vec2 scrolled = place_of(*test.editor, "History/fold");
  test.play("key Ctrl+3\nwait-idle");
  CHECK(test.editor->ui->widgets.find("Steps/fold"));
  test.play("key Ctrl+1\nwait-idle");
  CHECK(place_of(*test.editor, "History/fold") == scrolled);
}

TEST_CASE("areas: messages stand over the 3D view and leave the slices free, and those under the pointer stay") {
  LimbEditor test;
  test.play("key Ctrl+Alt+Q\nwait-idle");
  for (int i = 0; i < 5; ++i) test.editor->messages->toast_error("It failed " + std::to_string(i));
  test.player.settle();
  const Rect body = *test.editor->screen->layout.place_of(ViewId::Body);
  int boxes = 0;
  for (const Widget& widget : test.editor->ui->widgets.widgets())
    if (widget.region == Region::Toast) {
      ++boxes;
      CHECK(body.contains(widget.rect));
    }
  CHECK(boxes > 0);
  test.play("move \"toast 0/box\"");
  const glm::vec2 before = place_of(*test.editor, "toast 0/box");
  test.editor->messages->toast_error("One more");
  test.editor->messages->info(
      "And a long one that takes more than a line of the box, and therefore another height than all of the others "
      "have");
  test.play("wait 10");
  CHECK(place_of(*test.editor, "toast 0/box") == before);
  CHECK(test.fact("text:And a long one") == "absent");
  test.play("move \"Axial/view\"");
  CHECK(test.fact("text:And a long one") == "shown");
}

TEST_CASE("areas: messages cover neither the gizmo nor the legend nor the scale bar") {
  const auto covered = [](LimbEditor& test) {
    Editor& editor = *test.editor;
    editor.messages->toasts.clear();
    test.play("wait-idle");
    editor.messages->toast_error("It failed", "and this says why");
    test.player.settle();
    const Rect toast = editor.ui->widgets.find("toast 0/box")->rect;
    CHECK(editor.screen->layout.place_of(ViewId::Body)->contains(toast));
    std::string names;
    for (const Widget& widget : editor.ui->widgets.widgets())
      if ((widget.name == "3D view/legend" || widget.name == "3D view/scale bar") && widget.rect.overlaps(toast))
        names += widget.name + " ";
    for (const ViewPlace& place : editor.screen->layout.view_places)
      if (place.id == ViewId::Body)
        if (const auto gizmo = gizmo_rect(editor, ViewProjection(editor, place)); gizmo && gizmo->overlaps(toast))
          names += "gizmo";
    return names;
  };
  LimbEditor test;
  test.play("key Ctrl+3\nwait-idle");
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  test.editor->interaction->tool = Tool::Rotate;
  test.play("wait-idle");
  const ViewPlace body = test.editor->screen->layout.view_places.front();
  REQUIRE(gizmo_rect(*test.editor, ViewProjection(*test.editor, body)));
  CHECK(covered(test) == "");
  // Moves the gizmo towards the view's lower right corner, where messages usually are.
  for (const float way : {120.0f, 180.0f, 300.0f}) {
    const ViewProjection view(*test.editor, body);
    const glm::dvec3 centre = gizmo_in(*test.editor, view)->centre;
    const auto corner = view.in_plane(glm::dvec2(body.rect.high - way), centre, view.direction_to_eye(centre));
    REQUIRE(corner);
    test.editor->views->body.camera.centre += centre - *corner;
    CHECK(covered(test) == "");
  }
  test.play("key Ctrl+2\nwait-idle\nclick \"Edit/Weights/Heat diffusion\"\nwait-job\nwait-idle");
  CHECK(test.editor->ui->widgets.find("3D view/legend"));
  CHECK(covered(test) == "");
  test.play("key Ctrl+Alt+Q\nwait-idle");
  CHECK(covered(test) == "");
}

TEST_CASE("areas: messages leave limbs free, and are fewer where more would cover one") {
  LimbEditor test({1024, 640});
  Editor& editor = *test.editor;
  test.play("key Ctrl+2\nwait-idle");
  const ViewPlace body = editor.screen->layout.view_places.front();
  REQUIRE(body.id == ViewId::Body);
  // Moves the limb sideways, to this position between the view's left edge, 0, and its right edge, 1. Then counts the
  // toasts of three messages, and those of them that cover a point of a bone.
  const auto toasts = [&](float position) {
    const ViewProjection view(editor, body);
    const glm::vec2 to(glm::mix(body.rect.low.x, body.rect.high.x, position), body.rect.centre().y);
    const auto point = view.in_plane(to, glm::dvec3(0), view.direction_to_eye(glm::dvec3(0)));
    REQUIRE(point);
    editor.views->body.camera.centre -= *point;
    editor.messages->toasts.clear();
    test.play("wait-idle");
    for (int i = 0; i < 3; ++i) editor.messages->toast_error("It failed " + std::to_string(i));
    test.player.settle();
    const ViewProjection moved(editor, body);
    int count = 0, covering = 0;
    for (const Widget& widget : editor.ui->widgets.widgets()) {
      if (widget.region != Region::Toast || !widget.name.ends_with("/box")) continue;
      ++count;
      bool covers = false;
      for (double z = -36; z <= 36; ++z)
        if (const auto pixel = moved.pixel_of(glm::dvec3(0, 0, z))) covers |= widget.rect.contains(glm::vec2(*pixel));
      covering += covers;
    }
    return std::pair(count, covering);
  };
  CHECK(toasts(0.2f) == std::pair(3, 0));
  CHECK(test.fact("text:+2 more") == "absent");
  CHECK(toasts(0.85f).second == 0);
  CHECK(toasts(0.5f).first == 1);  // no place beside the limb is wide enough for three messages
  CHECK(test.fact("text:+2 more") == "shown");
}

TEST_CASE("areas: a row of a menu is pressed at its right end, too") {
  LimbEditor test;
  REQUIRE(test.fact("sidebar") == "yes");
  test.play("click View\nwait-idle");
  const Rect row = test.editor->ui->widgets.find("View/Sidebar")->rect;
  test.host->events.push(PointerMoved{{row.high.x - 3, row.centre().y}});
  test.player.settle();
  for (const bool down : {true, false}) test.host->events.push(ButtonChanged{MouseButton::Left, down});
  test.player.settle();
  CHECK(test.fact("sidebar") == "no");
}

TEST_CASE("areas: a job that begins to run moves no section of the sidebar") {
  LimbEditor test;
  test.play("key Ctrl+4\nwait-idle\nmove \"3D view/view\"");
  const glm::vec2 before = place_of(*test.editor, "Resample/fold");
  std::promise<void> stop;
  test.editor->jobs->start("Long job", [wait = stop.get_future().share()](Progress&) -> Edit {
    wait.wait();
    return [](const Document& now) { return now; };
  });
  test.player.step();
  test.player.step();
  CHECK(test.fact("text:1 job") == "shown");
  CHECK(place_of(*test.editor, "Resample/fold") == before);
  stop.set_value();
  test.play("wait-job");
  CHECK(test.fact("text:Nothing is running") == "shown");
  CHECK(place_of(*test.editor, "Resample/fold") == before);
}

TEST_CASE("areas: the status bar's hints are those of the timeline while the pointer is over it") {
  LimbEditor test;
  test.editor->history->reset(bending_limb(), "Open bending limb");
  test.play("key Ctrl+3\nwait-idle\nmove \"3D view/view\"\nexpect text:Scrub absent");
  const glm::vec2 over = test.editor->screen->timeline_area.centre();
  test.play("move " + std::to_string(over.x) + " " + std::to_string(over.y) + "\nexpect text:Scrub shown");
}

TEST_CASE("areas: after a click or a key no tool tip is shown until the pointer moves") {
  LimbEditor test;
  const auto tip_shown = [&] {
    const auto& tip = test.editor->ui->tip;
    return !tip.widget.empty() && tip.since + test.editor->ui->tooltip_delay <= test.editor->ui->now;
  };
  test.play("key Ctrl+1\nwait-idle\nmove top/Skin\nwait 2");
  CHECK(tip_shown());
  test.play("click top/Skin\nwait-idle\nwait 2");  // the tab changes its width, and the tip its title
  CHECK(test.fact("workspace") == "skin");
  CHECK_FALSE(tip_shown());
  test.play("move top/Pose\nwait 2");
  CHECK(tip_shown());
  test.play("key Ctrl+1\nwait-idle\nwait 2");
  CHECK(test.fact("workspace") == "rig");
  CHECK_FALSE(tip_shown());
  test.play("key Ctrl+3\nwait-idle\nwait 2");
  CHECK_FALSE(tip_shown());
  // Holding a modifier key does not hide a tip, since the tip may describe Ctrl+click.
  test.play("move top/Skin\nwait 2");
  test.host->events.push(KeyChanged{Key::Ctrl, true});
  test.play("wait 2");
  CHECK(tip_shown());
  test.host->events.push(KeyChanged{Key::Ctrl, false});
}

TEST_CASE("areas: below an open dialog the status bar tells how to close it, not what the view's keys do") {
  SmallEditor test;
  test.play("move \"3D view/view\"\nwait-idle\nexpect text:Turn shown");
  ask(*test.editor, {.title = "A question", .answers = {{"Yes", {}, true}}});
  test.play("wait-idle\nexpect dialog yes\nexpect text:Turn absent\nexpect text:Esc shown\nkey Escape\nwait-idle");
  test.play("expect dialog no\nexpect text:Turn shown");
  test.editor->messages->show_error("it failed: here: try again");
  test.play("wait-idle\nexpect text:Turn absent\nexpect text:Esc shown\nkey Escape\nwait-idle\nexpect text:Turn shown");
}

TEST_CASE("areas: context menus say whether a file is imported or exported") {
  LimbEditor test;
  test.play(R"(
    right-click Outliner/volume/name
    expect "text:Export volume..." shown
    expect "text:Export tissues..." shown
    key Escape
    right-click Outliner/armature/name
    expect "text:Import rig..." shown
    expect "text:Export rig..." shown
    key Escape
  )");
}

TEST_CASE("areas: the status bar tells a tissue's label once, and the Prepare step the number of tissues") {
  SmallEditor test({1280, 900});
  Document next = test.editor->document();
  auto tissues = std::make_shared<TissueTable>(*next.tissues);
  for (Tissue& tissue : tissues->tissues)
    if (tissue.label != 65) tissue.name.clear();
  next.tissues = tissues;
  test.editor->history->reset(next, "Open without names");
  test.play("move \"3D view/view\"\nwait-idle\nexpect \"text:4 tissues\" shown");
  const editor::Hover& hover = test.editor->views->hover;
  REQUIRE(hover.inside);
  REQUIRE(hover.label != 65);
  const std::string label = std::to_string(hover.label);
  CHECK(test.fact("text:Label " + label) == "shown");
  CHECK(test.fact("text:label " + label) == "absent");
}

TEST_CASE("areas: a word in a section's head is whole where the title leaves room for it") {
  const std::string name = "Left middle finger's end bone";
  LimbEditor test;
  Document next = test.editor->document();
  Armature armature = *next.armature;
  armature.bones[1].name = name;
  next.armature = std::make_shared<const Armature>(armature);
  test.editor->history->reset(next, "Open");
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  test.play("key Ctrl+1\nwait-idle");
  const Widget* fold = test.editor->ui->widgets.find("Bone/fold");
  REQUIRE(fold);
  // Pointing at a text that is cut off shows all of it.
  test.play("move " + std::to_string(fold->rect.high.x + 20) + " " + std::to_string(fold->rect.centre().y) +
            "\nwait 2");
  CHECK(test.editor->ui->tip.title != name);
}
