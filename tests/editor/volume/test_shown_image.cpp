// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/comparison.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/resampling_settings.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"

#include <cmath>

#include "core/pose/pose_io.h"
#include "core/volume_io/volume_io.h"
#include "editor/files/export.h"
#include "editor/files/import.h"
#include "editor/resample/resample_job.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

namespace {

using editor::Views;

// Returns a CT of the ball of small_body(), on a grid of its own: soft tissue around bone, in air.
GreyVolume scan() {
  GreyVolume image;
  image.grid = {{40, 40, 40}, {2.5, 2.5, 2.5}, {-49, -49, -49}, glm::dmat3(1)};
  image.type = {"NRRD", "int16", true};
  const AffineTransform world = world_from_voxel(image.grid);
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const double r = glm::length(world * glm::dvec3(x, y, z));
        image.voxels.push_back(static_cast<float>((r < 12 ? 800 : r < 40 ? 50 : -1000) + (x + 3 * y + 5 * z) % 17));
      }
  return image;
}

struct Scan : Home {
  Scan() { write_grey_volume(scan(), *this / "ct.nrrd"); }
};

const render::ShownGrey& image_of(editor::Context& c) {
  REQUIRE(c.views->image);
  return *c.views->image;
}

std::function<bool(Stage&, const Seen&)> has_window(double level, double width) {
  return [=](Stage& s, const Seen&) {
    const auto& image = s.editor().views->image;
    return image && image->level == level && image->width == width;
  };
}
std::function<bool(Stage&, const Seen&)> renders(render::GreyRendering rendering) {
  return [=](Stage& s, const Seen&) {
    return s.editor().views->display == render::Display::Image && image_of(s.editor()).rendering == rendering;
  };
}

// Adds a result that was made together with a posed image.
void add_posed_scan(Stage& stage) {
  Document next = stage.document();
  auto result = std::make_shared<Result>();
  result->name = "Posed";
  result->volume = std::make_shared<const LabelVolume>(*next.volume);
  next.results.push_back(result);
  stage.editor().history->commit("Result", next);
  keep_posed_image(*stage.editor().views, {.result = result->volume,
                                           .levels = image_of(stage.editor()).image,
                                           .folder = nullptr,
                                           .file = stage.home / "ct.nrrd"});
  stage.editor().project->path = stage.home / "limb.limber";
}

}  // namespace

