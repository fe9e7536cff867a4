// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "core/binding/rigid.h"
#include "core/bones/bone_parts.h"
#include "core/deform/preview_map.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/context/pose_editing.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/files/view_state_json.h"
#include "editor/pose/live_preview.h"
#include "editor/pose/pose_edits.h"
#include "editor/resample/results.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/shown/preview_blend.h"
#include "editor/volume/volume_change.h"
#include "render/gl/object.h"
#include "tests/editor/small_clip.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;

namespace {

constexpr glm::ivec2 kWithSidebar{1120, 720};

// The limb in the Pose workspace, seen from the front. Its lower half follows one bone.
struct LiveEditor : LimbEditor {
  explicit LiveEditor(bool with_weights = true, const glm::ivec2& size = {900, 560}) : LimbEditor(size) {
    if (with_weights) weigh();
    play("key Ctrl+3\nkey Num1\nwait-job");
    editor->selection->bone = 1;
    editor->selection->bones = {1};
    editor->posing->keep_limits = false;
  }
  void weigh() {
    Document next = editor->document();
    const TissueVoxels tissue(*next.volume);
    next.weights = std::make_shared<const SkinWeights>(bind_rigid(
        *next.volume, tissue, *next.armature, split_bones(*next.volume, tissue, *next.tissues, *next.armature)));
    commit(*editor, "Weigh", next);
  }
  const render::Scene& scene() const { return editor->views->scene; }
  bool pose_is(double degrees) const {
    return std::abs(glm::degrees(glm::angle(scene().posed_from_rest[1].rotation)) - degrees) < 1e-6;
  }
  // Returns the distance in mm between the rest position that the map gives for a posed point of the lower half, and
  // the true one.
  double error() const {
    const auto map = scene().pose;
    if (!map) return INFINITY;
    const glm::dvec3 low(0, 0, -25);
    const auto rest = map->rest_at(voxel_from_world(map->grid) * (scene().posed_from_rest[1] * low));
    return rest ? glm::distance(world_from_voxel(map->grid) * *rest, low) : INFINITY;
  }
  void turn(const char* axis, int degrees) {
    play(std::string("key R\nkey ") + axis);
    for (const char digit : std::to_string(degrees)) play(std::string("key ") + digit);
    play("wait-job");
  }
};

// Plays one second of a motion that bends the joint.
void add_clip_and_play(LiveEditor& test) {
  Document next = test.editor->document();
  add_clip(next, clip_of(std::make_shared<const Motion>(limber::test::bending_motion(*next.armature)), "bending"));
  commit(*test.editor, "Add clip", next);
  play(*test.editor, 1);
  test.play("wait 1");
  stop_playing(*test.editor);
  test.play("wait-job");
}

}  // namespace

TEST_CASE("live pose: without a sidebar the status bar tells the change of volume") {
  LiveEditor test;
  CHECK(test.fact("text:Volume ") == "absent");
  test.turn("X", 45);
  test.play("key Return\nwait 0.5\nwait-idle\nwait 0.5\nwait-idle");
  REQUIRE(test.editor->live->metrics().known());
  CHECK(test.fact("text:Volume " + percent(test.editor->live->metrics().known()->total.change_percent())) == "shown");
}

TEST_CASE("live pose: the volume follows while a bone is turned, is kept with Return and goes back with Escape") {
  LiveEditor test;
  CHECK(!test.scene().pose);  // at rest the volume itself is drawn
  test.turn("X", 45);
  CHECK(test.error() < 2);
  CHECK(test.pose_is(45));
  test.play("key Return\nwait-job");
  CHECK(test.error() < 2);
  CHECK(test.pose_is(45));
  test.turn("X", 20);
  CHECK(test.error() < 2);
  CHECK(test.pose_is(65));
  test.play("key Escape\nwait-job");
  CHECK(test.error() < 2);
  CHECK(test.pose_is(45));
  test.play("key Ctrl+Z\nwait-job");
  CHECK(!test.scene().pose);
  test.play("key Ctrl+Shift+Z\nwait-job");
  CHECK(test.scene().pose);
  test.play("key Ctrl+1\nwait-job");
  CHECK(!test.scene().pose);
}

