// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that edit weights in the whole body or a part of it.
#include "core/project/project_io.h"
#include "editor/skin/painted_region.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

using namespace editor;

namespace {

using Effect = std::function<bool(Stage&, const Seen&)>;

// Makes the lower half follow the second bone, which is active. No tissue is selected.
void weigh(Stage& s) {
  Document next = s.document();
  next.armature = small_limb().armature;
  next.weights = test::half_weights(*next.volume);
  s.editor().history->commit("Weigh", next);
  *s.editor().selection = {};
  s.editor().selection->bone = 1;
  s.editor().selection->bones = {1};
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

Effect edit_is(const char* label) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && static_cast<int>(s.editor().history->position()) == b.position + 1;
  };
}

// Adds two bones and gives every voxel the weights 97, 1, 1 and 1 % of the four.
void weigh_by_four(Stage& s) {
  weigh(s);
  Document next = s.document();
  Armature rig = *next.armature;
  rig.bones.resize(2);
  rig.bones.push_back({"Third", 1, {0, 0, -36}, {0, 0, -40}});
  rig.bones.push_back({"Fourth", 2, {0, 0, -40}, {0, 0, -44}});
  next.armature = std::make_shared<const Armature>(rig);
  const TissueVoxels tissue(*next.volume);
  SkinWeights weights({"Upper", "Fore", "Third", "Fourth"}, tissue);
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick)
    weights.set_chunk(brick, SkinWeights::Influences(weights.chunk(brick).size(),
                                                     limber::quantize({{0, 0.97}, {1, 0.01}, {2, 0.01}, {3, 0.01}})));
  next.weights = std::make_shared<const SkinWeights>(weights);
  s.editor().history->commit("Weigh by four", next);
  s.play("wait-idle");
}
int most_influences(Stage& s) {
  int most = 0;
  const SkinWeights& weights = *s.document().weights;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick)
    for (const Influence& influence : weights.chunk(brick))
      most = std::max(most, static_cast<int>(std::count_if(influence.weight.begin(), influence.weight.end(),
                                                           [](auto weight) { return weight > 0; })));
  return most;
}

// Does what weigh() does, and writes a project of the same body in which every voxel follows the second bone.
void weigh_with_other(Stage& s) {
  weigh(s);
  Document other = small_limb();
  SkinWeights weights({"Upper", "Fore"}, TissueVoxels(*other.volume));
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick)
    weights.set_chunk(brick, SkinWeights::Influences(weights.chunk(brick).size(), rigid_influence(1)));
  other.weights = std::make_shared<const SkinWeights>(weights);
  DocumentWriter writer;
  create_project({other, "", "", {}, {}}, s.home / "other.limber", writer);
}

// Makes the whole body follow the left one of two bones that lie side by side.
void weigh_left(Stage& s) {
  Document next = s.document();
  Armature rig;
  rig.bones = {{"Arm.L", -1, {20, 0, 10}, {20, 0, -10}}, {"Arm.R", -1, {-20, 0, 10}, {-20, 0, -10}}};
  next.armature = std::make_shared<const Armature>(rig);
  SkinWeights weights({"Arm.L", "Arm.R"}, TissueVoxels(*next.volume));
  next.weights = std::make_shared<const SkinWeights>(weights);
  s.editor().history->commit("Weigh left", next);
  *s.editor().selection = {};
  s.editor().selection->bone = 0;
  s.editor().selection->bones = {0};
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

}  // namespace

