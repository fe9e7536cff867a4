// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/weight_problems.h"

#include "tests/editor/operator_proofs.h"
#include "tests/editor/paint_editor.h"

namespace limber::test {

using namespace editor;

namespace {

// Returns weights of two halves with a sharp border, and an island of the lower bone in the upper half.
std::shared_ptr<const SkinWeights> bad_weights(const LabelVolume& volume) {
  SkinWeights weights = *half_weights(volume);
  const TissueVoxels tissue(volume);
  const AffineTransform world = world_from_voxel(volume.grid);
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
    SkinWeights::Influences chunk = weights.chunk(b);
    tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
      if (glm::distance(world * glm::dvec3(voxel), glm::dvec3(0, -30, 20)) < 8)
        chunk[place - tissue.bricks()[b].first] = rigid_influence(1);
    });
    weights.set_chunk(b, chunk);
  }
  return std::make_shared<const SkinWeights>(weights);
}

void weigh(Stage& s) {
  Document next = s.document();
  next.weights = bad_weights(*next.volume);
  s.editor().history->commit("Weigh", next);
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

int at(Stage& s) { return s.editor().skin->painting->problem; }

}  // namespace

std::vector<Proof> proofs_of_weight_problems() {
  return {
      {"skin.find_problems", "click \"Edit weights/Problems/Find problems\"\n wait-job\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().skin->painting->problems != nullptr; }, Shows::Nothing, "", weigh},
      {"skin.next_problem", "key J\n wait-idle", [](Stage& s, const Seen&) { return at(s) == 0; }},
      {"skin.previous_problem", "key Shift+J\n wait-idle",
       [](Stage& s, const Seen&) {
         return at(s) == static_cast<int>(s.editor().skin->painting->problems->problems.size()) - 1;
       }},
      {"skin.repair_problem", "click \"Edit weights/Problems/Repair problem\"\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) { return static_cast<int>(s.editor().history->position()) == b.position + 1; },
       Shows::Nothing, "move \"3D view/view\"\n key J\n wait-idle"},
  };
}

TEST_CASE("weight problems: a step says which problem the views show, in the place of the one before") {
  Stage stage;
  stage.open_limb();
  weigh(stage);
  stage.play("click \"Edit weights/Problems/Find problems\"\n wait-job\n wait-idle\n move \"3D view/view\"\n key J");
  const auto& problems = stage.editor().skin->painting->problems->problems;
  REQUIRE(problems.size() >= 2);
  const std::string of = " of " + std::to_string(problems.size());
  const auto said = [&](const std::string& line) {
    const auto& toasts = stage.editor().messages->toasts;
    return std::count_if(toasts.begin(), toasts.end(), [&](const Toast& toast) { return toast.line == line; });
  };
  CHECK(said("Problem 1" + of) == 1);
  CHECK(stage.editor().messages->toasts.back().detail == describe(problems[0], *stage.document().armature));
  stage.play("key J\n wait-idle");
  CHECK(said("Problem 1" + of) == 0);
  CHECK(said("Problem 2" + of) == 1);
}

TEST_CASE("operators: what is wrong with weights is found and repaired") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_weight_problems());
}

TEST_CASE(
    "problems: they are listed with counts, a click goes there and chooses the bone, one more repairs, edits make the "
    "list stale") {
  PaintEditor test;
  Document next = test.editor->document();
  next.weights = bad_weights(*next.volume);
  test.editor->history->commit("Weigh", next);
  test.editor->ui->open_sections["Problems"] = test.editor->ui->open_sections["Bones"] = true;
  for (const char* folded : {"Bones", "Layers", "Brush"}) test.editor->ui->open_sections[folded] = false;
  test.play("key N\nmove \"3D view/view\"\nkey J\nwait-job\nwait-idle");
  auto found = test.editor->skin->painting->problems;
  REQUIRE(found);
  const auto& problems = found->problems;
  const auto island = std::find_if(problems.begin(), problems.end(),
                                   [](const WeightProblem& p) { return p.kind == WeightProblem::Kind::Island; });
  REQUIRE(island != problems.end());
  CHECK(island->bone == 1);
  CHECK(glm::distance(island->place, glm::dvec3(0, -30, 20)) < 8);
  CHECK_FALSE(problems_stale(*test.editor));
  test.choose(0);
  const std::string row = "\"sidebar/sections/Problems/problem " + std::to_string(island - problems.begin()) + "/";
  test.play("click " + row + "name\"\nwait-idle");
  CHECK(test.editor->selection->bone == 1);
  CHECK(glm::distance(test.editor->views->body.camera.centre, island->place) < 1e-9);
  CHECK(glm::distance(test.editor->views->cross_hair, island->place) < 1e-9);
  const int steps = test.steps();
  const auto before = test.editor->document().weights;
  test.play("click " + row + "Repair\"\nwait-job\nwait-idle");
  CHECK(test.steps() == steps + 1);
  CHECK(test.last_edit().starts_with("Repair "));
  CHECK_FALSE(problems_stale(*test.editor));
  CHECK(test.editor->skin->painting->problems->repaired[static_cast<std::size_t>(island - problems.begin())]);
  const TissueVoxels tissue(*test.editor->document().volume);
  for (const std::int64_t place : island->voxels) {
    std::int64_t brick = 0;
    while (tissue.bricks()[brick].first + tissue.bricks()[brick].count() <= place) ++brick;
    CHECK(test.weights().chunk(brick)[place - tissue.bricks()[brick].first].of(1) < 0.5);
  }
  test.play("key Ctrl+Z\nwait-idle");
  CHECK(test.editor->document().weights == before);
  CHECK(problems_stale(*test.editor));

  // If a locked bone blocks the repair, a message names the bone.
  toggle_lock(*test.editor, 0);
  test.play("click \"sidebar/sections/Problems/skin.find_problems\"\nwait-job\nwait-idle");
  test.editor->messages->toasts.clear();
  test.play("click " + row + "Repair\"\nwait-job\nwait-idle");
  REQUIRE(test.editor->messages->toasts.size() == 1);
  CHECK(test.editor->messages->toasts[0].line == "Upper is locked");
}

}  // namespace limber::test
