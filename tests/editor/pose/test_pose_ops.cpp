// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that select and pose bones and compare results.
#include "editor/context/comparison.h"
#include "editor/context/menu_state.h"
#include "editor/context/pose_editing.h"
#include "editor/context/screen.h"
#include "editor/pose/pose_edits.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/overlap_overlay.h"
#include "editor/resample/results.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

std::function<void(Stage&)> choose(int bone) {
  return [bone](Stage& s) {
    *s.editor().selection = {};
    s.editor().selection->bone = bone;
    s.editor().selection->bones = {bone};
    s.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
  };
}

std::function<bool(Stage&, const Seen&)> edit_is(const char* label) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && static_cast<int>(s.editor().history->position()) == b.position + 1;
  };
}

std::function<bool(Stage&, const Seen&)> bones_are(const std::set<int>& bones, int active) {
  return [=](Stage& s, const Seen&) {
    return s.editor().selection->bones == bones && s.editor().selection->bone == active;
  };
}

double turn_about_z(Stage& s, int bone) { return pose_of(s.document()).rotation[bone].z; }

// Names the two bones as the left and the right one of a pair.
void name_sides(Stage& s) {
  Document next = s.document();
  Armature armature = *next.armature;
  armature.bones[0].name = "LeftHalf";
  armature.bones[1].name = "RightHalf";
  next.armature = std::make_shared<const Armature>(armature);
  s.editor().history->commit("Name sides", next);
  choose(0)(s);
}

// Adds a result that is a body without skin.
void add_result(Stage& s) {
  Document next = s.document();
  auto volume = std::make_shared<LabelVolume>(*next.volume);
  for (Label& label : volume->voxels)
    if (label == 143) label = 0;
  auto result = std::make_shared<Result>();
  result->name = "Bare";
  result->volume = volume;
  result->from_volume = next.volume;
  result->from_pose = std::make_shared<const Pose>(rest_pose(*next.armature));
  Overlap overlap;
  for (std::int64_t i = 0; i < std::ssize(volume->voxels); ++i)
    if (volume->voxels[static_cast<std::size_t>(i)] != 0) overlap.tissue.push_back(i);
  result->overlap = std::make_shared<const Overlap>(std::move(overlap));
  next.results.push_back(result);
  s.editor().history->commit("Add result", next);
  show_result(s.editor(), "Bare");
  s.play("key Ctrl+4\n move \"3D view/view\"\n wait-idle");
}

std::shared_ptr<const LabelVolume> seen_volume(Stage& s) { return s.editor().views->scene.volume; }

}  // namespace

