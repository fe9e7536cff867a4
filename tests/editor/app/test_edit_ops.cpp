// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that select, hide and clip, prepare volumes, and make weights, poses and results. Checks that
// each can be undone.
#include <fstream>

#include "core/prepare/prepare.h"
#include "editor/context/menu_state.h"
#include "editor/context/resampling_settings.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/ui.h"
#include "tests/editor/operator_proofs.h"
#include "tests/support/kuhn_mesh.h"

namespace limber::test {

using namespace editor;

namespace {

using Effect = std::function<bool(Stage&, const Seen&)>;

Effect becomes(const char* fact, const char* value = "shown") {
  return [=](Stage& s, const Seen&) { return s.is(fact, value); };
}
// Returns a check that the last edit has this label, and that the query `fact` now has this value.
Effect edits(const char* label, const char* fact, const char* value) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && s.is(fact, value) &&
           static_cast<int>(s.editor().history->position()) == b.position + 1;
  };
}
// Returns a check that the volume is the one that `expected` makes of the old volume.
Effect makes(LabelVolume (*expected)(const LabelVolume&)) {
  return [=](Stage& s, const Seen& b) {
    const LabelVolume volume = expected(*b.document.volume);
    return s.document().volume->grid == volume.grid && s.document().volume->voxels == volume.voxels;
  };
}
bool weighted(Stage& s, const Seen& b) { return s.document().weights && s.document().weights != b.document.weights; }
std::size_t results(Stage& s) { return s.document().results.size(); }

// Adds a result whose mesh is swollen on the left side of the body.
void solved_limb(Stage& stage) {
  stage.open_limb();
  Document next = stage.document();
  const Grid& grid = next.volume->grid;
  auto solved = std::make_shared<SolvedMesh>();
  solved->mesh.tets = kuhn_mesh(grid, glm::dvec3(-1), glm::dvec3(grid.size), {6, 6, 8});
  solved->mesh.material.resize(solved->mesh.tets.T.rows());
  solved->mesh.joint.resize(solved->mesh.tets.T.rows());
  solved->V = solved->mesh.tets.V;
  for (Eigen::Index v = 0; v < solved->V.rows(); ++v) solved->V(v, 0) *= solved->V(v, 0) > 0 ? 1.5 : 1;
  auto result = std::make_shared<Result>();
  result->name = "Swollen";
  result->method = "fem";
  result->volume = next.volume;
  result->from_volume = next.volume;
  result->solved = solved;
  next.results = {result};
  stage.editor().history->commit("Result", next);
  stage.play("key Ctrl+4\n wait-idle");
  show_result(stage.editor(), "Swollen");
  stage.play("wait-idle");
}

auto measures(const std::optional<FemMeasure>& measure) {
  return [measure](Stage& s, const Seen&) {
    const MeasuredMesh* shown = shown_measure(s.editor());
    return s.editor().fem_overlay->measure == measure &&
           (measure ? shown && shown->measure == measure && s.is("text:" + scale_of(*measure).name) : !shown);
  };
}

}  // namespace

std::vector<Proof> proofs_of_tissues() {
  const char* ready = "wait-idle";
  const char* chosen = "click Muscle/17/name";
  return {
      {"tool.cross_hair", "click tool.cross_hair", becomes("tool", "cross-hair")},
      {"tool.select", "click tool.select", becomes("tool", "select")},
      {"select.pick", "click \"3D view/view\"",
       [](Stage& s, const Seen&) { return s.editor().selection->bone && s.is("tissue", "none"); }, Shows::Nothing,
       "click Muscle/17/name\n wait-idle"},
      {"select.none", "click \"Edit/Select/Select nothing\"", becomes("selected", "0"), Shows::Nothing, chosen},
      {"select.extend", "click \"3D view/view\" Shift",
       [](Stage& s, const Seen&) {
         return s.editor().selection->tissues == std::set<Label>{17, 143};
       },
       Shows::Nothing, "click Muscle/17/name\n wait-idle",
       [](Stage& s) { s.editor().views->bones = false; }},  // otherwise a bone under the pointer would be selected
      {"select.all", "move \"3D view/view\"\n key A", becomes("selected", "4"), Shows::Nothing, "click Muscle/17/name",
       [](Stage& s) { s.editor().views->bones = true; }},
      {"select.pick_list", "click \"3D view/view\" Alt",
       [](Stage& s, const Seen&) { return s.is("widget:pick/Muscle") && s.is("widget:pick/bone Upper"); },
       Shows::Nothing, ready},

      {"view.hide", "move \"3D view/view\"\n key H", edits("Hide Skin", "hidden", "1"), Shows::InBody,
       "click Skin/143/name"},
      {"view.reveal", "move \"3D view/view\"\n key Alt+H", becomes("hidden", "0"), Shows::InBody},
      {"view.isolate_selected", "click \"View/Tissues/Show only\"", edits("Show only Muscle", "hidden", "3"),
       Shows::InBody, chosen},
      {"view.isolate", "move \"3D view/view\"\n key Num/",
       [](Stage& s, const Seen& b) {
         return s.is("hidden", "3") && s.document().visibility->looks.at(111).visible &&
                s.editor().views->body.camera.distance < b.camera.distance;
       },
       Shows::InBody, "move \"3D view/view\"\n key Alt+H\n click \"Cortical bone/111/name\""},
      {"edit.undo", "key Ctrl+Z",
       [](Stage& s, const Seen& b) {
         return s.is("hidden", "0") && static_cast<int>(s.editor().history->position()) == b.position - 1;
       },
       Shows::InBody},
      {"edit.redo", "key Ctrl+Shift+Z",
       [](Stage& s, const Seen& b) {
         return s.is("hidden", "3") && static_cast<int>(s.editor().history->position()) == b.position + 1;
       },
       Shows::InBody},
      {"edit.rename", "click Edit/Rename\n key Ctrl+A\n type \"Thigh\"\n key Return",
       [](Stage& s, const Seen&) { return s.document().tissues->find(17)->name == "Thigh"; }, Shows::Nothing, chosen},
      {"edit.history", "click Edit/History", becomes("widget:History/step 0")},

      {"view.clip_box", "move \"3D view/view\"\n key Alt+B", edits("Switch clip box on", "clip-box", "yes"),
       Shows::InBody, "move \"3D view/view\"\n key Alt+H"},
      {"view.clip_plane", "move \"3D view/view\"\n key Shift+Alt+B", edits("Switch clip plane on", "clip-plane", "yes"),
       Shows::InBody},
      {"view.reset_clipping", "click \"View/Clipping/Reset clipping\"", edits("Reset clipping", "clip-box", "no"),
       Shows::InBody},
  };
}