std::vector<Proof> proofs_of_images() {
  using render::GreyRendering;
  const char* four = "key Ctrl+Alt+Q\n wait-idle";
  return {
      {.id = "file.import_image",
       .deeds = "click File/Import/Image...\n wait-idle\n type ct.nrrd\n key Return\n wait-job\n wait-idle",
       .effect = [](Stage& s, const Seen&) { return s.editor().views->image.has_value(); },
       .shows = Shows::InSlice,
       .first = four,
       .ready =
           [](Stage& s) {
             write_grey_volume(scan(), s.home / "ct.nrrd");
             s.editor().project->path = s.home / "limb.limber";
           }},
      {"image.window_bone", "click View/Display/\"Image settings\"/\"Bone window\"", has_window(480, 2500),
       Shows::InSlice, four},
      {"image.window_soft", "click View/Display/\"Image settings\"/\"Soft tissue window\"", has_window(40, 400),
       Shows::InSlice, four},
      {"image.window_lung", "click View/Display/\"Image settings\"/\"Lung window\"", has_window(-600, 1500),
       Shows::InSlice, four},
      {"image.window_brain", "click View/Display/\"Image settings\"/\"Brain window\"", has_window(40, 80),
       Shows::InSlice, four},
      {"image.window_all", "click View/Display/\"Image settings\"/\"All values\"",
       [](Stage& s, const Seen&) { return image_of(s.editor()).width > 1000; }, Shows::InSlice, four},
      {"image.drag_window", "drag Axial/view 40 -20 RMB Ctrl",
       [](Stage& s, const Seen&) {
         const render::ShownGrey& image = image_of(s.editor());
         return image.width > 450 && image.level > 45;
       },
       Shows::InSlice, "key Ctrl+Alt+Q\n wait-idle\n click View/Display/\"Image settings\"/\"Soft tissue window\""},
      {"view.image_display", "click View/Display/Image",
       [](Stage& s, const Seen&) { return s.editor().views->display == render::Display::Image; }, Shows::InBody,
       "click View/Display/Solid"},
      {"image.render_skin", "click View/Display/\"Image settings\"/\"Skin in 3D\"", renders(GreyRendering::Skin),
       Shows::InBody},
      {"image.render_muscle", "click View/Display/\"Image settings\"/\"Muscle in 3D\"", renders(GreyRendering::Muscle),
       Shows::InBody},
      {"image.render_bone", "click View/Display/\"Image settings\"/\"Bone in 3D\"", renders(GreyRendering::Bone),
       Shows::InBody},
      {"image.render_window", "click View/Display/\"Image settings\"/\"Window in 3D\"", renders(GreyRendering::Window),
       Shows::InBody},
      {"image.render_maximum", "click View/Display/\"Image settings\"/\"Maximum in 3D\"",
       renders(GreyRendering::Maximum), Shows::InBody},
      {"image.labels",
       "click View/Display/\"Image settings\"/\"Labels from CT...\"\n wait-idle\n click \"Make labels\"\n wait-job\n "
       "wait-idle",
       [](Stage& s, const Seen& b) {
         return s.document().volume != b.document.volume && s.document().tissues->find(6) &&
                s.document().tissues->find(6)->name == "Bone";
       },
       Shows::InBody},
      {"image.body",
       "click View/Display/\"Image settings\"/\"Labels from MR...\"\n wait-idle\n click \"Make labels\"\n wait-job\n "
       "wait-idle",
       [](Stage& s, const Seen&) {
         const auto& tissues = s.document().tissues->tissues;
         return tissues.size() == 2 && tissues[0].name == "Skin" && tissues[1].name == "Soft tissue";
       },
       Shows::InBody, "click View/Display/Image"},
      {"file.export_image", "click File/Export/\"Posed image...\"\n wait-idle\n type ct-posed\n key Return\n wait-job",
       [](Stage& s, const Seen&) {
         return std::filesystem::exists(s.home / "ct-posed.nrrd") &&
                read_grey_volume(s.home / "ct-posed.nrrd").voxels == scan().voxels;
       },
       Shows::Nothing, "", add_posed_scan},
      {"image.close", "click View/Display/\"Image settings\"/\"Close image\"",
       [](Stage& s, const Seen&) { return !s.editor().views->image; }, Shows::InSlice, four},
  };
}

TEST_CASE("operators: the grey image, its windows and its renderings") {
  Stage stage;
  prove(stage, proofs_of_images());
}

