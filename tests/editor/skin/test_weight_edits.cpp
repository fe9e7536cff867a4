// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/ui.h"

#include "core/rig/mirror.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/skin/brush_cursor.h"
#include "editor/skin/painted_region.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "tests/editor/weighed_limb.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;

namespace {

constexpr Label kMuscle = 17, kBlood = 65, kBone = 111, kSkin = 143;

// The ball whose upper half follows the upper bone and whose lower half the lower one, which is active.
struct EditEditor : LimbEditor {
  EditEditor() : LimbEditor({1000, 600}) {
    Document next = editor->document();
    next.weights = test::half_weights(*next.volume);
    editor->history->reset(next, "Open weighted limb");
    editor->preferences->reduce_motion = true;
    play("key N\nkey Ctrl+2\nmove \"3D view/view\"\nkey Num1\nwait-idle");
    choose(1);
    painting().strength = 1;
    painting().kind = BrushKind::Set;
  }

  Painting& painting() { return *editor->skin->painting; }
  void choose(int bone) {
    *editor->selection = {};
    editor->selection->bone = bone;
    editor->selection->bones = {bone};
    play("wait-idle");
  }
  const SkinWeights& weights() const { return *editor->document().weights; }
  int steps() const { return static_cast<int>(editor->history->position()); }
  std::string last_edit() const { return editor->history->steps()[editor->history->position()].label; }
  std::string last_toast() const {
    return editor->messages->toasts.empty()
               ? ""
               : editor->messages->toasts.back().line + ": " + editor->messages->toasts.back().detail;
  }
  template <class Body>
  void for_each(const Body& body) const {
    const LabelVolume& volume = *editor->document().volume;
    const TissueVoxels tissue(volume);
    const AffineTransform world = world_from_voxel(volume.grid);
    for (std::int64_t brick = 0; brick < weights().chunk_count(); ++brick)
      tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
        body(world * glm::dvec3(voxel), volume.at(voxel), weights().chunk(brick)[place - tissue.bricks()[brick].first]);
      });
  }
  // Counts the voxels whose weight of the lower bone differs from `expected`. At first it is 1 below and 0 above.
  template <class Expected>
  int wrong(const Expected& expected) const {
    int count = 0;
    for_each([&](const glm::dvec3& p, Label label, const Influence& influence) {
      int sum = 0;
      for (const auto weight : influence.weight) sum += weight;
      count += sum != kFullWeight || std::abs(influence.of(1) - expected(p, label)) > 1e-4;
    });
    return count;
  }
};

double before(const glm::dvec3& p) { return p.z < 0 ? 1 : 0; }

}  // namespace

TEST_CASE("weight editing: a flood does what the brush does in all it may reach, as one step, and can be adjusted") {
  EditEditor test;
  const auto first = test.editor->document().weights;
  test.painting().value = 0.25;
  const int steps = test.steps();
  test.play("key Ctrl+X\nwait-idle");
  CHECK(test.steps() == steps + 1);
  CHECK(test.last_edit() == "Flood Fore");
  // Bone tissue keeps its weights.
  CHECK(test.wrong([](const glm::dvec3& p, Label label) { return label == kBone ? before(p) : 0.25; }) == 0);
  // Changing the value and the kind of the last operation replaces its undo step and adds no other.
  std::vector<FormField> fields = test.editor->last_operation->fields;
  REQUIRE(fields.size() == 3);
  fields[0].chosen = 3;
  fields[1].value = 0.5;
  redo_last_operator(*test.editor, fields);
  CHECK(test.steps() == steps + 1);
  CHECK(test.wrong([](const glm::dvec3& p, Label label) { return label == kBone ? before(p) : before(p) / 2; }) == 0);
  test.play("key Ctrl+Z");
  CHECK(test.editor->document().weights == first);
}

