// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/bone_table.h"

#include "core/project/bone_names.h"
#include "core/project/project_io.h"
#include "tests/editor/glued_editor.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

namespace {

void map_once(Stage& s) {
  map_label(s.editor(), 111, {}, 1);
  s.play("wait-idle");
}

// Returns the share of a bone in the weights of a label's voxels.
double share(const Document& document, Label label, const std::string& bone) {
  const TissueVoxels tissue(*document.volume);
  const auto& names = document.weights->bones();
  const int wanted = static_cast<int>(std::find(names.begin(), names.end(), bone) - names.begin());
  double sum = 0, voxels = 0;
  for (std::int64_t brick = 0; brick < document.weights->chunk_count(); ++brick)
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
      if (document.volume->at(voxel) != label) return;
      ++voxels;
      sum += document.weights->chunk(brick)[place - tissue.bricks()[brick].first].of(wanted);
    });
  return sum / voxels;
}

}  // namespace

std::vector<Proof> proofs_of_bone_table() {
  return {
      {"rig.colour_bones", "click \"Edit/Rig/Colour by rig bone\"\n wait-job\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().bone_table->coloured; }, Shows::InBody, "key Ctrl+1\n wait-idle"},
      {"rig.clear_bone_map", "click \"Edit/Rig/Clear bone map\"\n wait-idle",
       [](Stage& s, const Seen&) { return !s.document().bone_map; }, Shows::Nothing, "", map_once},
  };
}

TEST_CASE("operators: bones are coloured by the rig's, and the bone map is cleared") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_bone_table());
}

TEST_CASE(
    "bone table: it lists every label of bone, how its bone was found, and gives it another by one choice that can be "
    "undone") {
  GluedEditor test;
  test.play("key Ctrl+1\nwait-idle\nkey N\nwait-idle");
  test.open_only("Bone map");
  test.play("wait-job\nwait-idle");
  const BoneTable::Known* known = bone_table(*test.editor);
  REQUIRE(known);
  REQUIRE(known->rows.size() == 3);
  CHECK(test.fact("text:Left humerus") == "shown");
  CHECK(test.fact("text:Name") == "shown");
  CHECK(known->rows[1].label == GluedArm::kHumerus);
  CHECK(known->rows[1].bones == std::vector<int>{1});

  map_label(*test.editor, GluedArm::kHumerus, {}, 2);
  test.play("wait-job\nwait-idle");
  CHECK(test.last_edit() == "Left humerus follows LeftForearm");
  known = bone_table(*test.editor);
  REQUIRE(known);
  CHECK(known->rows[1].bones == std::vector<int>{2});
  CHECK(known->rows[1].found_by == FoundBy::Map);
  CHECK(test.fact("text:Bone map") == "shown");
  const Path path = test.folder.path() / "kept.limber";
  DocumentWriter writer;
  create_project({.document = test.editor->document()}, path, writer);
  CHECK(*read_project(path).document.bone_map == BoneMap{{"4", "LeftForearm"}});

  // New weights are computed with the bone map.
  test.play("key Ctrl+2\nclick \"Edit/Weights/Heat diffusion\"\nwait-job\nwait-idle");
  CHECK(share(test.editor->document(), GluedArm::kHumerus, "LeftForearm") == doctest::Approx(1));
  test.play("key Ctrl+Z\nkey Ctrl+Z\nwait-idle");
  CHECK_FALSE(test.editor->document().bone_map);
  test.play("click \"Edit/Weights/Heat diffusion\"\nwait-job\nwait-idle");
  CHECK(share(test.editor->document(), GluedArm::kHumerus, "LeftUpperArm") == doctest::Approx(1));
}

TEST_CASE("bone table: the box of choices maps a label, and a bone that gets another name keeps its labels") {
  GluedEditor test;
  test.play("key Ctrl+1\nwait-idle\nkey N\nwait-idle");
  test.open_only("Bone map");
  test.play(
      "wait-job\nwait-idle\nclick \"sidebar/sections/Bone map/Left ulna/list\"\nwait-idle\nclick "
      "\"sidebar/sections/Bone map/Left ulna/Spine\"\nwait-job\nwait-idle");
  REQUIRE(test.editor->document().bone_map);
  CHECK(*test.editor->document().bone_map == BoneMap{{"5", "Spine"}});
  const auto renamed = [&](const std::string& to) {
    Document next = test.editor->document();
    Armature rig = *next.armature;
    rig.bones[0].name = to;
    follow_names(next, *next.armature, rig);
    return *next.bone_map;
  };
  CHECK(renamed("Back") == BoneMap{{"5", "Back"}});
  // A map that names a missing bone is not used, and a message says so.
  Document next = test.editor->document();
  next.bone_map = std::make_shared<const BoneMap>(BoneMap{{"5", "Tail"}, {"4", "Spine"}});
  test.editor->history->commit("Wrong map", next);
  test.play("wait-job\nwait-idle");
  CHECK(test.fact("text:1 entry names no tissue or bone") == "shown");
  CHECK(bone_table(*test.editor)->rows[1].bones == std::vector<int>{0});
}

}  // namespace limber::test
