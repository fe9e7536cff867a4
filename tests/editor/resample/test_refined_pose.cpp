// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the refined pose: what the views show at rest is what `limber resample` writes.
#include <fstream>
#include <set>

#include "core/body/bind_body.h"
#include "core/pose/pose_io.h"
#include "core/resample/glide_joints.h"
#include "core/resample/posed_voxels.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weights_io.h"
#include "editor/context/interaction.h"
#include "editor/context/preferences.h"
#include "editor/context/resampling_settings.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/pose/live_preview.h"
#include "editor/resample/refined_pose.h"
#include "editor/shown/compare_wipe.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/messages.h"
#include "render/scene/tissue_appearance.h"
#include "tests/editor/weighed_limb.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// The editor in the Pose workspace, in which poses are refined.
struct RefiningEditor : SmallEditor {
  RefiningEditor(Document document, const glm::ivec2& size) : SmallEditor(size, {}, false) {
    editor->history->reset(std::move(document), "Open");
    editor->background->worker_program = LIMBER_PROGRAM;
    editor->refined->on = true;
    editor::frame_all(*editor, false);
    play("key Ctrl+3\nkey Num1\nwait-idle");
  }
  void set_pose(const Pose& pose) {
    Document next = editor->document();
    next.pose = std::make_shared<const Pose>(pose);
    commit(*editor, "Pose", next);
  }
  bool shows_refined() const { return editor->views->body.shows_refined; }
  ViewPlace body_place() const { return {ViewId::Body, *editor->screen->layout.place_of(ViewId::Body)}; }
};

Document weighed_limb() {
  Document document = small_limb();
  document.weights = half_weights(*document.volume);
  return document;
}

Pose bent(const Document& document, int bone, double degrees) {
  Pose pose = rest_pose(*document.armature);
  flex(pose, *document.armature, bone, degrees);
  return pose;
}

struct LimbRefiner : RefiningEditor {
  LimbRefiner() : RefiningEditor(weighed_limb(), {900, 560}) {}
  Pose fore(double degrees) const { return bent(editor->document(), 1, degrees); }
};

Document arm() {
  const Body body = make_body(read_volume(shared_path("data/bender/man-arm-2mm.mha")), nullptr,
                              read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk")), {}, {}, "arm");
  const BoundBody bound = bind_body(body, Binding::Heat, {}, no_progress());
  Document document;
  document.volume = std::make_shared<const LabelVolume>(body.file.volume);
  document.volume_type = std::make_shared<const FileType>(body.file.type);
  document.tissues = std::make_shared<const TissueTable>(body.tissues);
  document.armature = std::make_shared<const Armature>(body.rig);
  document.weights = std::make_shared<const SkinWeights>(bound.weights);
  return document;
}

// Returns the volume that the command line writes for the document's pose with its default method.
std::shared_ptr<const LabelVolume> resampled_by_program(const Document& document) {
  const TemporaryFolder folder;
  write_volume(*document.volume, folder / "rest.nrrd", *document.tissues);
  write_tissue_table(*document.tissues, folder / "tissues.json");
  write_armature(*document.armature, folder / "rig.json");
  write_pose(*document.pose, *document.armature, folder / "pose.json");
  write_weights(*document.weights, *document.volume, TissueVoxels(*document.volume), folder / "weights.nrrd");
  const auto file = [&](const char* name) { return (folder / name).string(); };
  const ProgramRun run = run_program(
      LIMBER_PROGRAM, {"resample", file("rest.nrrd"), "--rig", file("rig.json"), "--tissues", file("tissues.json"),
                       "--weights", file("weights.nrrd"), "--pose", file("pose.json"), "-o", file("posed.nrrd")});
  REQUIRE(run.exit_code == 0);
  VolumeFile posed = read_volume(folder / "posed.nrrd");
  std::map<Label, Label> label_of{{Label{0}, Label{0}}};
  for (const Tissue& tissue : posed.tissues.tissues)
    for (const Tissue& ours : document.tissues->tissues)
      if (ours.file_value == tissue.file_value) label_of[tissue.label] = ours.label;
  for (Label& label : posed.volume.voxels) label = label_of.at(label);
  return std::make_shared<const LabelVolume>(std::move(posed.volume));
}

// Returns the labels at the pixels of a picture of a volume, seen as the editor sees its body.
std::vector<Label> labels_of(RefiningEditor& test, const std::shared_ptr<const LabelVolume>& volume) {
  Views& views = *test.editor->views;
  render::Scene scene;
  scene.volume = volume;
  scene.looks = std::make_shared<const render::LabelLooks>(render::looks_of(*test.editor->document().tissues, {}));
  render::View3D picture(views.renderer);
  const glm::ivec2 size(test.body_place().rect.size());
  for (double now = 0; now == 0 || !picture.complete(); now += 1) picture.draw(scene, views.body.camera, size, now);
  return picture.pixel_labels();
}

// Returns the share of the pixels on either body that have the same label.
double agreement(const std::vector<Label>& a, const std::vector<Label>& b) {
  REQUIRE(a.size() == b.size());
  std::int64_t body = 0, same = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    body += a[i] != 0 || b[i] != 0;
    same += (a[i] != 0 || b[i] != 0) && a[i] == b[i];
  }
  REQUIRE(body > 10'000);
  return double(same) / double(body);
}

std::size_t files_in(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) count += entry.is_regular_file();
  return count;
}

}  // namespace