TEST_CASE(
    "weight editing: a flood keeps to the brush's tissues, to the clip and under locks, and says what is in its way") {
  EditEditor test;
  test.painting().value = 1;
  const auto first = test.editor->document().weights;
  const int steps = test.steps();

  test.painting().tissue = PaintedTissue::Chosen;
  test.play("key Ctrl+X\nwait-idle");
  CHECK(test.steps() == steps);
  CHECK(test.last_toast() == "Flood: No tissue is selected: select one in the list, or paint all tissue");
  test.play("key Shift+X\nwait-idle");

  test.editor->selection->tissues = {kBlood};
  test.editor->selection->tissue = kBlood;
  test.play("key Ctrl+X\nwait-idle");
  CHECK(test.steps() == steps + 1);
  CHECK(test.wrong([](const glm::dvec3& p, Label label) { return label == kBlood ? 1 : before(p); }) == 0);
  test.play("key Ctrl+Z");

  test.painting().tissue = PaintedTissue::All;
  Visibility cut;
  cut.clip_plane = {true, {0, 0, 15}, {0, 0, 1}};
  Document next = test.editor->document();
  next.visibility = std::make_shared<const Visibility>(cut);
  test.editor->history->commit("Clip", next);
  test.play("key Ctrl+X\nwait-idle");
  CHECK(test.wrong([](const glm::dvec3& p, Label label) { return label != kBone && p.z <= 15 ? 1 : before(p); }) == 0);
  test.play("key Ctrl+Z");

  set_locks(*test.editor, "Lock", {"Upper"});
  const int locked = test.steps();
  test.play("key Ctrl+X\nwait-idle");
  CHECK(test.steps() == locked);
  CHECK(test.editor->document().weights == first);
  CHECK(test.last_toast().find("Upper is locked") == 0);
}

TEST_CASE("weight editing: the part under the pointer, or all of a tissue, follows the chosen bone, bone tissue too") {
  EditEditor test;
  const int steps = test.steps();
  test.play("move \"3D view/view\"\nwait-idle");
  REQUIRE(test.editor->views->hover.label == kSkin);
  test.painting().tissue = PaintedTissue::Chosen;  // Fill connected tissue ignores which tissues brushes may paint
  test.play("key L\nwait-idle");
  CHECK(test.last_edit() == "Fill connected tissue with weight of Fore");
  CHECK(test.wrong([](const glm::dvec3& p, Label label) { return label == kSkin ? 1 : before(p); }) == 0);
  std::vector<FormField> fields = test.editor->last_operation->fields;
  fields[0].chosen = 1;
  redo_last_operator(*test.editor, fields);
  CHECK(test.steps() == steps + 1);
  CHECK(test.wrong([](const glm::dvec3&, Label) { return 1; }) == 0);
  test.play("key Ctrl+Z");

  test.editor->selection->tissues = {kBone, kMuscle};
  test.play("key Shift+L\nwait-idle");
  CHECK(test.last_edit() == "Assign 2 tissues to Fore");
  CHECK(test.wrong(
            [](const glm::dvec3& p, Label label) { return label == kBone || label == kMuscle ? 1 : before(p); }) == 0);
}

TEST_CASE(
    "weight editing: on a large body an edit is a job, adjustable when it is done, and dropped where weights changed "
    "meanwhile") {
  EditEditor test;
  test.painting().edited_at_once = 0;
  test.painting().value = 0.25;
  const int steps = test.steps();
  test.play("key Ctrl+X\nwait-job\nwait-idle");
  CHECK(test.steps() == steps + 1);
  CHECK(test.last_edit() == "Flood Fore");
  const auto quarter = [](const glm::dvec3& p, Label label) { return label == kBone ? before(p) : 0.25; };
  CHECK(test.wrong(quarter) == 0);
  REQUIRE(why_not_redo(*test.editor).empty());
  std::vector<FormField> fields = test.editor->last_operation->fields;
  fields[1].value = 0.75;
  redo_last_operator(*test.editor, fields);
  fields[1].value = 0.5;
  redo_last_operator(*test.editor, fields);  // cancels the run with 0.75
  test.play("wait-job\nwait-idle");
  CHECK(test.steps() == steps + 1);
  CHECK(test.wrong([](const glm::dvec3& p, Label label) { return label == kBone ? before(p) : 0.5; }) == 0);

  run(*test.editor, "skin.flood");
  Document next = test.editor->document();
  next.weights = test::half_weights(*next.volume);
  test.editor->history->commit("Meanwhile", next);
  test.play("wait-job\nwait-idle");
  CHECK(test.last_edit() == "Meanwhile");
  CHECK(test.last_toast().find("changed meanwhile") != std::string::npos);
}

