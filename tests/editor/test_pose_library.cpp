// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose_library.h"

#include "core/project/project_io.h"
#include "editor/posing.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {
double bend_of_fore(const Pose& pose) { return glm::degrees(2 * std::atan2(glm::length(glm::dvec3(pose.rotation[1].x, pose.rotation[1].y, pose.rotation[1].z)), std::abs(pose.rotation[1].w))); }

// A library with a forearm bent by 40 degrees; the body is at rest again.
void fill_library(Stage& s) {
  s.editor().selection.bone = 1;
  s.editor().selection.bones = {1};
  s.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle\n key R\n key X\n key 4\n key 0\n key Return");
  run(s.editor(), "pose.library_add");
  s.play("key Alt+R\n wait-idle");
  REQUIRE(bend_of_fore(pose_of(s.document())) < 1e-9);
}
}  // namespace

TEST_CASE("pose library: a card applies its pose by a click and a part of it by a drag, each one edit, Escape leaves the pose") {
  Stage s;
  fill_library(s);
  const auto edits = s.editor().history.position();
  s.play("click \"Pose library/Pose\"\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) == doctest::Approx(40));
  CHECK(s.editor().history.position() == edits + 1);
  s.play("key Ctrl+Z\n wait-idle\n drag \"Pose library/Pose\" 50 0\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) == doctest::Approx(10).epsilon(0.03));
  CHECK(s.editor().history.position() == edits + 1);
  s.play("key Ctrl+Z\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) < 1e-9);

  s.play("press \"Pose library/Pose\"\n move \"3D view/view\"\n wait 0.1");
  CHECK(s.editor().views->preview_pose);
  s.play("key Escape\n release\n wait-idle");
  CHECK_FALSE(s.editor().views->preview_pose);
  CHECK(s.editor().history.position() == edits);

  // Only the chosen bones.
  s.editor().selection.bone = 0;
  s.editor().selection.bones = {0};
  s.play("click \"Pose library/Pose\"\n wait-idle");
  CHECK(bend_of_fore(pose_of(s.document())) < 1e-9);
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
