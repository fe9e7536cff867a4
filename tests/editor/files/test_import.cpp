// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/files/import.h"

#include <fstream>

#include "core/autorig/rig_check.h"
#include "core/base/error.h"
#include "core/motion/motion_edit.h"
#include "core/motion/up_axis.h"
#include "core/pose/pose_io.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weights_io.h"
#include "tests/editor/sitting.h"
#include "tests/support/bent_tube.h"
#include "tests/support/walker.h"

using namespace limber;
using namespace limber::test;
using editor::FileKind;

namespace {

// The files of a tube: volume, tissues, rig, weights and motion.
struct TubeFiles : Home {
  TubeFiles() : tube(bent_tube()) {
    for (Tissue& tissue : tube.tissues.tissues) tissue.file_value = tissue.label;
    write_volume(tube.volume, *this / "tube.nrrd", tube.tissues);
    write_armature(tube.rig, *this / "rig.json");
    write_weights(tube.weights, tube.volume, TissueVoxels(tube.volume), *this / "weights.nrrd");
    write_pose(tube.pose(60), tube.rig, *this / "pose.json");
    write_tissue_table(tube.tissues, *this / "tissues.json");
    write_bvh(motion_of_poses(tube.rig, 1, 30, [&](int) { return rest_pose(tube.rig); }), *this / "motion.bvh");
  }
  BentTube tube;
};

}  // namespace

TEST_CASE("opening: files are told apart by what they hold") {
  const TubeFiles files;
  CHECK(editor::kind_of(files / "tube.nrrd") == FileKind::Volume);
  CHECK(editor::kind_of(files / "weights.nrrd") == FileKind::Weights);
  CHECK(editor::kind_of(files / "rig.json") == FileKind::Rig);
  CHECK(editor::kind_of(files / "pose.json") == FileKind::Pose);
  CHECK(editor::kind_of(files / "tissues.json") == FileKind::Tissues);
  CHECK(editor::kind_of(files / "motion.bvh") == FileKind::Motion);
  std::ofstream(files / "odd.json") << "[1, 2]";
  std::ofstream(files / "odd.limber") << "no database";
  for (const char* name : {"odd.json", "odd.limber", "missing", "scans"})
    CHECK_THROWS_AS(editor::kind_of(files / name), Error);
}

TEST_CASE("opening: a dropped motion whose z axis points up is turned upright and says so, the dialog opens with z") {
  const TubeFiles files;
  const Motion y_up = t_pose_body({{0, 0, 0}, {20, 5, 1}});
  write_bvh(y_up_from_z_up(y_up_from_z_up(y_up_from_z_up(y_up))), files / "z.bvh");
  Sitting sitting(files.folder.path());
  sitting.open_ball();
  const auto stands = [&] { return up_axis_of(*sitting.editor().document().shown_clip()->motion).axis == UpAxis::Y; };
  sitting.play("drop " + (files / "z.bvh").string() + "\n wait-job\n wait-idle");
  REQUIRE(sitting.editor().document().clips.size() == 1);
  CHECK(stands());
  CHECK(sitting.editor().messages->log.back().text.find("turned upright") != std::string::npos);

  sitting.play("click File/Import/Motion...\n wait-idle\n type " + (files / "z.bvh").string() +
               "\n key Return\n wait-job\n wait-idle\n expect dialog yes\n key Return\n wait-idle");
  REQUIRE(sitting.editor().document().clips.size() == 2);
  CHECK(stands());
  CHECK(sitting.editor().messages->log.back().text.starts_with("z.bvh is turned upright"));
}