TEST_CASE(
    "weight editing: a gradient goes from full to none along the line drawn, or around its beginning, Escape gives it "
    "up") {
  EditEditor test;
  test.play("key Num5\nwait-idle");
  const int steps = test.steps();
  const auto seen = body_seen(*test.editor);
  const auto at = [&](const glm::dvec3& point) {
    const glm::dvec2 pixel = seen->pixel_of(point).value();
    return std::to_string(pixel.x) + " " + std::to_string(pixel.y);
  };
  const auto button = [&](bool down) {
    test.host->events.push(ButtonChanged{MouseButton::Left, down});
    test.player.settle();
  };
  test.play("key Shift+A\nmove " + at({0, 0, 20}));
  button(true);
  test.play("move " + at({0, 0, -20}) + "\nkey Escape\nwait-idle");
  button(false);
  CHECK(test.steps() == steps);
  CHECK(!test.editor->interaction->modal);

  test.play("key Shift+A\nmove " + at({0, 0, 20}));
  button(true);
  test.play("move " + at({0, 0, -20}));
  CHECK(test.steps() == steps);
  button(false);
  REQUIRE(test.steps() == steps + 1);
  // A pixel is half a millimetre, which limits how exactly the ends are placed. So weights may be off by 0.03.
  const double allowed = 0.03;
  const auto away = [&](const auto& expected) {
    double most = 0;
    test.for_each([&](const glm::dvec3& p, Label label, const Influence& influence) {
      if (label != kBone) most = std::max(most, std::abs(influence.of(1) - expected(p)));
    });
    return most;
  };
  CHECK(away([](const glm::dvec3& p) { return std::clamp((p.z + 20) / 40, 0.0, 1.0); }) < allowed);
  std::vector<FormField> fields = test.editor->last_operation->fields;
  fields[0].chosen = 1;
  redo_last_operator(*test.editor, fields);
  CHECK(test.steps() == steps + 1);
  // The gradient begins on the skin, where the button was pressed.
  const glm::dvec3 from(0, -std::sqrt(1600 - 400), 20);
  CHECK(away([&](const glm::dvec3& p) { return std::clamp(1 - glm::distance(p, from) / 40, 0.0, 1.0); }) < 0.12);
}