TEST_CASE("image: a bare CT is a picture at once, becomes labels on request, and undo and redo go between them") {
  const Scan files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"});
  sitting.play("wait-idle\n expect dialog no\n expect error none\n expect volume yes\n expect unsaved no");
  CHECK(image_of(sitting.editor()).level == 40);
  CHECK(sitting.editor().views->display == render::Display::Image);
  CHECK(sitting.editor().document().tissues->tissues.empty());
  const Document bare = sitting.editor().document();
  const auto why_no_rig = [&] {
    return disabled_reason(sitting.editor(), *find_operator(sitting.editor().operators, "rig.auto_fit"));
  };
  CHECK(why_no_rig().starts_with("The volume has no labels"));
  sitting.play("drag \"3D view/view\" 60 30 MMB\n wait-idle");
  const Views& views = *sitting.editor().views;
  const render::Camera seen_from = views.body.camera;
  const glm::dvec3 cross_hair = views.cross_hair;
  sitting.play(
      "expect \"text:No labels yet\"\n click Steps/Prepare/\"Labels from CT...\"\n wait-idle\n click \"Make labels\"\n "
      "wait-job\n wait-idle\n expect widget:Steps/Prepare/Statistics");
  sitting.play("expect error none\n expect unsaved yes");
  const Document labelled = sitting.editor().document();
  REQUIRE(labelled.tissues->find(6));
  CHECK(why_no_rig() == "");
  // The views stay where they are, because the labels lie on the image's own grid.
  CHECK(views.body.camera == seen_from);
  CHECK(views.cross_hair == cross_hair);
  CHECK(labelled.volume->grid == scan().grid);
  CHECK(labelled.volume->at({20, 20, 20}) == 6);
  CHECK(sitting.editor().views->image);
  sitting.play("key Ctrl+Z\n wait-idle");
  CHECK(sitting.editor().document() == bare);
  // Without labels, the 3D view shows the image. When redo brings the labels back, the view shows them solid again.
  CHECK(sitting.editor().views->scene.display == render::Display::Image);
  sitting.play("key Ctrl+Shift+Z\n wait-idle");
  CHECK(sitting.editor().document() == labelled);
  CHECK(sitting.editor().views->scene.display == render::Display::Solid);
}

TEST_CASE("image: in a bare CT a slice tells position, voxel and value, and is measured from point to point") {
  const Scan files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"}, {1280, 900});
  editor::Context& c = sitting.editor();
  sitting.play("wait-idle\n key Ctrl+Alt+Q\n wait-idle\n move Axial/view\n wait-idle");
  const editor::Hover& hover = c.views->hover;
  REQUIRE(hover.view == editor::ViewId::Axial);
  REQUIRE_FALSE(hover.inside);
  const auto value = editor::image_value_at_pointer(c.views);
  REQUIRE(value);
  const GreyVolume image = scan();
  const glm::ivec3 voxel(glm::floor(voxel_from_world(image.grid) * hover.point + 0.5));
  REQUIRE(image.grid.contains(voxel));
  CHECK(std::abs(*value - double(image.voxels[static_cast<std::size_t>(image.grid.index(voxel))])) < 0.05);
  CHECK(hover.voxel == voxel);
  char place[64];
  std::snprintf(place, sizeof place, "%.1f %.1f %.1f mm", hover.point.x, hover.point.y, hover.point.z);
  CHECK(sitting.test.fact("text:" + std::string(place)) == "shown");
  CHECK(sitting.test.fact("text:No label \u00b7 " + editor::text_of_image_value(c.views, *value)) == "shown");
  CHECK(sitting.test.fact("text:Outside") == "absent");

  sitting.play("click View/Overlays/Measure/\"Measure distance\"\n wait-idle\n move Axial/view\n wait-idle");
  const auto click = [&] {
    for (const bool down : {true, false}) {
      sitting.test.host->events.push(editor::ButtonChanged{editor::MouseButton::Left, down});
      sitting.test.player.settle();
    }
  };
  const glm::vec2 from = c.ui->input.pointer;
  const glm::dvec3 first = hover.point;
  click();
  sitting.play("move " + std::to_string(from.x + 30) + " " + std::to_string(from.y) + "\n wait-idle");
  const glm::dvec3 second = hover.point;
  click();
  sitting.play("key Escape\n wait-idle\n expect error none");
  REQUIRE(c.document().measurements);
  REQUIRE(c.document().measurements->size() == 1);
  const Measurement& one = c.document().measurements->front();
  CHECK(glm::distance(first, second) > 1);
  CHECK(measure(one.kind, one.points) == doctest::Approx(glm::distance(first, second)));

  sitting.play("click View/Overlays/Measure/\"Measure girth\"\n wait-idle\n move Axial/view\n wait-idle");
  click();
  sitting.play("wait-idle\n expect \"text:needs labels\" shown\n key Escape\n wait-idle");
  CHECK(c.document().measurements->size() == 1);
}