TEST_CASE("opening: a volume and what belongs to it come in together, dropped in any order") {
  const TubeFiles files;
  Sitting sitting(files.folder.path());
  sitting.test.host->events.push(editor::FilesDropped{
      {files / "weights.nrrd", files / "pose.json", files / "motion.bvh", files / "rig.json", files / "tube.nrrd"}});
  sitting.play("wait-job\n wait-job\n expect volume yes\n expect error none");
  const Document& document = sitting.editor().document();
  REQUIRE(document.weights);
  CHECK(document.weights->size() == files.tube.weights.size());
  CHECK(document.armature->bones.size() == 2);
  CHECK(document.pose->rotation.size() == 2);
  CHECK(document.shown_clip()->motion->joints.size() == 2);
  sitting.play("key Ctrl+Z\n key Ctrl+Z\n key Ctrl+Z\n key Ctrl+Z\n expect volume yes");
  CHECK_FALSE(sitting.editor().document().armature);
}

TEST_CASE("opening: what does not fit the open volume is refused in one message and changes nothing") {
  const TubeFiles files;
  Sitting sitting(files.folder.path(), {files / "scans/ball.nrrd"});
  for (const auto& [file, kind] : {std::pair{"weights.nrrd", FileKind::Weights},
                                   {"pose.json", FileKind::Pose},
                                   {"tissues.json", FileKind::Tissues}}) {
    INFO(std::string(file));
    const Document before = sitting.editor().document();
    import_file(sitting.editor(), kind, files / file);
    sitting.play("wait-job");
    CHECK(sitting.editor().messages->errors.size() == 1);
    CHECK(sitting.editor().document() == before);
    sitting.play("key Escape");
  }
}

TEST_CASE("opening: a rig that does not lie in the body comes in with the offer to fit or to place it") {
  const TubeFiles files;
  Armature far = files.tube.rig;
  for (Bone& bone : far.bones)
    bone.head = 0.001 * bone.head + glm::dvec3(5), bone.tail = 0.001 * bone.tail + glm::dvec3(5);
  write_armature(far, files / "far.json");
  Sitting sitting(files.folder.path(), {files / "tube.nrrd"});
  const auto inside = [&] {
    return check_rig(*sitting.editor().document().volume, *sitting.editor().document().armature).whole;
  };
  import_file(sitting.editor(), FileKind::Rig, files / "rig.json");
  sitting.play("wait-job\n wait-idle\n expect dialog no");
  CHECK(inside() > 0.9);
  for (const char* answer : {"Keep rig", "Only position and scale", "Fit rig"}) {
    INFO(answer);
    far.bones[0].head.x += 1e-3;
    write_armature(far, files / "far.json");
    import_file(sitting.editor(), FileKind::Rig, files / "far.json");
    sitting.play("wait-job\n wait-idle\n expect dialog yes\n click \"" + std::string(answer) +
                 "\"\n wait-job\n wait-idle\n expect dialog no\n expect error none");
    CHECK((inside() > 0.6) == (std::string(answer) != "Keep rig"));
  }
  sitting.play(
      "expect toast \"Rig positioned, but every joint is uncertain\"\n key Ctrl+Z\n expect edit \"Import "
      "far.json\"");
}

TEST_CASE("opening: a damaged file is one error message, and the open project stays as it is") {
  const TubeFiles files;
  std::ofstream(files / "short.nrrd") << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 90 90 90\nencoding: raw\n\nabc";
  Sitting sitting(files.folder.path(), {files / "scans/ball.nrrd"});
  const std::string hash = sitting.test.fact("document");
  editor::open_files(sitting.editor(), {files / "short.nrrd"});
  sitting.play("wait-job\n expect name ball\n expect position 0\n expect unsaved no");
  CHECK(sitting.editor().messages->errors.size() == 1);
  CHECK(sitting.test.fact("document") == hash);
}

