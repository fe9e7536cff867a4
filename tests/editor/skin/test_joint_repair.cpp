// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/skin/joint_repair.h"

#include <cmath>

#include "core/binding/heat_diffusion.h"
#include "core/phantom/phantom.h"
#include "core/resample/resample.h"
#include "editor/shown/preview_blend.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/paint_editor.h"

namespace limber::test {

using namespace editor;

namespace {

// Returns the phantom arm with weights by heat diffusion.
Document weighted_arm() {
  Phantom phantom = make_arm_phantom(6);
  Document document;
  document.volume = std::make_shared<const LabelVolume>(std::move(phantom.volume));
  document.tissues = std::make_shared<const TissueTable>(std::move(phantom.tissues));
  document.armature = std::make_shared<const Armature>(std::move(phantom.armature));
  document.volume_type = std::make_shared<FileType>();
  document.weights =
      std::make_shared<const SkinWeights>(diffuse_heat(*document.volume, *document.tissues, *document.armature));
  return document;
}

// Returns the sum of |volume change| of skin, fat and muscle at some angles of the elbow, by voxels of resampled
// bodies.
double change_of(const Document& document, Blend blend) {
  const std::vector<TissueKind> kinds = document.tissues->kinds();
  double sum = 0;
  for (const double degrees : {40.0, 75.0, 110.0}) {
    Pose pose = rest_pose(*document.armature);
    flex(pose, *document.armature, require_bone(*document.armature, "Forearm"), degrees);
    const Posed posed =
        resample(*document.volume, *document.tissues, *document.armature, *document.weights, pose, blend);
    for (const TissueKind kind : {TissueKind::Skin, TissueKind::Fat, TissueKind::Muscle}) {
      double before = 0, after = 0;
      for (const Label label : document.volume->voxels) before += kinds[label] == kind;
      for (const Label label : posed.volume.voxels) after += kinds[label] == kind;
      sum += 100 * std::abs(after / before - 1);
    }
  }
  return sum;
}

void choose_forearm(Context& editor) {
  const int bone = require_bone(*editor.document().armature, "Forearm");
  *editor.selection = {};
  editor.selection->bone = bone;
  editor.selection->bones = {bone};
}

void open_arm(Stage& s) {
  s.editor().history->reset(weighted_arm(), "Open arm");
  choose_forearm(s.editor());
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

}  // namespace

std::vector<Proof> proofs_of_joint_repair() {
  return {
      {"skin.repair_joint", "click \"Edit weights/Repair this joint\"\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) { return s.document().weights != b.document.weights; }, Shows::Nothing, "",
       open_arm},
  };
}

TEST_CASE("operators: a joint is repaired") {
  Stage stage;
  prove(stage, proofs_of_joint_repair());
}

TEST_CASE(
    "joint repair: the button in the sidebar puts weights that keep more volume on a layer of their own, undo takes "
    "them away, redo brings them back") {
  SmallEditor test({1280, 900}, {}, false);
  test.editor->history->reset(weighted_arm(), "Open arm");
  frame_all(*test.editor, false);
  choose_forearm(*test.editor);
  for (const char* folded : {"Bones", "Layers", "Brush"}) test.editor->ui->open_sections[folded] = false;
  test.editor->ui->open_sections["Joint"] = true;
  test.play("key N\nkey Ctrl+2\nwait-idle");
  const Document before = test.editor->document();
  test.play("click \"sidebar/sections/Joint/skin.repair_joint\"\nwait-job\nwait-idle");
  const Document after = test.editor->document();
  REQUIRE(after.layers);
  CHECK(after.layers->layers.back()->name == "Joint of Forearm");
  CHECK(after.layers->base == before.weights);
  CHECK(composed(*after.layers) == *after.weights);
  const Blend blend = preview_blend(test.editor->resampling);
  CHECK(change_of(after, blend) < change_of(before, blend));
  const auto told = test.editor->skin->painting->repaired_joint;
  REQUIRE(told);
  CHECK(told->bone == "Forearm");
  CHECK(mean_sum(told->figures.after) < mean_sum(told->figures.before));

  test.play("key Ctrl+Z\nwait-idle");
  CHECK(test.editor->document().weights == before.weights);
  CHECK(test.editor->document().layers == before.layers);
  test.play("key Ctrl+Shift+Z\nwait-idle");
  CHECK(test.editor->document().weights == after.weights);
}

TEST_CASE("joint repair: a bone without a parent is refused with the reason, and a cancelled repair changes nothing") {
  SmallEditor test({1280, 900}, {}, false);
  test.editor->history->reset(weighted_arm(), "Open arm");
  test.play("key Ctrl+2\nwait-idle");
  test.editor->selection->bone = 0;
  test.editor->selection->bones = {0};
  const Operator* repair = find_operator(test.editor->operators, "skin.repair_joint");
  REQUIRE(repair);
  CHECK(disabled_reason(*test.editor, *repair) == "This bone has no joint: select a bone with a parent");
  choose_forearm(*test.editor);
  CHECK(disabled_reason(*test.editor, *repair).empty());
  const Document before = test.editor->document();
  start_repairing_joint(*test.editor);
  CHECK(repairs_joint(test.editor->jobs));
  CHECK(disabled_reason(*test.editor, *repair) == "A joint is being repaired: wait until the job ends");
  test.editor->jobs->cancel_all();
  test.play("wait-job\nwait-idle");
  CHECK_FALSE(repairs_joint(test.editor->jobs));
  CHECK(test.editor->document().weights == before.weights);
  CHECK(test.editor->document().layers == before.layers);
}

}  // namespace limber::test