TEST_CASE("refined pose: at rest, a real arm shows the labels that the command line writes, on 99.5 % of the pixels") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  RefiningEditor test(arm(), {820, 700});
  test.draw_finely();
  const int forearm = require_bone(*test.editor->document().armature, "Forearm");
  for (const double degrees : {45.0, 90.0}) {
    CAPTURE(degrees);
    test.set_pose(bent(test.editor->document(), forearm, degrees));
    test.play("wait 0.5\nwait-idle");
    REQUIRE(test.shows_refined());
    CHECK(test.fact("text:Mixed, refined") == "shown");
    const std::vector<Label> dense = labels_of(test, resampled_by_program(test.editor->document()));
    const BodyView& body = test.editor->views->body;
    const double share = agreement(body.refined->pixel_labels(), dense);
    MESSAGE("at ", degrees, " degrees ", share, " of the pixels are equal, of the preview ",
            agreement(body.picture->pixel_labels(), dense));
    CHECK(share >= 0.995);
  }
}

TEST_CASE("refined pose: the frame of a change shows the preview again, and so does each frame of a turn") {
  LimbRefiner test;
  test.set_pose(test.fore(40));
  test.play("wait 0.5\nwait-idle");
  REQUIRE(test.shows_refined());
  Views& views = *test.editor->views;
  CHECK(views.refined_scene->volume == test.editor->refined->volume);
  CHECK(views.scene.volume == test.editor->document().volume);  // positions at rest stay those of the preview
  CHECK(views.scene.pose);

  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  show_pose(*test.editor, test.fore(50));
  test.player.step();
  CHECK_FALSE(test.shows_refined());
  CHECK_FALSE(views.refined_scene);
  CHECK(&body_at_pointer(*test.editor, test.body_place()) == views.body.picture.get());
  drop_shown_pose(*test.editor);
  test.play("wait 0.5\nwait-idle");
  REQUIRE(test.shows_refined());

  int moved = 0;
  test.editor->background->each_frame.push_back([&](Context& context) {
    // The scene is still that of the frame before. A turn under way has a pose of its own.
    if (!context.interaction->modal || !context.views->preview_pose) return true;
    ++moved;
    CHECK(context.refined->job == 0);
    return true;
  });
  test.play("key R\nkey X\nkey 2\nkey 0\nwait 1");
  CHECK(moved > 30);
  CHECK_FALSE(test.shows_refined());
  test.play("key Return\nwait 0.5\nwait-idle");
  CHECK(test.shows_refined());
  test.play("key Ctrl+Z");
  CHECK_FALSE(test.shows_refined());
}

TEST_CASE("refined pose: the live volume is counted in the refined volume") {
  LimbRefiner test;
  test.set_pose(test.fore(40));
  test.play("wait 0.5\nwait-idle\nwait 0.5\nwait-idle");
  REQUIRE(test.shows_refined());
  const RefinedPose& refined = *test.editor->refined;
  const PoseMetrics* known = test.editor->live->metrics().known();
  REQUIRE(known);
  const auto& voxels = refined.volume->voxels;
  const auto air = std::count(voxels.begin(), voxels.end(), Label{0});
  CHECK(known->total.mm3_after == doctest::Approx(60.0 * static_cast<double>(std::ssize(voxels) - air)));
  CHECK(known->overlap_voxels == refined.overlap_voxels);
  // As the worker does, shifts bones that overlap at a joint by less than a voxel.
  const Document& document = test.editor->document();
  const GlidedPose glided =
      glide_joints(*document.volume, TissueVoxels(*document.volume), LabelSets(*document.tissues).bone,
                   *document.weights, *document.armature, *document.pose, {.whole_mm = 0.99 * 5});
  const Posed posed = resample(*document.volume, *document.tissues, *document.armature, *document.weights, glided.pose,
                               Blend::Mixed, {.overlap = true});
  const auto apart = std::count(posed.overlap.begin(), posed.overlap.end(), Label{0});
  CHECK(refined.overlap_voxels == std::ssize(posed.overlap) - apart);
}