TEST_CASE("image: dragging the window of a CT leaves whole Hounsfield units, and loses no small movement") {
  const Scan files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"}, {1280, 900});
  editor::Context& c = sitting.editor();
  sitting.play("wait-idle\n key Ctrl+Alt+Q\n wait-idle\n move Axial/view\n wait-idle");
  editor::run(c, "image.drag_window");
  REQUIRE(c.interaction->drag);
  for (int i = 0; i < 40; ++i) c.interaction->drag->moved(c, {0.25f, 0.25f});
  const render::ShownGrey& image = image_of(c);
  CHECK(image.level == std::round(image.level));
  CHECK(image.width == std::round(image.width));
  // Forty steps of a quarter of a pixel are ten pixels. The width grows by e^(2/300) for each pixel.
  CHECK(image.width == std::round(400 * std::exp(20.0 / 300)));
  CHECK(image.level < 40 - 10);
  c.interaction->drag->cancelled(c);
  CHECK(image_of(c).width == 400);
  c.interaction->drag.reset();
}

TEST_CASE("image: a bare MR is offered a threshold of its own histogram, and keeps the tools that need no tissue") {
  const Home home;
  GreyVolume mr = scan();
  // The background has values from 0.5 to 16.5. Values with fractions cannot be labels.
  for (float& value : mr.voxels) value = value < -500 ? 1000.5f + value : 400.5f;
  mr.type = {"NRRD", "float", true};
  write_grey_volume(mr, home / "mr.nrrd");
  Sitting sitting(home.folder.path(), {home / "mr.nrrd"});
  sitting.editor().preferences->advanced_steps = true;
  sitting.play("wait-idle\n expect error none\n expect dialog no");
  for (const char* tool : {"labels.new_tissue", "prepare.regrid", "prepare.pad", "prepare.orient"})
    CHECK_MESSAGE(sitting.test.fact(std::string("widget:Steps/Prepare more/") + tool) == "shown", tool);
  CHECK(sitting.test.fact("widget:Steps/Prepare more/prepare.merge") != "shown");
  sitting.play("click Steps/Prepare/\"Labels from MR...\"\n wait-idle\n expect \"text:Labels from MR\"");
  CHECK(sitting.test.fact("text:Bone threshold") != "shown");
  sitting.play("click \"Make labels\"\n wait-job\n wait-idle\n expect error none");
  const Document& labelled = sitting.editor().document();
  REQUIRE(labelled.tissues->tissues.size() == 2);
  CHECK(labelled.volume->at({20, 20, 20}) != 0);
  CHECK(labelled.volume->at({1, 1, 1}) == 0);
}

TEST_CASE("image: a CT of the open body is shown with it, and one of elsewhere is refused in a sentence") {
  const Scan files;
  Sitting sitting(files.folder.path());
  sitting.open_ball();
  const Document before = sitting.editor().document();
  editor::open_files(sitting.editor(), {files / "ct.nrrd"});
  sitting.play("wait-job\n wait-job\n wait-idle\n expect error none\n expect dialog no");
  CHECK(sitting.editor().document() == before);
  CHECK(image_of(sitting.editor()).image->grid == scan().grid);
  GreyVolume far = scan();
  far.grid.origin.x += 500;
  write_grey_volume(far, files / "far.nrrd");
  editor::open_image(sitting.editor(), files / "far.nrrd");
  sitting.play("wait-job\n wait-idle");
  CHECK(sitting.test.fact("error").find("mm away from the open body") != std::string::npos);
  CHECK(sitting.editor().views->image_path.filename() == "ct.nrrd");
}

