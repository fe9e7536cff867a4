// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests navigation in the 3D view: orbiting about a point, a trackpad, and walking. Also tests that the position of the
// window is restored at the next start.
#include "editor/context/cursor_wrap.h"
#include "editor/context/interaction.h"
#include "editor/context/preferences_state.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

const render::Camera& camera_of(const SmallEditor& test) { return test.editor->views->body.camera; }

glm::vec2 place_in_view(const SmallEditor& test, const glm::dvec3& point) {
  glm::dvec2 pixel;
  REQUIRE(render::project(camera_of(test), point,
                          glm::ivec2(test.editor->screen->layout.place_of(ViewId::Body)->size()), pixel));
  return glm::vec2(pixel);
}

}  // namespace

TEST_CASE(
    "pointer wrap: the sum of the moves is what the hand did, with leaps and moves from before them in any order") {
  PointerWrap wrap(Rect{{100, 100}, {500, 400}}, 2);
  glm::vec2 seen{300, 250}, sum(0), hand(0), shift(0);
  std::vector<glm::vec2> late;  // moves that the window reported before a jump of the pointer
  for (int i = 0; i < 400; ++i) {
    const glm::vec2 step{17, i % 50 < 25 ? -9 : 11};
    hand += step;
    glm::vec2 to = glm::vec2(300, 250) + hand + shift;
    sum += wrap.moved(seen, to);
    seen = to;
    const glm::vec2 leap = wrap.leap(seen);
    if (leap != glm::vec2(0)) {
      hand += step;
      to = glm::vec2(300, 250) + hand + shift;  // the pointer has not jumped yet
      sum += wrap.moved(seen, to);
      seen = to;
      shift += leap;
    }
  }
  CHECK(glm::distance(sum, hand) < 1e-2f);
  CHECK(glm::length(shift) > 1000);
}

TEST_CASE("replay: a drag longer than the view turns as far as the hand goes") {
  glm::dquat often;
  {
    SmallEditor test({1024, 640});
    for (int i = 0; i < 7; ++i) test.play("drag \"3D view/view\" 300 0 MMB");
    often = camera_of(test).world_from_view;
  }
  SmallEditor test({1024, 640});
  test.play("drag \"3D view/view\" 2100 0 MMB");
  CHECK(std::abs(glm::dot(camera_of(test).world_from_view, often)) == doctest::Approx(1).epsilon(1e-9));
  CHECK(test.host->shifted().x < -1000);
}

TEST_CASE("replay: Escape brings back the view as it was before a drag") {
  SmallEditor test;
  const render::Camera before = camera_of(test);
  test.host->events.push(PointerMoved{test.editor->ui->widgets.find("3D view/view")->rect.centre()});
  test.host->events.push(ButtonChanged{MouseButton::Middle, true});
  test.player.settle();
  test.play("move 500 200\n expect \"text:Cancel the drag\"");
  CHECK_FALSE(camera_of(test) == before);
  test.play("key Escape");
  CHECK(camera_of(test) == before);
}

TEST_CASE("replay: the wheel zooms about the pointer, and with Shift, Ctrl or two fingers it shifts the view") {
  SmallEditor test;
  const glm::dvec3 point = camera_of(test).centre + camera_of(test).world_from_view * glm::dvec3(20, 10, 0);
  const glm::vec2 pixel = place_in_view(test, point), corner = test.editor->screen->layout.place_of(ViewId::Body)->low;
  test.host->events.push(PointerMoved{corner + pixel});
  for (int i = 0; i < 5; ++i) {
    test.host->events.push(Wheeled{1});
    test.player.settle();
  }
  CHECK(glm::distance(place_in_view(test, point), pixel) < 0.01f);

  const glm::vec2 before = place_in_view(test, point);
  test.play("wheel \"3D view/view\" 1 Shift");
  CHECK(place_in_view(test, point).y == doctest::Approx(before.y + 40));
  test.play("wheel \"3D view/view\" 1 Ctrl");
  CHECK(place_in_view(test, point).x == doctest::Approx(before.x + 40));
  test.host->events.push(Wheeled{0, -1});
  test.player.settle();
  CHECK(glm::distance(place_in_view(test, point), before + glm::vec2(0, 40)) < 0.01f);
  const double distance = camera_of(test).distance;
  test.play("key Num+");
  CHECK(camera_of(test).distance == doctest::Approx(distance / 1.2));
  test.play("key Num-");
  CHECK(camera_of(test).distance == doctest::Approx(distance));
}

TEST_CASE("replay: a pad steps slices as often as its parts add up") {
  SmallEditor test({1280, 720});
  test.play("click view.four\n move Axial/view");
  const double z = test.editor->views->cross_hair.z;
  for (int i = 0; i < 10; ++i) {
    test.host->events.push(Wheeled{0.3125f});
    test.player.settle();
  }
  CHECK(std::abs(test.editor->views->cross_hair.z - z) == doctest::Approx(9).epsilon(0.17));  // three slices of 3 mm
}

TEST_CASE("replay: the view turns about the point under the pointer once it is picked") {
  SmallEditor test;
  test.play("wait-idle\n move 400 330");
  REQUIRE(test.editor->views->hover.inside);
  const glm::dvec3 point = test.editor->views->hover.point;
  test.play("key Num.\n wait 0.3");
  CHECK(glm::distance(camera_of(test).centre, point) < 1e-9);
  const glm::vec2 pixel = place_in_view(test, point);
  test.play("drag \"3D view/view\" 90 30 MMB");
  CHECK(glm::distance(place_in_view(test, point), pixel) < 0.01f);
  test.play("key Home\n wait 0.3\n wait-idle\n move 400 330\n key-down Alt");
  test.host->events.push(ButtonChanged{MouseButton::Middle, true});
  test.host->events.push(ButtonChanged{MouseButton::Middle, false});
  test.player.settle();
  test.play("key-up Alt\n wait 0.3");
  CHECK(glm::distance(camera_of(test).centre, glm::dvec3(0)) > 1);
}