std::vector<Proof> proofs_of_work() {
  const char* undone = "key Ctrl+Z";
  return {
      {"prepare.regrid",
       "click \"Edit/Prepare volume/Resize voxels...\"\n double-click Spacing/value\n type \"6\"\n key Return\n key "
       "Return\n "
       "wait-job",
       [](Stage& s, const Seen&) {
         return s.is("edit", "Resize voxels to 6 mm") && s.document().volume->grid.spacing == glm::dvec3(6);
       }},
      {"prepare.orient",
       "click \"Edit/Prepare volume/Orient...\"\n click \"Columns (x)/list\"\n click \"Columns (x)/Right\"\n key "
       "Return\n wait-job",
       makes([](const LabelVolume& v) { return reorient(v, "RPS"); }), Shows::Nothing, undone},
      {"prepare.flip_x", "click \"Edit/Prepare volume/Flip left and right\"\n wait-job",
       makes([](const LabelVolume& v) { return flip(v, 0); }), Shows::Nothing, undone},
      {"prepare.flip_y", "click \"Edit/Prepare volume/Flip front and back\"\n wait-job",
       makes([](const LabelVolume& v) { return flip(v, 1); }), Shows::Nothing, undone},
      {"prepare.flip_z", "click \"Edit/Prepare volume/Flip head and feet\"\n wait-job",
       makes([](const LabelVolume& v) { return flip(v, 2); }), Shows::Nothing, undone},
      {"prepare.crop", "click \"Edit/Prepare volume/Crop to tissue\"\n wait-job",
       makes([](const LabelVolume& v) { return crop_to_tissue(v); }), Shows::Nothing, undone},
      {"prepare.pad", "click \"Edit/Prepare volume/Pad...\"\n key Return\n wait-job",
       makes([](const LabelVolume& v) { return pad(v, 8); }), Shows::Nothing, undone},
      {"prepare.merge", "click \"Edit/Prepare volume/Merge tissues...\"\n click dialog/Merge\n wait-job",
       makes([](const LabelVolume& v) { return merge_labels(v, 17, 65); }), Shows::Nothing,
       "key Ctrl+Z\n click Muscle/17/name"},
      {"prepare.specks",
       "click \"Edit/Prepare volume/Remove specks...\"\n double-click \"Smaller than/value\"\n type \"500\"\n key "
       "Return\n key Return\n wait-job",
       makes([](const LabelVolume& v) { return drop_specks(v, 500); }), Shows::Nothing, undone},
      {"prepare.crop_to_clip_box", "click \"Edit/Prepare volume/Crop to clip box\"\n wait-job",
       [](Stage& s, const Seen& b) {
         return s.document().volume->voxels.size() < b.document.volume->voxels.size() &&
                s.is("edit", "Crop to clip box");
       },
       Shows::Nothing, "key Ctrl+Z\n move \"3D view/view\"\n key Alt+B"},
      {"prepare.statistics", "click Steps/Prepare/Statistics\n wait-job", becomes("widget:dialog/Export CSV"),
       Shows::Nothing, "key Ctrl+Z\n key Ctrl+Z"},

      {"skin.geodesic", "key F3\n type \"geodesic\"\n key Return\n wait-job", weighted},
      {"skin.rigid", "click Edit/Weights/Rigid\n wait-job", weighted},
      {"skin.compute", "click \"Edit/Weights/Compute weights...\"\n key Return\n wait-job", weighted},
      {"skin.drop_weights", "click \"Edit/Weights/Remove weights\"",
       [](Stage& s, const Seen& b) { return b.document.weights && !s.document().weights; }},
      {"skin.heat", "click Steps/Skin/Compute\n wait-job", weighted},

      {"pose.flex", "click Steps/Pose/Flex...\n double-click Angle/value\n type \"30\"\n key Return\n key Return",
       [](Stage& s, const Seen&) {
         return s.is("edit", "Flex Fore") && s.document().pose &&
                *s.document().pose != rest_pose(*s.document().armature);
       },
       Shows::InBody, "key Ctrl+3\n move \"3D view/view\"\n key Alt+Z"},
      {"resample.lbs", "click Edit/Resample/LBS",
       [](Stage& s, const Seen&) { return s.editor().resampling->method == "lbs"; }},
      {"resample.run", "key Ctrl+Return\n wait-job",
       [](Stage& s, const Seen&) { return results(s) == 1 && s.document().results[0]->name == "Fore 30\u00b0, LBS"; }},
      {"resample.mix", "click Edit/Resample/Mixed",
       [](Stage& s, const Seen&) { return s.editor().resampling->method == "mix"; }},
      {"resample.dqs", "click Edit/Resample/DQ",
       [](Stage& s, const Seen&) { return s.editor().resampling->method == "dqs"; }},
      {"resample.fem", "click Edit/Resample/FEM",
       [](Stage& s, const Seen&) { return s.editor().resampling->method == "fem"; }},
      // The worker is slow, so that there is a solve to watch.
      {"result.watch", "click \"Edit/Resample/Watch the solve\"",
       [](Stage& s, const Seen&) { return s.editor().fem->watched == 0 && !s.editor().fem->solves.empty(); },
       Shows::Nothing, "key Ctrl+Return",
       [](Stage& s) {
         std::ofstream(s.home / "worker") << "#!/bin/sh\nsleep 100\n";
         std::filesystem::permissions(s.home / "worker", std::filesystem::perms::owner_all);
         s.editor().background->worker_program = s.home / "worker";
       }},
      {"result.show_last", "key F3\n type \"show result\"\n key Return",
       [](Stage& s, const Seen&) {
         return shown_result(s.editor()) && s.editor().views->scene.volume == s.document().results.back()->volume;
       },
       Shows::Nothing,
       "click status/Running\n click Cancel\n wait-job\n click \"Edit/Resample/Posed volume\"\n click "
       "\"Edit/Resample/Posed volume\""},
      {"result.toggle", "click \"Edit/Resample/Posed volume\"",
       [](Stage& s, const Seen&) {
         return !shown_result(s.editor()) && s.editor().views->scene.volume == s.document().volume;
       },
       Shows::InBody},
      {"result.copy_report", "click \"Edit/Resample/Copy report\"",
       [](Stage& s, const Seen&) { return s.sitting.test.host->clipboard() == s.document().results.back()->report; }},
      {"result.delete", "click \"Edit/Resample/Delete result\"",
       [](Stage& s, const Seen& b) { return b.document.results.size() == 1 && results(s) == 0; }},
      {"pose.clear", "click \"Edit/Pose/Clear pose\"",
       [](Stage& s, const Seen& b) { return b.document.pose && !s.document().pose; }, Shows::InBody, undone},
      {"result.delete_stale", "click \"Edit/Resample/Delete stale results\"",
       [](Stage& s, const Seen& b) { return b.document.results.size() == 1 && results(s) == 0; }, Shows::Nothing,
       "click Edit/Weights/Rigid\n wait-job"},

      {"fem.show_volume_ratio", "click \"View/Finite elements/Volume ratio\"\n wait-idle",
       measures(FemMeasure::VolumeRatio), Shows::InBody, "", solved_limb},
      {"fem.show_energy", "click \"View/Finite elements/Strain energy\"\n wait-idle",
       measures(FemMeasure::EnergyDensity), Shows::InBody},
      {"fem.show_gap", "click \"View/Finite elements/Contact gap\"\n wait-idle", measures(FemMeasure::Gap),
       Shows::InSlice},
      {"fem.show_tissues", "click header/Colours\n click \"header/Colours/Tissue colours\"\n wait-idle",
       measures(std::nullopt), Shows::InBody},
      {"fem.tets", "click \"View/Finite elements/Tetrahedra\"\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().views->scene.mesh.has_value(); }, Shows::InSlice},
      {"fem.display_pie", "click \"View/Finite elements/Volume ratio\"\n wait-idle\n click \"3D view/legend\"",
       [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Finite elements"; }},
  };
}

TEST_CASE("operators: tissues are chosen, hidden and cut, and edits undone") {
  Stage stage;
  // Folds the panels above, so that the tissues are in view.
  for (const char* above : {"Steps", "Bone"}) stage.editor().ui->open_sections[above] = false;
  prove(stage, proofs_of_tissues());
}

TEST_CASE("operators: the volume is prepared, weighted, posed and resampled") {
  Stage stage;
  prove(stage, proofs_of_work());
}

}  // namespace limber::test