TEST_CASE("image: resampling poses it, to the voxel as the command line does, and the result shows and exports it") {
  const Home home;
  const auto at = [&](const char* name) { return (home / name).string(); };
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "6", "-o", at("arm")}).exit_code == 0);
  const LabelVolume volume = read_volume(home / "arm/volume.nrrd").volume;
  GreyVolume image;
  image.grid = volume.grid;
  image.type = {"NRRD", "int16", true};
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    image.voxels.push_back(volume.voxels[i] ? static_cast<float>(40 + volume.voxels[i] * 30 + i % 7) : -1000.0f);
  write_grey_volume(image, home / "ct.nrrd");
  REQUIRE(run_limber({"weights", at("arm/volume.nrrd"), "--tissues", at("arm/tissues.json"), "--rig",
                      at("arm/rig.json"), "-o", at("w.nrrd")})
              .exit_code == 0);

  Sitting sitting(home.folder.path(),
                  {home / "arm/volume.nrrd", home / "arm/tissues.json", home / "arm/rig.json", home / "w.nrrd"});
  editor::Context& c = sitting.editor();
  c.background->worker_program = LIMBER_PROGRAM;
  c.background->workers_yield = false;
  sitting.play("wait-job\n wait-job\n wait-job\n wait-job\n wait-idle\n expect error none");
  editor::open_image(c, home / "ct.nrrd");
  sitting.play("wait-job\n wait-idle\n expect error none");
  Document bent = c.document();
  Pose pose = rest_pose(*bent.armature);
  flex(pose, *bent.armature, require_bone(*bent.armature, "Forearm"), 70);
  bent.pose = std::make_shared<const Pose>(pose);
  commit(c, "Bend", std::move(bent));
  c.resampling->method = "dqs";
  editor::start_resampling(c);
  sitting.play("key Ctrl+4\n wait-job\n wait-idle\n expect error none");
  REQUIRE(c.document().results.size() == 1);
  const auto result = c.document().results.back();
  const editor::PosedImage* kept = editor::posed_image_of(*c.views, result->volume);
  REQUIRE(kept);
  editor::export_posed_image(c, result, home / "from-editor.nrrd");
  sitting.play("wait-job\n wait-idle\n expect error none");

  write_pose(pose, *c.document().armature, home / "pose.json");
  REQUIRE(run_limber({"resample", at("arm/volume.nrrd"), "--tissues", at("arm/tissues.json"), "--rig",
                      at("arm/rig.json"), "--weights", at("w.nrrd"), "--pose", at("pose.json"), "--method", "dqs",
                      "--with", at("ct.nrrd") + "=" + at("from-command.nrrd"), "-o", at("posed.nrrd")})
              .exit_code == 0);
  const GreyVolume ours = read_grey_volume(home / "from-editor.nrrd"),
                   theirs = read_grey_volume(home / "from-command.nrrd");
  CHECK(ours.grid == theirs.grid);
  CHECK(ours.voxels == theirs.voxels);
  CHECK(kept->levels->grid == theirs.grid);

  // For a result with a posed image the views show that image. For a result without one they show none.
  c.comparison->b = result->name;
  sitting.play("key 2\n wait-idle");
  REQUIRE(c.views->scene.volume == result->volume);
  REQUIRE(c.views->scene.grey);
  CHECK(c.views->scene.grey->image == kept->levels);
  c.views->posed_images.clear();
  c.ui->touch();
  sitting.play("wait-idle");
  CHECK_FALSE(c.views->scene.grey);
}

TEST_CASE("image: importing one asks before unsaved work on an empty body is replaced") {
  const Scan files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"});
  sitting.play("wait-idle");
  Document next = sitting.editor().document();
  next.armature = small_limb().armature;
  commit(sitting.editor(), "Rig", next);
  editor::open_image(sitting.editor(), files / "ct.nrrd");
  sitting.play("wait-job\n wait-idle\n expect dialog yes");
  CHECK(sitting.editor().document() == next);
  sitting.play("click Cancel\n wait-idle\n expect dialog no");
  CHECK(sitting.editor().document() == next);
}