TEST_CASE("refined pose: a change ends the worker, without a message, and leaves no files of the old pose") {
  LimbRefiner test;
  const TemporaryFolder scratch, programs;
  test.editor->preferences->scratch_folder = std::filesystem::path(scratch / "").string();
  const Path sleeper = programs / "worker";
  std::ofstream(sleeper) << "#!/bin/sh\nexec sleep 60\n";
  std::filesystem::permissions(sleeper, std::filesystem::perms::owner_all);
  test.editor->background->worker_program = sleeper;
  test.set_pose(test.fore(40));
  test.play("wait 0.5");
  const int job = test.editor->refined->job;
  REQUIRE(job != 0);
  CHECK(test.fact("text:refining") == "shown");
  CHECK(test.fact("toast") == "none");
  test.editor->background->worker_program = LIMBER_PROGRAM;
  test.set_pose(test.fore(45));
  test.player.step();
  CHECK(test.editor->refined->job == 0);
  test.play("wait 0.5\nwait-idle");
  CHECK(test.shows_refined());
  CHECK(test.fact("toast") == "none");
  CHECK(test.fact("error") == "none");
  const std::size_t kept = files_in(scratch / "");  // those of the body
  test.set_pose(test.fore(50));
  test.play("wait 0.5\nwait-idle");
  CHECK(test.shows_refined());
  CHECK(files_in(scratch / "") == kept);
  Document next = test.editor->document();
  next.weights = half_weights(*next.volume);
  next.pose = nullptr;
  commit(*test.editor, "Weigh again", next);
  test.play("wait-idle");
  CHECK(files_in(scratch / "") == 0);
}

TEST_CASE("refined pose: a body beyond the memory limit stays a preview, and the view says so") {
  LimbRefiner test;
  test.editor->refined->most_voxels = test.editor->document().volume->grid.voxel_count() - 1;
  test.set_pose(test.fore(40));
  test.play("wait 0.5\nwait-idle");
  CHECK_FALSE(test.shows_refined());
  CHECK(test.editor->refined->poses == 0);
  CHECK(test.fact("text:not refined: too large") == "shown");
}

TEST_CASE("refined pose: nothing is refined at rest, by finite elements, while painting or if the user wants none") {
  LimbRefiner test;
  test.play("wait 0.5\nwait-idle");
  CHECK(test.editor->refined->poses == 0);
  test.editor->preferences->refine_at_rest = false;
  test.set_pose(test.fore(40));
  test.play("wait 0.5\nwait-idle");
  CHECK(test.editor->refined->poses == 0);
  CHECK(test.fact("text:refin") == "absent");
  test.editor->preferences->refine_at_rest = true;
  test.editor->resampling->method = "fem";
  test.play("wait 0.5\nwait-idle");
  CHECK(test.editor->refined->poses == 0);
  CHECK(test.fact("text:not refined: finite elements") == "shown");
  test.editor->resampling->method = "dqs";
  test.editor->screen->workspace = Workspace::Skin;
  test.play("wait 0.5\nwait-idle");
  CHECK(test.editor->refined->poses == 0);
  test.editor->screen->workspace = Workspace::Pose;
  test.play("wait 0.5\nwait-idle");
  CHECK(test.shows_refined());
  test.editor->resampling->method = "lbs";
  test.player.step();
  CHECK_FALSE(test.shows_refined());
}

TEST_CASE("refined pose: a failed worker leaves the preview, and the view says why") {
  LimbRefiner test;
  test.editor->background->worker_program = "/bin/false";
  test.set_pose(test.fore(40));
  test.play("wait 0.5\nwait-idle");
  CHECK_FALSE(test.shows_refined());
  CHECK(test.editor->refined->poses == 1);
  CHECK(test.fact("text:not refined: ") == "shown");
  CHECK(test.fact("toast") == "none");
  CHECK(test.fact("error") == "none");
}

TEST_CASE("refined pose: the voxel under the pointer is the one at rest") {
  LimbRefiner test;
  test.draw_finely();
  test.set_pose(test.fore(10));  // small, because flesh that a bend bares becomes skin, which has no skin at rest
  test.play("wait 0.5\nwait-idle");
  REQUIRE(test.shows_refined());
  const ViewPlace place = test.body_place();
  const glm::ivec2 size(place.rect.size());
  const LabelVolume& rest = *test.editor->document().volume;
  int picked = 0, equal = 0;
  for (int y = 0; y < size.y; y += 12)
    for (int x = 0; x < size.x; x += 12) {
      const auto hit = pick_body(*test.editor, place, {x, y});
      if (!hit) continue;
      ++picked;
      equal += rest.at_or_air(hit->voxel) == hit->label;
      CHECK(rest.at_or_air(hit->voxel) != 0);
    }
  CHECK(picked > 50);
  CHECK(equal >= picked * 95 / 100);
}
