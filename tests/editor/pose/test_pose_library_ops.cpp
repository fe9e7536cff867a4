// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/pose_library.h"
#include "editor/ui/ui.h"

#include "core/pose/body_poses.h"
#include "core/project/project_io.h"
#include "editor/context/transform_settings.h"
#include "editor/pose/body_pose_cards.h"
#include "editor/pose/pose_edits.h"
#include "editor/volume/body_picture.h"
#include "tests/editor/operator_proofs.h"
#include "tests/support/body_rig.h"

namespace limber::test {

using namespace editor;

namespace {
double bend_of_fore(const Pose& pose) {
  return glm::degrees(2 *
                      std::atan2(glm::length(glm::dvec3(pose.rotation[1].x, pose.rotation[1].y, pose.rotation[1].z)),
                                 std::abs(pose.rotation[1].w)));
}

// Makes a library with a pose whose forearm is bent by 40 degrees. The body is back at rest.
void fill_library(Stage& s) {
  s.editor().selection->bone = 1;
  s.editor().selection->bones = {1};
  s.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle\n key R\n key X\n key 4\n key 0\n key Return");
  run(s.editor(), "pose.library_add");
  s.play("key Alt+R\n wait-idle");
  REQUIRE(bend_of_fore(pose_of(s.document())) < 1e-9);
}
}  // namespace

TEST_CASE(
    "pose library: a card applies its pose by a click and a part of it by a drag, each one edit, Escape leaves the "
    "pose") {
  Stage s;
  fill_library(s);
  const auto edits = s.editor().history->position();
  s.play("click \"Pose library/Pose\"\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) == doctest::Approx(40));
  CHECK(s.editor().history->position() == edits + 1);
  s.play("key Ctrl+Z\n wait-idle\n drag \"Pose library/Pose\" 50 0\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) == doctest::Approx(10).epsilon(0.03));
  CHECK(s.editor().history->position() == edits + 1);
  s.play("key Ctrl+Z\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) < 1e-9);

  s.play("press \"Pose library/Pose\"\n move \"3D view/view\"\n wait 0.1");
  CHECK(s.editor().views->preview_pose);
  s.play("key Escape\n release\n wait-idle");
  CHECK_FALSE(s.editor().views->preview_pose);
  CHECK(s.editor().history->position() == edits);

  // A pose is applied to the selected bones only.
  s.editor().selection->bone = 0;
  s.editor().selection->bones = {0};
  s.play("click \"Pose library/Pose\"\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) < 1e-9);
}

TEST_CASE(
    "pose library: a rig whose bones are known has the poses of any body, with pictures, a click seats it, and they "
    "are nobody's to delete") {
  Stage s;
  CHECK(body_pose_cards(s.editor()).empty());
  Document next = s.document();
  next.armature = std::make_shared<const Armature>(body_rig());
  next.weights.reset();
  next.pose.reset();
  commit(s.editor(), "Import rig", std::move(next));
  s.editor().selection->bones.clear();
  s.editor().ui->open_sections["Pose library"] = true;
  s.play("key Ctrl+3\n wait-idle");
  const PoseLibrary& cards = body_pose_cards(s.editor());
  REQUIRE(cards.size() == body_poses().size());
  for (const auto& card : cards) CHECK(card->picture.size() > 500);
  CHECK(cards[0]->picture != cards[1]->picture);
  CHECK(s.document().poses.empty());

  const auto edits = s.editor().history->position();
  s.play("click \"Pose library/Body pose sit\"\n wait-idle");
  CHECK(s.editor().history->position() == edits + 1);
  std::vector<std::string> warnings;
  const Armature& rig = *s.document().armature;
  CHECK(pose_of(s.document()) == with_request(rig, rest_pose(rig), {"sit", {}}, warnings));
  CHECK(find_operator(s.editor().operators, "pose.library_delete")->disabled_reason(s.editor()) ==
        "This pose is built in and cannot be changed");
  CHECK(find_operator(s.editor().operators, "pose.library_apply")->disabled_reason(s.editor()).empty());

  // A pose of the user with the same name is kept apart from the built-in one.
  run(s.editor(), "pose.library_add");
  Document named = s.document();
  NamedPose own = *named.poses[0];
  own.name = "sit";
  own.rotation.clear();
  named.poses[0] = std::make_shared<const NamedPose>(own);
  commit(s.editor(), "Rename", std::move(named));
  s.editor().transform_settings->library_pose = "sit";
  CHECK(chosen_pose(s.editor())->rotation.empty());
}

TEST_CASE("pose library: the picture of a pose shows the body where it is, and nothing around it") {
  const Armature rig = body_rig();
  std::vector<std::string> warnings;
  const glm::ivec2 size(120, 80);
  const auto columns = [&](const std::string& pose) {
    const render::Image image = body_picture(rig, with_request(rig, rest_pose(rig), {pose, {}}, warnings), size);
    int columns = 0;
    for (int x = 0; x < size.x; ++x) {
      bool covered = false;
      for (int y = 0; y < size.y; ++y)
        covered = covered || image.rgba[4 * static_cast<std::size_t>(y * size.x + x) + 3] > 0;
      columns += covered;
    }
    return columns;
  };
  CHECK(columns("stand") > 8);
  CHECK(columns("stand") < 40);
  CHECK(columns("T") > 2 * columns("stand"));
}

TEST_CASE("pose library: it goes into the project with its pictures and comes back the same") {
  Stage s;
  fill_library(s);
  REQUIRE(s.document().poses.size() == 1);
  CHECK(s.document().poses[0]->picture.size() > 100);
  DocumentWriter writer;
  const Path path = s.home / "poses.limber";
  create_project({.document = s.document()}, path, writer);
  const Document back = read_project(path).document;
  REQUIRE(back.poses.size() == 1);
  CHECK(*back.poses[0] == *s.document().poses[0]);
  s.play("key Ctrl+Z\n key Ctrl+Z\n wait-idle");
  CHECK(s.document().poses.empty());
}

}  // namespace limber::test
