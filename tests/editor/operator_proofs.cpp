// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/editor/operator_proofs.h"

#include "editor/context/operator_registry.h"
#include "editor/files/project_session.h"

#include <algorithm>

namespace limber::test {

namespace {

constexpr glm::ivec2 kWindow{1120, 560}, kSmall{160, 120};

}  // namespace

Stage::Stage() : sitting(home.folder.path(), {}, kWindow) {
  editor().background->worker_program = LIMBER_PROGRAM;
  editor().preferences->reduce_motion = true;  // cameras move at once
  open_limb();
}

void Stage::open_limb() {
  auto opened = std::make_shared<editor::Opened>();
  opened->document = small_limb();
  opened->name = "limb";
  opened->label = "Open limb";
  opened->agreed = editor().history->revision();
  replace_project(editor(), opened);
  sitting.test.player.settle();
}

void Stage::put_away() {
  for (int i = 0; i < 3; ++i)
    for (const bool down : {true, false}) sitting.test.host->events.push(editor::KeyChanged{editor::Key::Escape, down});
  sitting.test.player.settle();
  REQUIRE(is("dialog", "no"));
  REQUIRE(is("error", "none"));
}

void Stage::watch() {
  ran_.clear();
  // Wraps each operator, so that it is recorded when it runs. The editor may replace its operators, so this is done
  // each time.
  for (editor::Operator& op : editor().operators->all)
    op.run = [this, id = op.id, act = op.run](editor::Context& c) {
      ran_.insert(id);
      act(c);
    };
}

Seen Stage::look() {
  editor::Context& c = editor();
  Seen seen{c.document(),
            static_cast<int>(c.history->steps().size()),
            static_cast<int>(c.history->position()),
            c.views->body.camera,
            {},
            c.views->cross_hair,
            c.selection,
            sitting.test.host->clipboard(),
            {},
            {}};
  for (int i = 0; i < 3; ++i) seen.slices[i] = c.views->slices[i].camera;
  render::View3D body(c.views->renderer);
  body.draw(c.views->scene, seen.camera, kSmall, 0, 1);
  seen.body = body.read().rgba;
  render::SliceView slice(c.views->renderer);
  slice.draw(c.views->scene, seen.slices[1], c.views->slice_display, kSmall);
  seen.slice = slice.read().rgba;
  return seen;
}

void prove(Stage& stage, const std::vector<Proof>& proofs) {
  for (const Proof& proof : proofs) {
    INFO(proof.id, ": ", proof.deeds);
    stage.put_away();
    if (proof.ready) proof.ready(stage);
    stage.play(proof.first);
    stage.watch();
    const Seen before = stage.look();
    CHECK_FALSE(proof.effect(stage, before));
    stage.play(proof.deeds);
    INFO("then: dialog ", stage.fact("dialog"), ", error ", stage.fact("error"), ", last message ", stage.fact("toast"),
         ", edit ", stage.fact("edit"));
    CHECK(stage.ran(proof.id));
    CHECK(proof.effect(stage, before));
    if (proof.shows == Shows::InBody) CHECK(stage.look().body != before.body);
    if (proof.shows == Shows::InSlice) CHECK(stage.look().slice != before.slice);
  }
}

TEST_CASE("operators: each one that exists is proved to do what it says") {
  std::set<std::string> proved;
  for (const auto& proofs :
       {proofs_of_views(),       proofs_of_navigation(),   proofs_of_tissues(),    proofs_of_work(),
        proofs_of_files(),       proofs_of_pages(),        proofs_of_posing(),     proofs_of_comparing(),
        proofs_of_motion(),      proofs_of_clips(),        proofs_of_handling(),   proofs_of_rigging(),
        proofs_of_rig_fitting(), proofs_of_skin(),         proofs_of_painting(),   proofs_of_weight_edits(),
        proofs_of_regions(),     proofs_of_layers(),       proofs_of_test_poses(), proofs_of_weight_problems(),
        proofs_of_label_edits(), proofs_of_label_brush(),  proofs_of_seams(),      proofs_of_bone_table(),
        proofs_of_images(),      proofs_of_joint_repair(), proofs_of_measuring(),  proofs_of_curves(),
        proofs_of_constraints(), proofs_of_strips()})
    for (const Proof& proof : proofs) {
      INFO(proof.id);
      CHECK(proved.insert(proof.id).second);
    }
  for (const editor::Operator& op : editor::gather_operators()) {
    INFO(op.id, ", ", op.label);
    CHECK(proved.contains(op.id));
  }
}

}  // namespace limber::test