TEST_CASE("replay: what is chosen fills the view: several tissues, or a bone") {
  LimbEditor test;
  test.play("click Blood/65/name\n key Num.\n wait 0.3");
  const double blood = camera_of(test).distance;
  test.play("click Skin/143/name Ctrl\n key Num.\n wait 0.3");
  CHECK(camera_of(test).distance > blood * 1.5);
  *test.editor->selection = {};
  test.editor->selection->bones = {1};
  test.play("key Num.\n wait 0.3");
  CHECK(glm::distance(camera_of(test).centre, glm::dvec3(0, 0, -18)) < 1e-9);
}

TEST_CASE("replay: walking goes by keys, looks by the mouse, changes speed by the wheel, and Escape returns") {
  SmallEditor test;
  test.play("move \"3D view/view\"");
  const render::Camera before = camera_of(test);
  const glm::dvec3 eye = render::eye_of(before);
  test.play(R"(
    key Shift+`
    expect "text:Walking"
    expect "text:Up, down"
    key-down W
    wait 0.5
    key-up W
  )");
  const glm::dvec3 forward = before.world_from_view * glm::dvec3(0, 0, -1);
  const double way = glm::dot(render::eye_of(camera_of(test)) - eye, forward);
  CHECK(way > 0);
  CHECK(glm::distance(render::eye_of(camera_of(test)), eye + forward * way) < 1e-6);
  CHECK(camera_of(test).world_from_view == before.world_from_view);

  const glm::dvec3 there = render::eye_of(camera_of(test));
  test.play("move 700 250");
  CHECK(glm::distance(render::eye_of(camera_of(test)), there) < 1e-6);  // looking around does not move the eye
  CHECK_FALSE(camera_of(test).world_from_view == before.world_from_view);
  test.play("key-down E\n wait 0.2\n key-up E");
  CHECK(render::eye_of(camera_of(test)).z > there.z);

  // Each step of the wheel makes walking 1.25 times as fast. Four steps are made here.
  const auto go = [&] {
    const glm::dvec3 from = render::eye_of(camera_of(test));
    test.play("key-down S\n wait 0.2\n key-up S");
    return glm::distance(from, render::eye_of(camera_of(test)));
  };
  const double slow = go();
  for (int i = 0; i < 4; ++i) test.host->events.push(Wheeled{1});
  test.player.settle();
  CHECK(go() == doctest::Approx(slow * std::pow(1.25, 4)).epsilon(0.2));
  test.play("key Escape\n expect \"text:Walking\" absent");
  CHECK(camera_of(test) == before);

  test.play("key Shift+`\n key-down W\n wait 0.2\n key-up W\n key Return\n expect \"text:Walking\" absent");
  CHECK_FALSE(camera_of(test) == before);
  const render::Camera stayed = camera_of(test);
  test.play(
      "click View/Navigate/Walk\n key-down D\n wait 0.1\n key-up D\n click \"3D view/view\"\n expect \"text:Walking\" "
      "absent");
  CHECK_FALSE(camera_of(test) == stayed);
  CHECK_FALSE(test.editor->interaction->modal);
}

TEST_CASE("replay: hints follow the modifiers that are held") {
  SmallEditor test({1600, 900});
  test.play(R"(
    move "3D view/view"
    expect text:Turn
    key-down Shift
    expect "text:Pan view"
    expect "text:Frame all" absent
    key-up Shift
    key-down Alt
    expect "text:Turn view"
    key-up Alt
    expect text:Turn
  )");
}

TEST_CASE("replay: the weights under the pointer are read out, in the body and in slices") {
  LimbEditor test;
  test.play(R"(
    move "3D view/view"
    expect "text:No weights here" absent
    click Steps/Skin/Compute
    wait-job
    wait-idle
    move "3D view/view"
  )");
  const auto& hover = test.editor->views->hover;
  REQUIRE(hover.inside);
  double sum = 0;
  for (const BoneWeight& weight : hover.weights) sum += weight.value;
  CHECK(sum == doctest::Approx(1));
  const std::string largest = hover.weights[0].bone;
  CHECK((largest == "Upper" || largest == "Fore"));
  test.play("expect text:" + largest);
  test.play("key Ctrl+Alt+Q\n move Coronal/view");
  CHECK_FALSE(hover.weights.empty());
  test.play("move Coronal/view\n move 60 400");
  CHECK(hover.weights.empty());
  test.play("expect \"text:No weights here\"");
}

TEST_CASE("preferences: the window is found as it was left: splitters, layouts, what is maximized") {
  const TemporaryFolder folder;
  const Path file = folder / "preferences.json";
  Arrangements left;
  {
    SmallEditor test({1280, 720});
    test.editor->preferences_state->path = file;
    test.play(R"(
      drag "splitter sidebar/grip" -60 0
      click view.four
      drag "splitter four-y/grip" 0 50
      drag "splitter four-x/grip" 70 0
      key T
      key Ctrl+2
      move Axial/view
      key Ctrl+Space
      expect maximized Axial
    )");
    left = test.editor->screen->arrangements;
  }
  std::string problem;
  const Preferences kept = read_preferences(file, problem);
  CHECK(problem.empty());
  CHECK(kept.arrangements == left);
  SmallEditor next({1280, 720}, kept);
  CHECK(next.editor->screen->arrangements == left);
  next.play("expect layout four\n expect strip no\n key Ctrl+2\n expect maximized Axial");
}