std::vector<Proof> proofs_of_posing() {
  return {
      {"select.parent", "key [", bones_are({0}, 0), Shows::InBody, "", choose(1)},
      {"select.child", "key ]", bones_are({1}, 1), Shows::InBody, "", choose(0)},
      {"select.extend_parent", "key Shift+[", bones_are({0, 1}, 0), Shows::InBody, "", choose(1)},
      {"select.extend_child", "key Shift+]", bones_are({0, 1}, 1), Shows::InBody, "", choose(0)},
      {"select.invert", "key Shift+Ctrl+I", bones_are({0}, 0), Shows::InBody, "", choose(1)},
      {"select.box", "key B\n press \"strip/tool.select\"\n move 500 300\n move 900 640\n release",
       bones_are({0, 1}, 1), Shows::InBody, "", choose(1)},
      {"select.circle", "key C\n press \"3D view/view\"\n release\n key Return", bones_are({0, 1}, 1), Shows::InBody,
       "", choose(1)},
      {"select.similar", "key Shift+G",
       [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Similar"; }, Shows::Nothing, "", choose(1)},
      {"select.children", "move \"3D view/view\"\n key Shift+G\n wait-idle\n click \"Similar/Children\"",
       bones_are({0, 1}, 0), Shows::InBody, "", choose(0)},
      {"select.same_length", "click \"Edit/Select/Same length\"", bones_are({0, 1}, 0), Shows::InBody, "", choose(0)},
      {"select.chain", "key L", bones_are({0, 1}, 0), Shows::InBody, "", choose(0)},

      {"pose.rotate", "key R\n key X\n key 3\n key 0\n key Return", edit_is("Rotate Fore"), Shows::InBody, "",
       choose(1)},
      {"pose.copy", "key Ctrl+C", [](Stage& s, const Seen&) { return s.editor().posing->copied.contains("Fore"); }},
      {"pose.clear_rotation", "key Alt+R", edit_is("Clear rotation"), Shows::InBody},
      {"pose.paste", "key Ctrl+V", edit_is("Paste pose"), Shows::InBody},
      {"pose.limits", "click \"Edit/Pose/Keep to joint limits\"",
       [](Stage& s, const Seen&) { return !s.editor().posing->keep_limits; }},
      {"pose.move", "key G\n key Z\n key 9\n key Return", edit_is("Move body"), Shows::InBody, "", choose(0)},
      {"pose.clear_translation", "key Alt+G", edit_is("Clear translation"), Shows::InBody},
      {"pose.flip", "key Ctrl+M",
       [](Stage& s, const Seen& b) { return edit_is("Flip pose")(s, b) && turn_about_z(s, 0) < -0.1; }, Shows::InBody,
       "key R\n key Z\n key 3\n key 0\n key Return\n key Ctrl+C"},
      {"pose.paste_flipped", "key Shift+Ctrl+V",
       [](Stage& s, const Seen& b) { return edit_is("Paste flipped pose")(s, b) && turn_about_z(s, 0) < -0.1; },
       Shows::InBody, "key Alt+R"},
      {"pose.library_add", "click \"Edit/Pose library/Add to library\"",
       [](Stage& s, const Seen&) {
         return s.document().poses.size() == 1 && s.document().poses[0]->rotation.contains("Fore");
       },
       Shows::Nothing, "key R\n key X\n key 3\n key 0\n key Return", choose(1)},
      {"pose.library_apply", "click \"Edit/Pose library/Apply library pose\"", edit_is("Apply Pose"), Shows::InBody,
       "key Alt+R"},
      {"pose.library_blend", "click \"Edit/Pose library/Blend to library pose\"\n key 5\n key 0\n key Return",
       edit_is("Blend to Pose"), Shows::InBody, "move \"3D view/view\"\n key Alt+R"},
      {"pose.library_rename",
       "click \"Edit/Pose library/Rename pose...\"\n wait-idle\n key Ctrl+A\n type Reach\n key Return",
       [](Stage& s, const Seen&) { return s.document().poses[0]->name == "Reach"; }},
      {"pose.library_delete", "click \"Edit/Pose library/Delete pose\"",
       [](Stage& s, const Seen&) { return s.document().poses.empty(); }},
      {"select.mirror", "key Shift+Ctrl+M", bones_are({1}, 1), Shows::InBody, "", name_sides},
      {"select.same_joint", "click \"Edit/Select/Same joint\"", bones_are({0, 1}, 0), Shows::InBody, "",
       [](Stage& s) {
         Document next = s.document();
         Armature rig = *next.armature;
         rig.bones[1].limits = rig.bones[0].limits;
         next.armature = std::make_shared<const Armature>(rig);
         s.editor().history->commit("Free", next);
         choose(0)(s);
       }},
      {"select.siblings", "click \"Edit/Select/Siblings\"", bones_are({0, 1}, 0), Shows::InBody, "",
       [](Stage& s) {
         Document next = s.document();
         Armature rig = *next.armature;
         rig.bones[1].parent = -1;
         next.armature = std::make_shared<const Armature>(rig);
         s.editor().history->commit("Apart", next);
         choose(0)(s);
       }},
  };
}

std::vector<Proof> proofs_of_comparing() {
  return {
      {"compare.show_a", "key 1", [](Stage& s, const Seen&) { return seen_volume(s) == s.document().volume; },
       Shows::InBody, "", add_result},
      {"compare.show_b", "key 2",
       [](Stage& s, const Seen&) { return seen_volume(s) == s.document().results.back()->volume; }, Shows::InBody},
      {"compare.flicker", "key-down F\n wait-idle",
       [](Stage& s, const Seen&) { return seen_volume(s) == s.document().volume; }, Shows::InBody},
      {"compare.wipe", "key 4",
       [](Stage& s, const Seen&) { return wiping(s.editor()) && s.editor().views->other_scene; }, Shows::Nothing,
       "key-up F\n wait-idle"},
      {"compare.swap", "click \"Edit/Resample/Swap A and B\"",
       [](Stage& s, const Seen&) { return s.editor().comparison->a == "Bare"; }},
      {"compare.side_by_side", "key 3",
       [](Stage& s, const Seen&) {
         return side_by_side(s.editor()) && s.editor().screen->layout.view_places.size() == 2;
       },
       Shows::Nothing, "move \"3D view/view\"\n key 4\n wait-idle"},
      {"compare.difference", "key D\n wait-idle",
       [](Stage& s, const Seen&) {
         return shows_difference(s.editor()) && s.editor().views->scene.weights.has_value();
       },
       Shows::InBody},
      {"result.overlap", "key O\n wait-idle",
       [](Stage& s, const Seen&) {
         return shows_overlap(s.editor()) && s.editor().views->scene.weights &&
                s.editor().views->scene.volume == s.document().results.back()->volume;
       },
       Shows::InBody, "key 2\n wait-idle"},
      {"result.rename",
       "click \"Edit/Resample/Rename result...\"\n wait-idle\n key Ctrl+A\n type \"Skinless\"\n key Return",
       [](Stage& s, const Seen&) { return s.document().results.back()->name == "Skinless"; }},
      {"file.export", "key Ctrl+E\n type posed\n key Return\n wait-job",
       [](Stage& s, const Seen& b) {
         return std::filesystem::exists(s.home / "posed.nrrd") &&
                read_volume(s.home / "posed.nrrd").volume.voxels == b.document.results.back()->volume->voxels;
       }},
      {"report.open", "key Shift+Ctrl+R\n type judged.txt\n key Return\n wait-job",
       [](Stage& s, const Seen&) {
         return std::filesystem::exists(s.home / "judged.txt") &&
                read_file(s.home / "judged.txt").find("Joint limits") != std::string::npos;
       }},
  };
}

TEST_CASE("operators: bones are chosen and posed") {
  Stage stage;
  prove(stage, proofs_of_posing());
}

TEST_CASE("operators: results are compared") {
  Stage stage;
  prove(stage, proofs_of_comparing());
}

}  // namespace limber::test