TEST_CASE("weight editing: brushes and floods keep to the region, drawn in 3D and in slices, added to and taken from") {
  EditEditor test;
  test.play("key Num5\nwait-idle");
  const auto seen = body_seen(*test.editor);
  const auto at = [&](const glm::dvec3& point) {
    const glm::dvec2 pixel = seen->pixel_of(point).value();
    return std::to_string(pixel.x) + " " + std::to_string(pixel.y);
  };
  const auto draw = [&](const char* key, const glm::dvec3& from, const glm::dvec3& to, const std::string& held = "") {
    test.play(std::string("key ") + key + "\nmove " + at(from) + (held.empty() ? "" : "\nkey-down " + held));
    test.host->events.push(ButtonChanged{MouseButton::Left, true});
    test.player.settle();
    test.play("move " + at(to));
    test.host->events.push(ButtonChanged{MouseButton::Left, false});
    test.player.settle();
    if (!held.empty()) test.play("key-up " + held);
  };
  draw("B", {0.5, 0, 60}, {60, 0, 0.5});
  const auto first = painted_region(*test.editor);
  REQUIRE(first);
  int wrong = 0;
  std::size_t place = 0;
  test.for_each(
      [&](const glm::dvec3& p, Label, const Influence&) { wrong += (*first)[place++] != (p.x > 0.5 && p.z > 0.5); });
  CHECK(wrong < 40);  // voxels at the region's border, which is a pixel wide
  CHECK(test.editor->views->scene.weights->region == first);
  const SkinWeights before_all = test.weights();

  test.painting().value = 1;
  test.play("key Ctrl+X\nwait-idle");
  place = 0;
  int outside = 0, inside = 0;
  test.for_each([&](const glm::dvec3& p, Label label, const Influence& influence) {
    const bool in = (*first)[place++] != 0;
    if (!in) outside += std::abs(influence.of(1) - before(p)) > 1e-9;
    else if (label != kBone) inside += influence != rigid_influence(1);
  });
  CHECK(outside == 0);
  CHECK(inside == 0);
  test.play("key Ctrl+Z");
  CHECK(test.weights() == before_all);

  // Paints a stroke across the region's border.
  test.painting().kind = BrushKind::Add;
  test.painting().radius = 15;
  test.painting().depth = BrushDepth::Through;
  test.play("move " + at({0, -40, 10}));
  test.host->events.push(ButtonChanged{MouseButton::Left, true});
  test.player.settle();
  test.host->events.push(ButtonChanged{MouseButton::Left, false});
  test.player.settle();
  place = 0;
  int changed = 0;
  test.for_each([&](const glm::dvec3& p, Label, const Influence& influence) {
    const bool in = (*first)[place++] != 0, differs = std::abs(influence.of(1) - before(p)) > 1e-9;
    CHECK((in || !differs));
    changed += differs;
  });
  CHECK(changed > 10);

  const std::int64_t right = painted_region_voxels(*test.editor);
  draw("B", {-60, 0, 60}, {0.5, 0, 0.5}, "Shift");
  CHECK(painted_region_voxels(*test.editor) > right * 3 / 2);
  draw("B", {-60, 0, 60}, {0.5, 0, 0.5}, "Ctrl");
  CHECK(std::abs(painted_region_voxels(*test.editor) - right) < 40);
  const auto kept = painted_region(*test.editor);
  draw("C", {60, 0, 60}, {61, 0, 61});  // this rectangle contains nothing
  CHECK(painted_region(*test.editor) == kept);
  test.play("key Alt+A\nwait-idle");
  CHECK(!painted_region(*test.editor));
}

TEST_CASE("weight editing: a mirror tells what it found no match for, and that can be made the region") {
  EditEditor test;
  Document next = test.editor->document();
  Armature rig;
  rig.bones = {{"Arm.L", -1, {20, 0, 10}, {20, 0, -10}}, {"Arm.R", -1, {-20, 0, 10}, {-20, 0, -10}}};
  next.armature = std::make_shared<const Armature>(rig);
  SkinWeights weights({"Arm.L", "Arm.R"}, TissueVoxels(*next.volume));
  next.weights = std::make_shared<const SkinWeights>(weights);
  // The right side has a part that the left side lacks.
  auto volume = std::make_shared<LabelVolume>(*next.volume);
  const AffineTransform world = world_from_voxel(volume->grid);
  TissueVoxels whole(*volume);
  int cut = 0;
  for (std::size_t i = 0; i < volume->voxels.size(); ++i) {
    const glm::ivec3 size = volume->grid.size,
                     voxel(static_cast<int>(i) % size.x, static_cast<int>(i) / size.x % size.y,
                           static_cast<int>(i) / size.x / size.y);
    if ((world * glm::dvec3(voxel)).x > 10 && volume->voxels[i]) volume->voxels[i] = 0, ++cut;
  }
  REQUIRE(cut > 0);
  next.volume = volume;
  next.weights = std::make_shared<const SkinWeights>(std::vector<std::string>{"Arm.L", "Arm.R"}, TissueVoxels(*volume));
  test.editor->history->commit("Lopsided", next);
  test.choose(0);
  test.play("key Ctrl+M\nwait-idle");
  CHECK(test.last_edit() == "Mirror weights to the right");
  CHECK(test.last_toast().find("voxels have no match within 10.0 mm and stay") != std::string::npos);
  const std::size_t unmatched = test.painting().unmatched.size();
  CHECK(unmatched > 0);
  run(*test.editor, "skin.region_unmatched");
  CHECK(painted_region_voxels(*test.editor) == static_cast<std::int64_t>(unmatched));
  // Voxels with a match on the other side follow the other bone. Voxels without one keep theirs.
  const TissueVoxels tissue(*volume);
  const auto region = painted_region(*test.editor);
  std::size_t place = 0;
  test.for_each([&](const glm::dvec3& p, Label, const Influence& influence) {
    const bool stays = (*region)[place++] != 0 || p.x >= -1e-9;
    CHECK(influence == rigid_influence(stays ? 0 : 1));
  });
}