TEST_CASE("live pose: in every frame of a turn, of a motion and on the way back bones and body are in one pose") {
  LiveEditor test;
  int frames = 0, behind = 0;
  double worst = 0;
  // Runs once per frame, while the scene is still that of the frame before.
  test.editor->background->each_frame.push_back([&](Context& editor) {
    const auto& motions = test.scene().posed_from_rest;
    if (editor.workspace() != Workspace::Pose || !test.scene().armature) return true;
    ++frames;
    behind += seen_pose(editor) != shown_pose(editor);
    const bool at_rest = motions.empty() || glm::angle(motions[1].rotation) < 1e-9;
    worst = std::max(worst, test.scene().pose ? test.error() : at_rest ? 0 : INFINITY);
    return true;
  });
  test.turn("X", 45);
  for (const char digit : std::string("0918273645")) test.play(std::string("key Backspace\nkey ") + digit);
  test.play("key Return\nwait-job");
  add_clip_and_play(test);
  test.play("key Ctrl+Z\nwait-job");
  CHECK(frames > 60);
  CHECK(behind > 10);  // in these frames the drawn pose was older than the pose that was set
  CHECK(worst < 2);    // mm between the map's rest position and the true one
  test.editor->background->each_frame.clear();
}

TEST_CASE("live pose: handles, and what the pointer meets, stand at the bones that are seen") {
  LiveEditor test;
  test.turn("X", 45);
  test.play("key Return\nwait-job");
  Pose further = *test.editor->document().pose;
  further.rotation[1] = glm::angleAxis(1.5, glm::dvec3(1, 0, 0));
  show_pose(*test.editor, further);
  CHECK(seen_pose(*test.editor) == *test.editor->document().pose);
  const auto seen = body_seen(*test.editor);
  REQUIRE(seen);
  test.editor->interaction->tool = Tool::Move;
  const auto gizmo = gizmo_in(*test.editor, *seen);
  REQUIRE(gizmo);
  const glm::dvec3 tail = test.editor->document().armature->bones[1].tail;
  CHECK(glm::distance(gizmo->centre, test.scene().posed_from_rest[1] * tail) < 1e-9);
  test.play("wait-job");
  CHECK(seen_pose(*test.editor) == further);
}

TEST_CASE("live pose: a pose that rests is refined, and coarse again once it changes") {
  LiveEditor test;
  test.turn("X", 45);
  CHECK(test.fact("posed") == "4");
  test.play("wait 0.4\nwait-job");
  CHECK(test.fact("posed") == "2");
  test.play("key 9\nwait-job");
  CHECK(test.fact("posed") == "4");
}

TEST_CASE("live pose: what the pointer is over is the voxel at rest, in slices and in the 3D view") {
  LiveEditor test;
  test.turn("Y", 90);
  test.play("key Return\nclick view.four\nwait-job");
  const glm::dvec3 rest(15, 1, -20), posed = test.scene().posed_from_rest[1].rotation * rest;
  const Grid& grid = test.editor->document().volume->grid;
  test.editor->views->cross_hair = posed;
  test.play("wait-job");
  const Rect* place = test.editor->screen->layout.place_of(ViewId::Coronal);
  REQUIRE(place);
  const glm::vec2 pixel =
      place->low + pixel_of(slice_of(*test.editor->views, ViewId::Coronal).camera, posed, place->size());
  test.play("move " + std::to_string(pixel.x) + " " + std::to_string(pixel.y));
  const Hover& hover = test.editor->views->hover;
  CHECK(hover.label == 17);
  CHECK(glm::distance(world_from_voxel(grid) * glm::dvec3(hover.voxel), rest) < 6);
  REQUIRE(hover.weights.size() == 1);
  CHECK(hover.weights[0].bone == "Fore");

  test.play("move \"3D view/view\"");
  REQUIRE(hover.inside);
  CHECK(hover.label == test.editor->document().volume->at(hover.voxel));
}

TEST_CASE("live pose: linear blending and dual quaternions are chosen in the tool header, and kept with the project") {
  LiveEditor test;
  test.turn("X", 60);
  test.play("key Return\nwait-job");
  const auto dual = test.scene().pose;
  test.play("click resample.lbs\nwait-job");
  CHECK(preview_blend(test.editor->resampling) == Blend::Linear);
  CHECK(test.scene().pose != dual);
  const std::string kept = editor_state(*test.editor);
  test.play("click resample.dqs\nwait-job");
  CHECK(preview_blend(test.editor->resampling) == Blend::DualQuaternion);
  CHECK(test.error() < 2);
  restore_editor_state(*test.editor, kept);
  CHECK(preview_blend(test.editor->resampling) == Blend::Linear);
}

