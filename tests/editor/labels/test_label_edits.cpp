// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/labels/label_edits.h"

#include <cmath>

#include "core/base/error.h"
#include "editor/seams/seam_view.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

using namespace editor;

namespace {

std::int64_t voxels_with(const Document& document, Label label) {
  return std::count(document.volume->voxels.begin(), document.volume->voxels.end(), label);
}

// Makes a hole in the ball's bone and an island of bone in its muscle, and selects bone.
void spoil(Context& editor) {
  Document next = editor.document();
  auto volume = std::make_shared<LabelVolume>(*small_body().volume);
  volume->at({11, 10, 15}) = 0;
  volume->at({12, 10, 20}) = 111;
  next.volume = volume;
  editor.history->commit("Spoil", next);
  editor.selection->tissue = 111;
  editor.selection->tissues = {111};
}

std::function<bool(Stage&, const Seen&)> edits(const char* label, std::int64_t voxels) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && static_cast<int>(s.editor().history->position()) == b.position + 1 &&
           voxels_with(s.document(), 111) - voxels_with(b.document, 111) == voxels;
  };
}

// Counts the voxels that satisfy a condition on their label and position.
std::int64_t count_voxels(const std::function<bool(const LabelVolume&, const glm::ivec3&, const glm::dvec3&)>& holds) {
  const LabelVolume volume = *small_body().volume;
  const AffineTransform world = world_from_voxel(volume.grid);
  std::int64_t count = 0;
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x) count += holds(volume, {x, y, z}, world * glm::dvec3(x, y, z));
  return count;
}

// Counts the voxels that are not bone and have bone within `mm`, by brute force. With `bone` set, counts bone voxels
// that have other tissue within `mm`.
std::int64_t near_bone(double mm, bool bone) {
  return count_voxels([&](const LabelVolume& volume, const glm::ivec3& v, const glm::dvec3&) {
    if ((volume.at(v) == 111) != bone) return false;
    const glm::ivec3 reach(glm::ceil(mm / volume.grid.spacing));
    for (int z = -reach.z; z <= reach.z; ++z)
      for (int y = -reach.y; y <= reach.y; ++y)
        for (int x = -reach.x; x <= reach.x; ++x)
          if ((volume.at_or_air(v + glm::ivec3(x, y, z)) == 111) != bone &&
              glm::length(glm::dvec3(x, y, z) * volume.grid.spacing) <= mm + 1e-9)
            return true;
    return false;
  });
}

constexpr const char kMenu[] = "click \"Edit/Prepare volume/Labels/";

}  // namespace

std::vector<Proof> proofs_of_label_edits() {
  const std::string menu = kMenu;
  const auto spoiled = [](Stage& s) { spoil(s.editor()); };
  const auto clean = [](Stage& s) {
    spoil(s.editor());
    Document next = s.document();
    next.volume = small_body().volume;
    s.editor().history->commit("Clean", next);
  };
  return {
      {"labels.fill_holes", menu + "Fill holes...\"\n wait-idle\n click dialog/Fill\n wait-job\n wait-idle",
       edits("Fill holes of Cortical bone", 1), Shows::Nothing, "", spoiled},
      {"labels.islands", menu + "Remove islands...\"\n wait-idle\n click dialog/Remove\n wait-job\n wait-idle",
       edits("Remove islands of Cortical bone", -1), Shows::Nothing, "", spoiled},
      {"labels.grow", menu + "Grow...\"\n wait-idle\n click dialog/Grow\n wait-job\n wait-idle",
       edits("Grow Cortical bone", near_bone(5, false)), Shows::InSlice, "", clean},
      {"labels.shrink", menu + "Shrink...\"\n wait-idle\n click dialog/Shrink\n wait-job\n wait-idle",
       edits("Shrink Cortical bone", -near_bone(5, true)), Shows::InSlice, "", clean},
      {"labels.split",
       menu + "Split by a cut\"\n move \"3D view/view\"\n wait-idle\n press \"3D view/view\"\n release\n wait-idle\n " +
           menu + "Split by a cut\"\n move 150 300\n press\n move 700 300\n wait-idle\n release\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         const Tissue* part = s.document().tissues->find(1);
         return part && part->name == "Cortical bone 2" && part->kind == TissueKind::CorticalBone &&
                s.editor().selection->tissue == Label(1) &&
                static_cast<int>(s.editor().history->position()) == b.position + 1 &&
                voxels_with(s.document(), 1) > 20 &&
                voxels_with(s.document(), 1) + voxels_with(s.document(), 111) == voxels_with(b.document, 111);
       },
       Shows::InSlice, "", clean},
      {"labels.new_tissue", menu + "New tissue\"\n wait-idle",
       [](Stage& s, const Seen& b) {
         const auto& tissues = s.document().tissues->tissues;
         return s.is("edit", "New tissue") && tissues.size() == b.document.tissues->tissues.size() + 1 &&
                s.document().tissues->find(*s.editor().selection->tissue)->name == "New tissue";
       }},
  };
}

TEST_CASE("operators: the labels of a tissue are filled, freed of islands, grown, shrunk and split") {
  Stage stage;
  prove(stage, proofs_of_label_edits());
}