TEST_CASE("image: its form says so when the image is closed under it, and another body is not replaced by labels") {
  const Scan files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"});
  const char* form = "click View/Display/\"Image settings\"/\"Labels from CT...\"\n wait-idle\n expect dialog yes";
  sitting.play(form);
  const auto image = sitting.editor().views->image;
  editor::close_image(sitting.editor());
  sitting.play("wait-idle\n expect dialog yes\n key Escape\n wait-idle");
  sitting.editor().views->image = image;
  sitting.play(form);
  sitting.editor().jobs->set_at_once(0);  // the job runs only after the other body is open
  sitting.play("click \"Make labels\"");
  const Document other = small_body();
  sitting.editor().history->reset(other, "Open ball");
  sitting.editor().jobs->set_at_once(2);
  sitting.play("wait-job\n wait-idle");
  CHECK(sitting.editor().document() == other);
}

TEST_CASE("image: the value under the pointer is that of the image") {
  const Scan files;
  Sitting sitting(files.folder.path(), {files / "ct.nrrd"});
  sitting.play("wait-idle");
  const GreyVolume image = scan();
  const glm::ivec3 voxel(20, 21, 22);
  const auto value = editor::image_value_at(
      *image_of(sitting.editor()).image, world_from_voxel(image.grid) * (glm::dvec3(voxel) + glm::dvec3(0.3, -0.3, 0)));
  REQUIRE(value);
  CHECK(std::abs(*value - double(image.voxels[static_cast<std::size_t>(image.grid.index(voxel))])) < 0.05);
  CHECK_FALSE(editor::image_value_at(*image_of(sitting.editor()).image, {500, 0, 0}));
}

TEST_CASE("image: a project shows its image again, from beside the project too, and says when it is gone") {
  const Scan files;
  const Path project = files / "limb.limber";
  {
    Sitting sitting(files.folder.path());
    sitting.open_ball();
    editor::open_image(sitting.editor(), files / "ct.nrrd");
    sitting.play("wait-job\n wait-idle\n click View/Display/\"Image settings\"/\"Bone window\"\n wait-idle");
    sitting.editor().views->image->tissues = 0.7f;
    editor::save_project_as(sitting.editor(), project);
    sitting.play("wait-job\n wait-idle");
  }
  const auto reopened = [&] {
    auto sitting = std::make_unique<Sitting>(files.folder.path(), std::vector<Path>{project});
    sitting->play("wait-job\n wait-job\n wait-idle\n expect dialog no\n expect error none");
    return sitting;
  };
  {
    const auto sitting = reopened();
    CHECK(image_of(sitting->editor()).level == 480);
    CHECK(image_of(sitting->editor()).tissues == doctest::Approx(0.7f));
    CHECK(sitting->test.fact("unsaved") == "no");
  }
  std::filesystem::create_directories(files / "moved");
  for (const char* name : {"ct.nrrd", "limb.limber"}) std::filesystem::rename(files / name, files / "moved" / name);
  {
    Sitting sitting(files.folder.path(), {files / "moved/limb.limber"});
    sitting.play("wait-job\n wait-job\n wait-idle\n expect error none");
    CHECK(sitting.editor().views->image_path == files / "moved/ct.nrrd");
  }
  std::filesystem::remove(files / "moved/ct.nrrd");
  {
    Sitting sitting(files.folder.path(), {files / "moved/limb.limber"});
    sitting.play("wait-job\n wait-job\n wait-idle\n expect error none");
    CHECK_FALSE(sitting.editor().views->image);
    CHECK(sitting.test.fact("text:The image of this project is not shown: ct.nrrd") == "shown");
    // If the project is saved while its image is not shown, it still refers to the image.
    editor::save_project(sitting.editor());
    sitting.play("wait-job\n wait-idle");
  }
  write_grey_volume(scan(), files / "moved/ct.nrrd");
  {
    Sitting sitting(files.folder.path(), {files / "moved/limb.limber"});
    sitting.play("wait-job\n wait-job\n wait-idle\n expect error none");
    CHECK(sitting.editor().views->image);
  }
}

}  // namespace limber::test
