// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that edit the rig at rest.
#include "editor/context/menu_state.h"
#include "editor/context/transform_settings.h"
#include "editor/rig/rig_edits.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

using Effect = std::function<bool(Stage&, const Seen&)>;

std::function<void(Stage&)> choose(std::set<int> bones, int active) {
  return [=](Stage& s) {
    *s.editor().selection = {};
    s.editor().selection->bone = active;
    s.editor().selection->bones = bones;
    s.editor().transform_settings->part = TransformSettings::Part::Whole;
    s.play("key Ctrl+1\n move \"3D view/view\"\n wait-idle");
  };
}

// Opens the limb again and selects bones.
std::function<void(Stage&)> anew(std::set<int> bones, int active) {
  return [=](Stage& s) {
    s.open_limb();
    choose(bones, active)(s);
  };
}

// Returns a check that one edit with this label was made, and that the rig satisfies `made`.
Effect edited(const std::string& label, std::function<bool(const Armature&)> made) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && static_cast<int>(s.editor().history->position()) == b.position + 1 &&
           made(*s.document().armature);
  };
}

const Bone& named(const Armature& rig, const std::string& name) {
  static const Bone none;
  const auto bone = rig.find(name);
  return bone ? rig.bones[*bone] : none;
}

void tail_of_upper(Stage& s) {
  anew({0}, 0)(s);
  s.editor().transform_settings->part = TransformSettings::Part::Tail;
}

Effect snaps(Snap snap) {
  return [=](Stage& s, const Seen&) { return s.editor().transform_settings->snap == snap; };
}

}  // namespace