std::vector<Proof> proofs_of_weight_edits() {
  const std::string at_middle = "move \"3D view/view\"\n wait-idle\n ";
  return {
      {"skin.flood", "key Ctrl+X\n wait-idle", edit_is("Flood Fore"), Shows::InBody, "", weigh},
      {"skin.fill_part", "key L\n wait-idle", edit_is("Fill connected tissue with weight of Fore"), Shows::InBody,
       at_middle, weigh},
      {"skin.assign_tissue", "key Shift+L\n wait-idle", edit_is("Assign Skin to Fore"), Shows::InBody, at_middle,
       weigh},
      {"skin.gradient", "key Shift+A\n press \"3D view/view\"\n move 600 400\n release\n wait-idle",
       edit_is("Draw weight gradient of Fore"), Shows::InBody, at_middle, weigh},
      {"skin.smooth_all", "click \"Edit weights/Smooth all\"\n wait-idle", edit_is("Smooth all"), Shows::InBody, "",
       weigh},
      {"skin.limit", "click \"Edit weights/Limit influences\"\n wait-idle",
       [](Stage& s, const Seen& b) { return edit_is("Limit influences to 2")(s, b) && most_influences(s) == 2; },
       Shows::Nothing, "", weigh_by_four},
      {"skin.prune", "click \"Edit weights/Clean small weights\"\n wait-idle", edit_is("Clean small weights"),
       Shows::Nothing, "", weigh_by_four},
      {"skin.levels", "click \"Edit weights/Levels\"\n wait-idle", edit_is("Set weight levels of Fore"), Shows::InBody,
       "click \"Edit weights/Smooth all\"\n wait-idle", weigh},
      {"skin.quantize", "click \"Edit weights/Quantize\"\n wait-idle", edit_is("Quantize to 10 steps"), Shows::InBody,
       "click \"Edit weights/Smooth all\"\n wait-idle", weigh},
      {"skin.copy_weights", "click \"Edit weights/Copy weights...\"\n key Return\n wait-idle",
       edit_is("Move weights of Fore to Upper"), Shows::InBody, "", weigh},
      {"skin.mirror_weights", "key Ctrl+M\n wait-idle", edit_is("Mirror weights to the right"), Shows::InBody, "",
       weigh_left},
      {"skin.transfer_weights",
       "click \"Edit weights/Transfer weights...\"\n type other.limber\n key Return\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         return edit_is("Transfer weights from other.limber")(s, b) &&
                s.document().weights->chunk(0)[0] == rigid_influence(1);
       },
       Shows::InBody, "", weigh_with_other},
  };
}

std::vector<Proof> proofs_of_regions() {
  // Draws a box over the upper left of the ball, seen from the front.
  const std::string box = "key B\n press \"3D view/view\"\n move 300 150\n release\n wait-idle",
                    lasso = "key C\n press \"3D view/view\"\n move 300 180\n move 320 380\n release\n wait-idle";
  const auto has_region = [](Stage& s, const Seen&) { return painted_region(s.editor()) != nullptr; };
  const auto voxels = [](int least, int most) {
    return [=](Stage& s, const Seen&) {
      return painted_region_voxels(s.editor()) >= least && painted_region_voxels(s.editor()) <= most;
    };
  };
  return {
      {"skin.region_box", box, has_region, Shows::InBody, "", weigh},
      {"skin.region_invert", "key Shift+Ctrl+I\n wait-idle",
       [](Stage& s, const Seen&) { return 2 * painted_region_voxels(s.editor()) > s.document().weights->size(); },
       Shows::InBody},
      {"skin.region_clear", "key Alt+A\n wait-idle", [](Stage& s, const Seen&) { return !painted_region(s.editor()); },
       Shows::InBody},
      {"skin.region_lasso", lasso, has_region, Shows::InBody, "key Alt+A"},
      {"skin.region_bone", "click \"Edit weights/Region/Region of selected bones\"\n wait-idle",
       [](Stage& s, const Seen&) {
         return std::abs(2 * painted_region_voxels(s.editor()) - s.document().weights->size()) <
                s.document().weights->size() / 10;
       },
       Shows::InBody, "key Alt+A"},
      {"skin.region_unmatched", "click \"Edit weights/Region/Region of unmatched voxels\"\n wait-idle", voxels(2, 2),
       Shows::Nothing, "key Alt+A",
       [](Stage& s) {
         s.editor().skin->painting->unmatched = {5, 7};
       }},
  };
}

TEST_CASE("operators: weights are edited in the whole body or a part of it") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_weight_edits());
}

TEST_CASE("operators: brushes and edits of weights keep to a region") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_regions());
}

}  // namespace limber::test