TEST_CASE("brush ring: it lies on the skin of a ball, and is flat where the ball has ended") {
  EditEditor test;
  BrushPlace place;
  place.seen = place.rest = {0, -40, 0};
  place.normal = {0, -1, 0};
  for (const RingPoint& point : ring_on_body(test.editor->views, place, 20, 64)) {
    CHECK(point.on_body);
    CHECK(std::abs(glm::length(point.at) - 40) < 4);  // mm; voxels are 4 x 5 x 3 mm
    CHECK(std::hypot(point.at.x, point.at.z) == doctest::Approx(20));
  }
  int lost = 0;
  for (const RingPoint& point : ring_on_body(test.editor->views, place, 50, 64)) {
    lost += !point.on_body;
    if (!point.on_body) CHECK(point.at.y == doctest::Approx(-40));
  }
  CHECK(lost == 64);
}

TEST_CASE("painting: below the bone a brush changes nothing where other bones have most") {
  EditEditor test;
  Document next = test.editor->document();
  Armature rig = *next.armature;
  rig.bones.push_back({"Other", -1, {40, 0, 0}, {60, 0, 0}});  // not related to the other two bones
  next.armature = std::make_shared<const Armature>(rig);
  const TissueVoxels tissue(*next.volume);
  SkinWeights weights({"Upper", "Fore", "Other"}, tissue);
  const AffineTransform world = world_from_voxel(next.volume->grid);
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    SkinWeights::Influences chunk = weights.chunk(brick);
    tissue.for_each(brick, brick + 1, [&](std::int64_t at, const glm::ivec3& voxel) {
      chunk[at - tissue.bricks()[brick].first] = rigid_influence((world * glm::dvec3(voxel)).x > 0 ? 2 : 0);
    });
    weights.set_chunk(brick, chunk);
  }
  next.weights = std::make_shared<const SkinWeights>(weights);
  test.editor->history->commit("Three bones", next);
  test.choose(1);
  test.painting().value = 1;
  test.painting().subtree = true;
  test.play("key Ctrl+X\nwait-idle");
  test.for_each([&](const glm::dvec3& p, Label label, const Influence& influence) {
    if (p.x > 0) CHECK(influence == rigid_influence(2));
    else if (label != kBone) CHECK(influence == rigid_influence(1));
  });
}