TEST_CASE("live pose: without weights only the bones move") {
  LiveEditor test(false, kWithSidebar);
  test.turn("X", 60);
  CHECK(!test.scene().pose);
  CHECK(glm::angle(test.scene().posed_from_rest[1].rotation) == doctest::Approx(std::numbers::pi / 3));
  CHECK(test.editor->live->trouble() == "No weights yet");
  CHECK(test.fact("text:No weights yet") == "shown");
  test.play("key Return\nclick \"Live volume/Heat diffusion\"\nwait-job");
  CHECK(test.scene().pose);
  CHECK(test.editor->live->trouble().empty());
}

TEST_CASE("live pose: weights of another volume are refused in words") {
  LiveEditor test;
  Document next = test.editor->document();
  auto volume = std::make_shared<LabelVolume>(*next.volume);
  for (std::size_t i = 0; i < volume->voxels.size() / 2; ++i) volume->voxels[i] = 0;
  next.volume = volume;
  commit(*test.editor, "Halve", next);
  test.turn("X", 60);
  CHECK(!test.scene().pose);
  CHECK(test.editor->live->trouble().find("another volume") != std::string::npos);
}

TEST_CASE(
    "live pose: what a resting pose does to the tissue is measured as its result would be, and again for the next "
    "pose") {
  LiveEditor test(true, kWithSidebar);
  test.play("wait 1\nwait-job");
  LiveMetrics& metrics = test.editor->live->metrics();
  CHECK(!metrics.known());  // at rest there is nothing to measure
  CHECK(test.fact("text:At rest") == "shown");
  test.turn("X", 60);
  CHECK(!metrics.known());
  test.play("key Return\nwait 1\nwait-job\nwait 0.1");
  REQUIRE(metrics.known());
  const PoseMetrics bent = *metrics.known();
  const Document& document = test.editor->document();
  const PoseMetrics same =
      measure({document.volume, document.tissues, document.armature, document.weights, *document.pose, Blend::Mixed});
  REQUIRE(bent.tissues.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(bent.tissues[i].name == same.tissues[i].name);
    CHECK(bent.tissues[i].mm3_after == same.tissues[i].mm3_after);
  }
  CHECK(bent.overlap_voxels == same.overlap_voxels);
  CHECK(test.fact("text:dense") == "shown");
  test.turn("X", 80);
  CHECK(!metrics.known());
  CHECK(metrics.last());
  CHECK(test.fact("text:coarse") == "shown");
  test.play("wait 1\nwait-job");  // the tool is still active
  REQUIRE(metrics.known());
  CHECK(metrics.known()->overlap_voxels != bent.overlap_voxels);
  test.play("key Escape");
}

TEST_CASE("live pose: a result is shown for its own pose, and gives way to the next one") {
  LiveEditor test;
  test.turn("X", 60);
  test.play("key Return\nwait-job");
  Document next = test.editor->document();
  auto result = std::make_shared<Result>();
  result->name = "Bent";
  result->volume = next.volume;
  result->from_volume = next.volume;
  result->from_pose = next.pose;
  next.results.push_back(result);
  commit(*test.editor, "Add result", next);
  show_result(*test.editor, "Bent");
  test.play("wait-job");
  CHECK(shown_result(*test.editor) == result);
  CHECK(!test.scene().pose);
  test.turn("X", 10);
  CHECK(!shown_result(*test.editor));
  CHECK(test.scene().pose);
  test.play("key Escape\nkey Ctrl+4\nwait-job");
  CHECK(shown_result(*test.editor) == result);
}

TEST_CASE(
    "live pose: an editor closed with a posed body in all its views, or with a result beside it, leaves no OpenGL "
    "object") {
  for (const bool with_result : {false, true}) {
    LiveEditor test;
    test.turn("X", 60);
    test.play("key Return\nclick view.four\nwait 0.5\nwait-job");
    CHECK(test.scene().pose);
    if (with_result) {
      Document next = test.editor->document();
      auto result = std::make_shared<Result>();
      result->name = "Bent";
      result->volume = std::make_shared<const LabelVolume>(*next.volume);
      result->from_volume = next.volume;
      result->from_pose = next.pose;
      next.results.push_back(result);
      commit(*test.editor, "Add result", next);
      test.play("key Ctrl+4\nmove \"3D view/view\"\nkey 4\nwait-job");
      CHECK(wiping(*test.editor));
      CHECK(test.editor->views->other_scene);
      CHECK(test.scene().volume == result->volume);
    }
    CHECK(render::gl::live_objects() > 0);
    test.editor.reset();
    CHECK(render::gl::live_objects() == 0);
  }
}