TEST_CASE("label edits: undo and redo restore the labels bit for bit") {
  LimbEditor test;
  spoil(*test.editor);
  const LabelVolume before = *test.editor->document().volume;
  const std::string menu = kMenu;
  for (const char* deed :
       {"Fill holes...\"\n wait-idle\n click dialog/Fill", "Remove islands...\"\n wait-idle\n click dialog/Remove",
        "Grow...\"\n wait-idle\n click dialog/Grow", "Shrink...\"\n wait-idle\n click dialog/Shrink"}) {
    INFO(std::string(deed), test.fact("toast"), test.editor->selection->tissue.value_or(0));
    test.play(menu + std::string(deed) + "\n wait-job\n wait-idle");
  }
  const LabelVolume after = *test.editor->document().volume;
  CHECK(after.voxels != before.voxels);
  for (int i = 0; i < 4; ++i) run(*test.editor, "edit.undo");
  CHECK(test.editor->document().volume->voxels == before.voxels);
  CHECK(test.editor->document().volume->grid == before.grid);
  for (int i = 0; i < 4; ++i) run(*test.editor, "edit.redo");
  CHECK(test.editor->document().volume->voxels == after.voxels);
}

TEST_CASE("label edits: weights that no longer fit are removed with a warning, undo brings them back") {
  LimbEditor test;
  Document next = test.editor->document();
  next.weights = half_weights(*next.volume);
  test.editor->history->reset(next, "Weighed");
  test.editor->selection->tissue = 143;
  const std::string menu = kMenu;
  test.play(menu + "Shrink...\"\n wait-idle\n click \"Replace with/Air\"\n click dialog/Shrink\n wait-job\n wait-idle");
  CHECK_FALSE(test.editor->document().weights);
  CHECK(test.editor->messages->toasts.back().detail.find("weights") != std::string::npos);
  run(*test.editor, "edit.undo");
  CHECK(test.editor->document().weights == next.weights);

  // When bone grows into muscle, the same voxels are tissue, so the weights remain.
  test.editor->selection->tissue = 111;
  test.play(menu + "Grow...\"\n wait-idle\n click dialog/Grow\n wait-job\n wait-idle");
  CHECK(test.editor->document().volume != next.volume);
  CHECK(test.editor->document().weights == next.weights);
  // The weights were made for the bone before it grew, and a message says so.
  CHECK(why_weights_are_old(*test.editor) == "Weights are older than the labels");
  run(*test.editor, "edit.undo");
  CHECK(why_weights_are_old(*test.editor) == "");
}

TEST_CASE("label edits: a table of tissues that was changed meanwhile is not overwritten") {
  LimbEditor test;
  test.editor->selection->tissue = 111;
  const Document before = test.editor->document();
  const Tissue part = new_tissue_like(*before.tissues, before.tissues->find(111));
  start_label_edit(*test.editor, {"Split bone",
                                  [](const LabelVolume& volume, Progress&) -> FoundLabelEdit {
                                    LabelVolume after = volume;
                                    after.at({12, 10, 15}) = 143;
                                    return {label_difference(volume, after), "one voxel"};
                                  },
                                  with_tissue(*before.tissues, part), part.label});
  Document renamed = before;
  auto table = std::make_shared<TissueTable>(*before.tissues);
  table->tissues[0].name = "Flesh";
  renamed.tissues = table;
  commit(*test.editor, "Rename", renamed);
  test.play("wait-job\n wait-idle");
  CHECK(test.editor->document().tissues == table);
  CHECK(test.editor->document().volume == before.volume);
  CHECK(test.editor->messages->last_failure.find("tissues was changed meanwhile") != std::string::npos);
}

TEST_CASE("label edits: an edit that finds nothing is no step, and a cut beside the tissue says what to do") {
  LimbEditor test;
  test.editor->selection->tissue = 65;
  const auto steps = test.editor->history->steps().size();
  const std::string menu = kMenu;
  test.play(menu + "Fill holes...\"\n wait-idle\n click dialog/Fill\n wait-job\n wait-idle");
  CHECK(test.editor->history->steps().size() == steps);
  CHECK(test.editor->messages->toasts.back().detail == "No hole was filled");
  test.play(menu + "Split by a cut\"\n move 60 100\n press\n move 90 100\n wait-idle\n release\n wait-job\n wait-idle");
  CHECK(test.editor->history->steps().size() == steps);
  CHECK(test.fact("toast") == "The line does not cut the tissue");
}

TEST_CASE("label edits: a new tissue gets a free label, a free value in files and a name of its own") {
  TissueTable tissues;
  for (const Label label : {1, 2, 4}) {
    Tissue tissue;
    tissue.label = label;
    tissue.file_value = label == 4 ? 3 : label;
    tissue.name = "Femur";
    tissue.kind = TissueKind::Bone;
    tissue.density = 1.7;
    tissues.tissues.push_back(tissue);
  }
  const Tissue part = new_tissue_like(tissues, &tissues.tissues[0]);
  CHECK(part.label == 5);
  CHECK(part.file_value == 5);
  CHECK(part.name == "Femur 2");
  CHECK(part.kind == TissueKind::Bone);
  CHECK(part.density == 1.7);
  const auto more = with_tissue(tissues, part);
  CHECK(more->find(5)->name == "Femur 2");
  CHECK(new_tissue_like(*more, &tissues.tissues[0]).name == "Femur 3");
  CHECK(new_tissue_like(*more, nullptr).name == "New tissue");
  CHECK(new_tissue_like(*more, nullptr).kind == TissueKind::Unknown);
}

}  // namespace limber::test