TEST_CASE("brush: its own falloff is a curve whose points are dragged, added and taken away") {
  LimbEditor test;
  Document next = test.editor->document();
  next.weights = test::half_weights(*next.volume);
  test.editor->history->reset(next, "Open weighted limb");
  test.play("key Ctrl+2\nwait-idle");
  Painting& painting = *test.editor->skin->painting;
  const Falloff smooth = falloff_of(painting);
  test.play("click \"Edit/Brush/Falloff/Custom falloff\"\nwait-idle");
  REQUIRE(painting.falloff_curve.size() == 5);
  CHECK(std::abs(falloff_of(painting)(0.5f) - smooth(0.5f)) < 1e-3);
  // Drags the curve's middle point, at half the height of the box, down to the bottom.
  const Rect box = test.editor->ui->widgets.find("Brush/curve")->rect;
  const auto drag = [&](const glm::vec2& from, const glm::vec2& to) {
    test.host->events.push(PointerMoved{from});
    test.player.settle();
    test.host->events.push(ButtonChanged{MouseButton::Left, true});
    test.player.settle();
    test.host->events.push(PointerMoved{to});
    test.player.settle();
    test.host->events.push(ButtonChanged{MouseButton::Left, false});
    test.player.settle();
  };
  drag(box.centre(), {box.centre().x, box.high.y});
  REQUIRE(painting.falloff_curve.size() == 5);
  CHECK(painting.falloff_curve[2].y == 0);
  CHECK(falloff_of(painting)(0.5f) < 0.01f);
  // Adds a point between the first two, at the height of the pointer.
  drag({box.low.x + box.width() * 0.16f, box.centre().y}, {box.low.x + box.width() * 0.16f, box.centre().y});
  REQUIRE(painting.falloff_curve.size() == 6);
  CHECK(painting.falloff_curve[1].y == doctest::Approx(0.5).epsilon(0.05));
  // A point cannot be dragged past its neighbour.
  drag({box.low.x + box.width() * 0.16f, box.centre().y}, {box.high.x - 10, box.centre().y});
  CHECK(painting.falloff_curve[1].x < painting.falloff_curve[2].x);
  CHECK(painting.falloff_curve[1].x > painting.falloff_curve[0].x);
  test.play("click \"Edit/Brush/Falloff/Smooth falloff\"\nwait-idle");
  CHECK(painting.falloff_curve.empty());
  CHECK(falloff_of(painting) == smooth);
}

TEST_CASE("painting: with X-mirror a stroke paints the bone of the other side there, as one step") {
  EditEditor test;
  Document next = test.editor->document();
  Armature rig;
  rig.bones = {{"Trunk", -1, {0, 0, -30}, {0, 0, 30}},
               {"Arm.L", 0, {20, 0, 10}, {20, 0, -10}},
               {"Arm.R", 0, {-20, 0, 10}, {-20, 0, -10}}};
  next.armature = std::make_shared<const Armature>(rig);
  next.weights = std::make_shared<const SkinWeights>(std::vector<std::string>{"Trunk", "Arm.L", "Arm.R"},
                                                     TissueVoxels(*next.volume));
  test.editor->history->commit("Two arms", next);
  test.choose(1);
  test.editor->transform_settings->x_mirror = true;
  test.painting().kind = BrushKind::Add;
  test.painting().strength = 0.5;
  test.painting().radius = 12;
  test.painting().depth = BrushDepth::Through;
  test.play("key Num5\nwait-idle");
  const glm::dvec2 pixel = body_seen(*test.editor)->pixel_of({22, -std::sqrt(1600 - 22 * 22), 0}).value();
  const int steps = test.steps();
  test.play("move " + std::to_string(pixel.x) + " " + std::to_string(pixel.y) + "\nwait-idle");
  for (const bool down : {true, false}) {
    test.host->events.push(ButtonChanged{MouseButton::Left, down});
    test.player.settle();
  }
  CHECK(test.steps() == steps + 1);
  int left = 0, right = 0;
  test.for_each([&](const glm::dvec3& p, Label, const Influence& influence) {
    left += influence.of(1) > 0;
    right += influence.of(2) > 0;
    CHECK((influence.of(1) == 0 || p.x > 0));
    CHECK((influence.of(2) == 0 || p.x < 0));
  });
  CHECK(left > 20);
  // The plane lies between voxels, and rays hit the sides at slightly different points, so the counts differ a little.
  CHECK(std::abs(left - right) <= left / 5);
  test.play("key Ctrl+Z");
  test.for_each([&](const glm::dvec3&, Label, const Influence& influence) { CHECK(influence == rigid_influence(0)); });
}

TEST_CASE("weight editing: choosing a bone leaves the chosen tissues, which brushes may be kept to") {
  EditEditor test;
  test.editor->selection->tissues = {kMuscle};
  test.editor->selection->tissue = kMuscle;
  test.play("key N\nwait-idle\nclick Bones/Upper/name\nwait-idle");
  CHECK(test.editor->selection->bone == 0);
  CHECK(test.editor->selection->tissues == std::set<Label>{kMuscle});
}