TEST_CASE("import and export: each kind of file goes out through its menu and comes back the same") {
  const TubeFiles files;
  Document before;
  {
    Sitting sitting(files.folder.path(), {files / "tube.nrrd", files / "rig.json", files / "weights.nrrd",
                                          files / "pose.json", files / "motion.bvh"});
    sitting.play("wait-job");
    before = sitting.editor().document();
    REQUIRE(before.weights);
    for (const char* kind : {"volume", "rig", "weights", "pose", "motion", "tissues"}) {
      const std::string name = std::string("out-") + kind;
      editor::run(sitting.editor(), std::string("file.export_") + kind);
      sitting.play("expect dialog yes\n type " + name +
                   "\n key Return\n wait-job\n expect dialog no\n expect error none");
    }
  }
  Sitting again(files.folder.path(), {files / "out-volume.nrrd"});
  for (const char* name : {"out-rig.json", "out-weights.nrrd", "out-motion.bvh", "out-pose.json", "out-tissues.json"}) {
    INFO(name);
    editor::open_files(again.editor(), {files / name});
    again.play("wait-job\n expect error none");
  }
  const Document& after = again.editor().document();
  CHECK(after.volume->voxels == before.volume->voxels);
  CHECK(*after.weights == *before.weights);
  CHECK(*after.pose == *before.pose);
  CHECK(after.armature->bones.size() == before.armature->bones.size());
  CHECK(after.shown_clip()->motion->joints == before.shown_clip()->motion->joints);
}

TEST_CASE("export: what the project was read from is not written over, by whatever name") {
  const TubeFiles files;
  std::filesystem::create_symlink("tube.nrrd", files / "link.nrrd");
  Sitting sitting(files.folder.path(), {files / "tube.nrrd", files / "rig.json", files / "weights.nrrd",
                                        files / "pose.json", files / "motion.bvh"});
  sitting.play("wait-job");
  import_file(sitting.editor(), FileKind::Tissues, files / "tissues.json");
  sitting.play("wait-job\n expect error none");
  const auto contents = [&] { return sha256_of_file(files.folder.path()); };
  const std::string before = contents();
  for (const auto& [kind, name] : {std::pair{"volume", "tube.nrrd"},
                                   {"volume", "link.nrrd"},
                                   {"rig", "rig.json"},
                                   {"weights", "weights.nrrd"},
                                   {"pose", "pose.json"},
                                   {"motion", "motion.bvh"},
                                   {"tissues", "tissues.json"},
                                   {"pose", "rig.json"}}) {
    INFO(std::string(name));
    sitting.editor().messages->toasts.clear();
    editor::run(sitting.editor(), std::string("file.export_") + kind);
    sitting.play(
        "expect dialog yes\n type " + std::string(name) +
        "\n key Return\n wait-job\n expect dialog yes\n expect toast \"The output is also an input\"\n key Escape");
    CHECK(contents() == before);
  }
  editor::run(sitting.editor(), "file.export_rig");
  sitting.play("type own.json\n key Return\n wait-job\n expect dialog no\n expect error none");
  CHECK(std::filesystem::exists(files / "own.json"));
}

TEST_CASE("export: a project that is opened in another's place was read from other files") {
  const TubeFiles files;
  Sitting sitting(files.folder.path(), {files / "tube.nrrd"});
  CHECK_FALSE(sitting.editor().project->inputs.empty());
  sitting.open_ball();
  CHECK(sitting.editor().project->inputs.empty());
}

TEST_CASE("export: the view is written as a picture, and turned all around without holding up the editor") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play("key F12\n type view\n key Return\n wait-job\n expect error none");
  const render::Image picture = render::read_png(home / "view.png");
  CHECK(picture.size == glm::ivec2(sitting.editor().screen->layout.place_of(editor::ViewId::Body)->size()));
  sitting.play("key Ctrl+F12\n type turn\n key Return\n wait-job\n expect error none");
  for (const char* name : {"turn-0000.png", "turn-0035.png"}) CHECK(std::filesystem::exists(home / name));
  CHECK(render::read_png(home / "turn-0000.png").rgba == picture.rgba);
  CHECK(render::read_png(home / "turn-0009.png").rgba != picture.rgba);
}