std::vector<Proof> proofs_of_rigging() {
  return {
      {"tool.scale", "click \"strip/tool.scale\"", [](Stage& s, const Seen&) { return s.is("tool", "scale"); },
       Shows::Nothing, "", choose({1}, 1)},
      {"rig.move", "key G\n key X\n key 5\n key Return",
       edited("Move Fore",
              [](const Armature& r) {
                return r.bones[1].tail == glm::dvec3(5, 0, -36) && r.bones[0].tail == glm::dvec3(5, 0, 0);
              }),
       Shows::InBody, "", anew({1}, 1)},
      {"edit.adjust_last",
       "move \"3D view/view\"\n key F9\n wait-idle\n double-click adjust/X/value\n key Ctrl+A\n type 9\n key Return\n "
       "wait-idle",
       [](Stage& s, const Seen& b) {
         return s.is("edit", "Move Fore") && static_cast<int>(s.editor().history->position()) == b.position &&
                s.document().armature->bones[1].tail == glm::dvec3(9, 0, -36);
       },
       Shows::InBody, "key G\n key X\n key 5\n key Return\n wait-idle", anew({1}, 1)},
      {"rig.rotate", "key R\n key Y\n key 9\n key 0\n key Return",
       edited("Rotate Fore",
              [](const Armature& r) {
                return glm::distance(r.bones[1].tail, {-36, 0, 0}) < 1e-9;
              }),
       Shows::InBody, "", anew({1}, 1)},
      {"rig.scale", "key S\n key 2\n key Return",
       edited("Scale Fore",
              [](const Armature& r) {
                return glm::distance(r.bones[1].tail, {0, 0, -72}) < 1e-9;
              }),
       Shows::InBody, "", anew({1}, 1)},
      {"rig.roll", "key Ctrl+R\n key 3\n key 0\n key Return",
       edited("Roll Fore", [](const Armature& r) { return std::abs(glm::degrees(r.bones[1].roll) - 30) < 1e-9; }),
       Shows::Nothing, "", anew({1}, 1)},
      {"rig.add", "key Shift+A",
       edited("Add bone", [](const Armature& r) { return r.bones.size() == 3 && r.bones[2].parent == -1; }),
       Shows::InBody},
      {"rig.extrude", "key E\n key Z\n key -\n key 8\n key Return",
       edited("Extrude Fore",
              [](const Armature& r) {
                return named(r, "Fore.001").parent == 1 && glm::distance(named(r, "Fore.001").tail, {0, 0, -44}) < 1e-9;
              }),
       Shows::InBody, "", anew({1}, 1)},
      {"rig.fill", "key F",
       edited("Fill gap with bone Fore.001",
              [](const Armature& r) {
                return named(r, "Fore.001").parent == 1 && named(r, "Fore.001").head.z == -36 &&
                       glm::distance(named(r, "Fore.001").tail, {10, 2, -20}) < 1e-9;
              }),
       Shows::InBody, "",
       [](Stage& s) {
         anew({1}, 1)(s);
         s.editor().views->cross_hair = {10, 2, -20};
       }},
      {"rig.duplicate", "key Shift+D\n key X\n key 9\n key Return",
       edited("Duplicate Fore",
              [](const Armature& r) {
                return named(r, "Fore.001").tail == glm::dvec3(9, 0, -36) && r.bones[1].tail == glm::dvec3(0, 0, -36);
              }),
       Shows::InBody, "", anew({1}, 1)},
      {"rig.subdivide", "click \"Edit/Bone/Subdivide\"",
       edited("Subdivide Fore", [](const Armature& r) { return r.bones.size() == 3 && r.bones[1].tail.z == -18; }),
       Shows::InBody, "", anew({1}, 1)},
      {"rig.dissolve", "key Ctrl+X",
       edited("Dissolve Fore.001", [](const Armature& r) { return r.bones.size() == 2 && r.bones[1].tail.z == -36; }),
       Shows::InBody, "", choose({2}, 2)},
      {"rig.separate", "key Y", edited("Separate Fore", [](const Armature& r) { return r.bones[1].parent == -1; }),
       Shows::Nothing, "", choose({1}, 1)},
      {"rig.parent", "key Ctrl+P",
       edited("Parent 2 bones",
              [](const Armature& r) { return named(r, "Upper").parent >= 0 && named(r, "Upper").head.z == 36; }),
       Shows::Nothing, "", choose({0, 1}, 1)},
      {"rig.clear_parent", "key Alt+P",
       edited("Clear parent of Upper", [](const Armature& r) { return named(r, "Upper").parent == -1; }),
       Shows::Nothing, "", choose({1}, 1)},
      {"rig.connect", "click \"Edit/Bone/Connect to parent\"",
       edited("Connect 2 bones",
              [](const Armature& r) { return named(r, "Upper").parent >= 0 && named(r, "Upper").head.z == -36; }),
       Shows::InBody, "", choose({0, 1}, 0)},
      {"rig.flip_direction", "key Alt+F",
       edited("Flip direction of Fore", [](const Armature& r) { return r.bones[1].head.z == -36; }), Shows::InBody, "",
       anew({1}, 1)},
      {"rig.recalculate_roll", "key Shift+N",
       edited("Recalculate roll of Fore",
              [](const Armature& r) { return glm::dot(rest_axes(r.bones[1])[2], glm::dvec3(0, -1, 0)) > 0.999; }),
       Shows::Nothing, "key Ctrl+R\n key 7\n key 0\n key Return", anew({1}, 1)},
      {"rig.symmetrize", "key Shift+M",
       edited("Symmetrize Arm.L",
              [](const Armature& r) { return named(r, "Arm.R").tail.x == -named(r, "Arm.L").tail.x; }),
       Shows::InBody, "",
       [](Stage& s) {
         anew({1}, 1)(s);
         Document next = s.document();
         Armature rig = *next.armature;
         rig.bones[0].head = rig.bones[0].tail = {0, 0, 0};
         rig.bones[0].head.z = 36;
         rig.bones[1].name = "Arm.L";
         rig.bones[1].tail = {30, 0, 0};
         rig.bones[1].limits = {};
         // If no pair of bones defines the mirror plane, it is the plane through the middle bones.
         rig.bones.push_back({"Hip.L", 0, {10, 0, -20}, {20, 0, -30}, 0, {}});
         rig.bones.push_back({"Hip.R", 0, {-10, 0, -20}, {-20, 0, -30}, 0, {}});
         next.armature = std::make_shared<const Armature>(rig);
         s.editor().history->commit("Name sides", next);
         choose({1}, 1)(s);
       }},
      {"rig.mirror", "key Ctrl+M",
       edited("Mirror 2 bones",
              [](const Armature& r) { return named(r, "Hip.R").tail.x == -20 && r.bones[2].name == "Hip.R"; }),
       Shows::Nothing, "", choose({2, 3}, 3)},
      {"rig.motion_range", "click \"Edit/Bone/Range of motion...\"\n click Joint/list\n click Joint/Elbow\n key Return",
       edited("Set range of motion of Fore",
              [](const Armature& r) {
                return r.bones[1].limits.type == JointLimits::Type::Hinge &&
                       std::abs(glm::degrees(r.bones[1].limits.maximum) - 150) < 1e-9;
              }),
       Shows::Nothing, "", anew({1}, 1)},
      {"rig.next_leaving", "click \"Edit/Rig/Next bone outside tissue\"",
       [](Stage& s, const Seen&) {
         return s.editor().selection->bone == 1 && s.editor().transform_settings->part == TransformSettings::Part::Tail;
       },
       Shows::Nothing, "key G\n key Z\n key -\n key 3\n key 0\n key Return\n wait-idle", anew({1}, 1)},
      {"view.rig_check", "click \"View/Overlays/Bones outside tissue\"",
       [](Stage& s, const Seen&) { return !s.editor().transform_settings->rig_check_marks; }},
      {"rig.batch_rename",
       "key Ctrl+F2\n click Bones/All\n click Find/text\n type \"er\"\n click \"Replace with/text\"\n type \"ER\"\n "
       "click Suffix/text\n type \".L\"\n wait-idle\n key Return",
       edited("Rename 2 bones",
              [](const Armature& r) { return r.bones[0].name == "UppER.L" && r.bones[1].name == "Fore.L"; }),
       Shows::Nothing, "", anew({1}, 1)},
      {"rig.delete", "key X", edited("Delete Fore", [](const Armature& r) { return r.bones.size() == 1; }),
       Shows::InBody, "", anew({1}, 1)},
      {"rig.snap", "key Shift+Tab", [](Stage& s, const Seen&) { return s.editor().transform_settings->snapping; }},
      {"rig.snap_pie", "key Shift+S", [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Snap"; },
       Shows::Nothing, "move \"3D view/view\""},
      {"snap.voxel", "move \"3D view/view\"\n key Shift+S\n wait-idle\n click \"Snap/Snap to voxels\"",
       snaps(Snap::Voxel)},
      {"rig.joints_to_bone", "key Shift+S\n wait-idle\n click \"Snap/Joint to bone middle\"",
       edited("Move to bone middle: Upper",
              [](const Armature& r) {
                return glm::length(glm::dvec2(r.bones[0].tail)) < 3 && r.bones[1].head == r.bones[0].tail;
              }),
       Shows::InBody, "key G\n key X\n key 6\n key Return", tail_of_upper},
      {"rig.joints_to_voxels", "key Shift+S\n wait-idle\n click \"Snap/Joint to voxel\"",
       edited("Move to voxel: Upper",
              [](const Armature& r) {
                return glm::distance(r.bones[0].tail, {6, 2, 1}) < 1e-9;
              }),
       Shows::InBody, "key G\n key X\n key 6\n key Return", tail_of_upper},
      {"rig.joint_to_cross_hair", "key Shift+S\n wait-idle\n click \"Snap/Joint to cross-hair\"",
       edited("Move to cross-hair: Upper", [](const Armature& r) { return r.bones[0].tail == glm::dvec3(10, 2, -20); }),
       Shows::InBody, "",
       [](Stage& s) {
         tail_of_upper(s);
         s.editor().views->cross_hair = {10, 2, -20};
       }},
      {"rig.cross_hair_to_joint", "key Shift+S\n wait-idle\n click \"Snap/Cross-hair to joint\"",
       [](Stage& s, const Seen&) { return s.editor().views->cross_hair == s.document().armature->bones[0].tail; },
       Shows::Nothing, "", tail_of_upper},
      {"snap.joint", "click \"Edit/Snapping/Snap to joints\"", snaps(Snap::Joint)},
      {"snap.bone_middle", "click \"Edit/Snapping/Bone middle\"", snaps(Snap::BoneMiddle)},
      {"snap.steps", "click \"Edit/Snapping/Snap to steps\"", snaps(Snap::Steps)},
  };
}

TEST_CASE("operators: the rig is edited") {
  Stage stage;
  prove(stage, proofs_of_rigging());
}

}  // namespace limber::test
