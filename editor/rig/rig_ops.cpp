// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the rig at rest.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/rig/joint_ranges.h"
#include "core/rig/mirror.h"
#include "editor/context/operator_polls.h"
#include "editor/context/transform_settings.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/rig/rig_check.h"
#include "editor/rig/rig_edits.h"
#include "editor/rig/rig_transform_tool.h"
#include "editor/ui/icons.h"
#include "editor/viewport/snap.h"

namespace limber::editor {

namespace {

std::string needs_rig_workspace(const Editor& editor) {
  return editor.workspace == Workspace::Rig ? "" : "Works in the Rig workspace";
}

std::string needs_rig_bone(const Editor& editor) {
  const std::string why = needs_rig_workspace(editor);
  return why.empty() ? needs_bone(editor) : why;
}

std::string needs_place(const Editor& editor) {
  const std::string why = needs_rig_workspace(editor);
  return why.empty() ? needs_volume(editor) : why;
}

std::string needs_two(const Editor& editor) {
  if (const std::string why = needs_rig_bone(editor); !why.empty()) return why;
  return editor.selection.bones.size() > 1 ? "" : "Choose the children first, then the parent";
}

std::string needs_rig_in_workspace(const Editor& editor) {
  const std::string why = needs_rig_workspace(editor);
  return !why.empty() || editor.document().armature ? why : "Import a rig first";
}

std::string needs_leaving(const Editor& editor) {
  if (const std::string why = needs_rig_workspace(editor); !why.empty()) return why;
  if (!editor.document().armature || !editor.document().volume) return "Open a volume and a rig first";
  return rig_check(editor)->bones.empty() ? "Every bone lies in tissue" : "";
}

void transform(Editor& editor, RigChange::Kind kind) {
  begin_tool(editor, begin_rig_change(editor, chosen_change(editor, kind)));
}

void extrude(Editor& editor) {
  const RigChange change = extrusion(editor);
  editor.transform_settings->part = TransformSettings::Part::Tail;
  begin_tool(editor, begin_rig_change(editor, change));
}

// At the cross-hair, upward, an eighth of the volume long.
void add(Editor& editor) {
  const Armature armature = editor.document().armature ? *editor.document().armature : Armature{};
  const Box box = world_box(editor.document());
  const glm::dvec3 head = editor.views->cross_hair, tail = head + glm::dvec3(0, 0, (box.high.z - box.low.z) / 8);
  commit_rig(editor, "Add bone", with_bone(armature, "Bone", -1, head, tail),
             {static_cast<int>(armature.bones.size())});
  editor.transform_settings->part = TransformSettings::Part::Tail;
}

// Between the ends of two bones that are nearest to each other, from the one chosen first; from one bone's joint to the
// cross-hair.
void fill(Editor& editor) {
  const std::shared_ptr<const Armature> rig = editor.document().armature;
  const std::vector<int> bones = bones_chosen_last(editor);
  Armature next;
  if (bones.size() == 1) {
    const RigChange change = extrusion(editor);
    const glm::dvec3 to = editor.views->cross_hair;
    if (glm::distance(to, place_of(change.start, change.ends[0])) < 1e-6)
      throw Error("the cross-hair stands on the joint", rig->bones[bones[0]].name,
                  "put it where the bone shall end: Shift and the right button");
    next = with_moved_ends(change.start, change.ends, [&](const glm::dvec3&) { return to; });
  } else {
    BoneEnd from, to;
    double least = 1e300;
    for (const bool first : {true, false})
      for (const bool second : {false, true})
        if (const double gap = glm::distance(place_of(*rig, {bones[0], first}), place_of(*rig, {bones[1], second}));
            gap < least) {
          least = gap;
          from = {bones[0], first};
          to = {bones[1], second};
        }
    next = filled(*rig, from, to);
  }
  const std::vector<int> was = bones_of(*rig, next);
  const int added = static_cast<int>(std::find(was.begin(), was.end(), -1) - was.begin());
  const std::string name = next.bones[added].name;
  editor.transform_settings->part = TransformSettings::Part::Tail;
  commit_rig(editor, "Fill with " + name, mirrored_too(editor, std::move(next)), {added});
}

std::string needs_gap(const Editor& editor) {
  if (const std::string why = needs_rig_bone(editor); !why.empty()) return why;
  if (editor.selection.bones.size() > 2) return "Choose one bone or two";
  return editor.selection.bones.size() == 2 ? "" : needs_volume(editor);
}

void duplicate(Editor& editor) {
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  const std::vector<int> bones = bones_chosen_last(editor);
  RigChange change{RigChange::Kind::Move, naming_chosen(editor, "Duplicate"), duplicated(*armature, bones), {}, {}};
  // The copies stand in the order of their numbers.
  for (int copy = static_cast<int>(armature->bones.size()); copy < std::ssize(change.start.bones); ++copy) {
    change.ends.insert(change.ends.end(), {{copy, false}, {copy, true}});
    change.chosen.push_back(copy);
    // Loose, so that what they are copies of stays.
    if (is_connected(change.start, copy) && change.start.bones[copy].parent < std::ssize(armature->bones))
      change.start.bones[copy].parent = -1;
  }
  editor.transform_settings->part = TransformSettings::Part::Whole;
  begin_tool(editor, begin_rig_change(editor, change));
}

// What stays chosen of `bones` in a rig made from the document's: those of the same names.
std::vector<int> still(const Armature& before, const Armature& after, const std::vector<int>& bones) {
  std::vector<int> found;
  for (const int bone : bones)
    if (const auto place = after.find(before.bones[bone].name)) found.push_back(*place);
  return found;
}

enum class Sides { Chosen, Mirrored };  // the latter where X-mirror is on

template <class Edit>
void edit(Editor& editor, const char* verb, const Edit& change, Sides sides = Sides::Chosen) {
  const std::shared_ptr<const Armature> before = editor.document().armature;
  const std::vector<int> bones = bones_chosen_last(editor);
  Armature next = change(*before, sides == Sides::Mirrored ? with_other_sides(editor, bones) : bones);
  const std::vector<int> left = still(*before, next, bones);
  editor.transform_settings->part = TransformSettings::Part::Whole;
  commit_rig(editor, naming_chosen(editor, verb), std::move(next), left);
}

void hang(Editor& editor, Join join) {
  edit(editor, join == Join::Connected ? "Connect" : "Parent", [&](const Armature&, std::vector<int> bones) {
    const int parent = bones.back();
    bones.pop_back();
    return hung(editor, bones, parent, join);
  });
}

void subdivide(Editor& editor) {
  act_and_allow_redo(editor, {number_of("Parts", "How many bones each chosen one becomes.", 2, 2, 100, "%.0f")},
                     [](Editor& e, const std::vector<FormField>& fields) {
                       edit(
                           e, "Subdivide",
                           [&](const Armature& rig, const std::vector<int>& bones) {
                             return subdivided(rig, bones, static_cast<int>(std::round(fields[0].value)));
                           },
                           Sides::Mirrored);
                     });
}

void symmetrize(Editor& editor) {
  const std::vector<Bone>& all = editor.document().armature->bones;
  const std::vector<int> chosen = bones_chosen_last(editor);
  if (std::none_of(chosen.begin(), chosen.end(), [&](int bone) { return mirrored_name(all[bone].name).has_value(); }))
    throw Error("a bone without a side has no other side", all[chosen.back()].name,
                "give it a name with a side first, as Arm.L or LeftArm");
  act_and_allow_redo(
      editor, {choice_of("From", "The side whose mirror image the other one becomes.", {"Chosen", "Not chosen"})},
      [](Editor& e, const std::vector<FormField>& fields) {
        edit(e, "Symmetrize", [&](const Armature& rig, const std::vector<int>& bones) {
          std::vector<int> from = bones;
          const std::vector<int> pairs = mirror_pairs(rig);
          if (fields[0].chosen == 1)
            for (int& bone : from) bone = pairs[bone];
          return symmetrized(rig, from);
        });
      });
}

// The chosen bones with the limits of that joint, or where it is -1 of what their names mean; `left` are the names of
// those that mean nothing.
Armature with_usual_limits(const Armature& rig, const std::vector<int>& bones, int joint,
                           std::vector<std::string>& left) {
  const auto by_name = usual_joints_of(rig);
  Armature next = rig;
  for (const int bone : bones)
    if (const auto known = joint < 0 ? by_name[bone] : std::optional(joint))
      next.bones[bone].limits = usual_limits(rig, bone, *known);
    else left.push_back(rig.bones[bone].name);
  return next;
}

void ask_motion_range(Editor& editor) {
  std::vector<std::string> joints = usual_joints();
  joints.insert(joints.begin(), "By the bone's name");
  const auto outcome = [](const Editor& e, const std::vector<FormField>& fields) {
    if (const std::string why = needs_rig_bone(e); !why.empty()) throw Error("no bone is chosen", "the rig", why);
    const std::vector<int> bones = bones_chosen_last(e);
    std::vector<std::string> left;
    const Armature next = with_usual_limits(*e.document().armature, bones, fields[0].chosen - 1, left);
    if (left.size() == bones.size())
      throw Error("this bone's name means no joint known", next.bones[bones.back()].name, "choose the joint");
    if (bones.size() == 1) return next.bones[bones[0]].name + ": " + limits_text(next, bones[0]) + ".";
    std::string words = std::to_string(bones.size() - left.size()) + " of " + std::to_string(bones.size()) + " bones";
    for (std::size_t i = 0; i < left.size(); ++i) words += (i == 0 ? "; names that mean no joint: " : ", ") + left[i];
    return words + ".";
  };
  const auto act = [](Editor& e, const std::vector<FormField>& fields) {
    const std::vector<int> bones = bones_chosen_last(e);
    std::vector<std::string> left;
    commit_rig(e, naming_chosen(e, "Range of motion of"),
               mirrored_too(e, with_usual_limits(*e.document().armature, bones, fields[0].chosen - 1, left)), bones);
  };
  editor.open_dialog(
      make_form({"Range of motion",
                 "Gives the joints at the heads of the chosen bones the range that is usual for an adult.",
                 "Set limits",
                 {choice_of("Joint", "Ranges of the American Academy of Orthopaedic Surgeons.", joints)},
                 outcome,
                 act}));
}

NameChange name_change(const std::vector<FormField>& fields) {
  return {.find = fields[1].text,
          .replace = fields[2].text,
          .other_side = fields[5].chosen == 1,
          .prefix = fields[3].text,
          .suffix = fields[4].text};
}

std::vector<int> bones_to_rename(const Editor& editor, const std::vector<FormField>& fields) {
  std::vector<int> bones(editor.document().armature->bones.size());
  std::iota(bones.begin(), bones.end(), 0);
  if (fields[0].chosen == 0) std::erase_if(bones, [&](int bone) { return !editor.selection.bones.contains(bone); });
  return bones;
}

void ask_names(Editor& editor) {
  const auto outcome = [](const Editor& e, const std::vector<FormField>& fields) {
    const Armature& before = *e.document().armature;
    const Armature next = with_names_changed(before, bones_to_rename(e, fields), name_change(fields));
    int count = 0;
    std::string first;
    for (std::size_t bone = 0; bone < next.bones.size(); ++bone)
      if (next.bones[bone].name != before.bones[bone].name && count++ == 0)
        first = before.bones[bone].name + " becomes " + next.bones[bone].name;
    if (count == 0) throw NotYet{"Fill in what is to change."};
    return first + (count == 1 ? "." : ", and " + std::to_string(count - 1) + " more change.");
  };
  const auto act = [](Editor& e, const std::vector<FormField>& fields) {
    const std::vector<int> bones = bones_to_rename(e, fields);
    commit_names(e,
                 bones.size() == 1 ? "Rename " + e.document().armature->bones[bones[0]].name
                                   : "Rename " + std::to_string(bones.size()) + " bones",
                 with_names_changed(*e.document().armature, bones, name_change(fields)),
                 e.selection.bone ? bones_chosen_last(e) : std::vector<int>{});
  };
  editor.open_dialog(make_form(
      {"Rename bones",
       "Changes the names of many bones at once; all that is theirs follows: weights, poses, keys, motions, pins.",
       "Rename",
       {choice_of("Bones", "Whose names change.", {"Chosen", "All"}, editor.selection.bones.empty() ? 1 : 0),
        text_of("Find", "What is looked for in each name.", ""),
        text_of("Replace with", "What stands there instead.", ""), text_of("Prefix", "Before each name.", ""),
        text_of("Suffix", "Behind each name.", ""),
        choice_of("Side", "Left becomes right and right left: Arm.L is Arm.R then.", {"Stays", "The other"})},
       outcome,
       act}));
}

Operator edit_operator(const char* id, const char* label, const char* icon, const char* description, const char* verb,
                       Armature (*change)(const Armature&, const std::vector<int>&), Sides sides = Sides::Mirrored) {
  return {id,
          label,
          icon,
          "Bone",
          description,
          [verb, change, sides](Editor& e) { edit(e, verb, change, sides); },
          needs_rig_bone};
}

// The chosen joint, or both ends of every chosen bone, each to where `to` takes it.
void put_joints(Editor& editor, const char* verb,
                const std::function<std::optional<glm::dvec3>(const Bone&, const glm::dvec3&)>& to) {
  const std::shared_ptr<const Armature> rig = editor.document().armature;
  const std::vector<int> bones = bones_chosen_last(editor);
  Armature next = *rig;
  bool any = false;
  for (const BoneEnd& end : chosen_change(editor, RigChange::Kind::Move).ends)
    if (const auto place = to(rig->bones[end.bone], place_of(*rig, end))) {
      next = with_moved_ends(next, {end}, [&](const glm::dvec3&) { return *place; });
      any = true;
    }
  if (!any)
    throw Error("no bone tissue lies there", naming_chosen(editor, "joints of"), "move the joint into a bone first");
  commit_rig(editor, naming_chosen(editor, verb), mirrored_too(editor, std::move(next)), bones);
}

void joints_to_bone(Editor& editor) {
  put_joints(editor, "To bone middle:", [&](const Bone& bone, const glm::dvec3& place) {
    const glm::dmat3 axes = rest_axes(bone);
    return middle_of_bone(editor.document(), place, axes[0], axes[2]);
  });
}

void joints_to_voxels(Editor& editor) {
  put_joints(editor, "To voxel:", [&](const Bone&, const glm::dvec3& place) {
    return nearest_voxel(editor.document(), place);
  });
}

const glm::dvec3& chosen_joint(const Editor& editor) {
  return place_of(*editor.document().armature,
                  {*editor.selection.bone, editor.transform_settings->part == TransformSettings::Part::Tail});
}

// A whole bone keeps its length and direction.
void joint_to_cross_hair(Editor& editor) {
  const glm::dvec3 by = editor.views->cross_hair - chosen_joint(editor);
  const RigChange change = chosen_change(editor, RigChange::Kind::Move);
  commit_rig(
      editor, naming_chosen(editor, "To cross-hair:"),
      mirrored_too(editor, with_moved_ends(change.start, change.ends, [&](const glm::dvec3& p) { return p + by; })),
      change.chosen);
}

void cross_hair_to_joint(Editor& editor) {
  const Box box = world_box(editor.document());
  editor.views->cross_hair = glm::clamp(chosen_joint(editor), box.low, box.high);
}

std::string needs_joint_in_volume(const Editor& editor) {
  const std::string why = needs_rig_bone(editor);
  return why.empty() ? needs_volume(editor) : why;
}

Operator snap_operator(const char* id, const char* label, const char* description, Snap snap) {
  return {id,          label,
          icon::kSnap, "Bone",
          description, [snap](Editor& e) { e.transform_settings->snap = snap; },
          nullptr,     [snap](const Editor& e) { return e.transform_settings->snap == snap; }};
}

}  // namespace

std::vector<Operator> rig_operators() {
  return {
      {"rig.move", "Move", icon::kMove, "Bone",
       "The chosen joint or bones go with the pointer; what is connected follows.",
       [](Editor& e) { transform(e, RigChange::Kind::Move); }, needs_rig_bone},
      {"rig.rotate", "Rotate", icon::kRotate, "Bone", "Turns the chosen bones about the active one's head.",
       [](Editor& e) { transform(e, RigChange::Kind::Turn); }, needs_rig_bone},
      {"rig.scale", "Scale", icon::kScale, "Bone", "Lengthens or shortens the chosen bones from the active one's head.",
       [](Editor& e) { transform(e, RigChange::Kind::Scale); }, needs_rig_bone},
      {"rig.roll", "Roll", "", "Bone", "Turns the chosen bones about themselves.",
       [](Editor& e) { transform(e, RigChange::Kind::Roll); }, needs_rig_bone},
      {"rig.add", "Add bone", icon::kAdd, "Bone", "A new bone at the cross-hair.", add, needs_place},
      {"rig.extrude", "Extrude", icon::kExtrude, "Bone", "A new bone grows from the chosen joint with the pointer.",
       extrude, needs_rig_bone},
      {"rig.fill", "Fill", "", "Bone", "A bone between two chosen ones, or from the chosen joint to the cross-hair.",
       fill, needs_gap},
      {"rig.duplicate", "Duplicate", icon::kDuplicate, "Bone", "Copies of the chosen bones go with the pointer.",
       duplicate, needs_rig_bone},
      {"rig.subdivide", "Subdivide", "", "Bone", "Each chosen bone becomes two, or more by adjusting it.", subdivide,
       needs_rig_bone},
      edit_operator("rig.delete", "Delete", icon::kTrash,
                    "Takes the chosen bones away; what hung on them hangs on the next one above.", "Delete",
                    without_bones),
      edit_operator("rig.dissolve", "Dissolve", "",
                    "Takes the chosen bones away and lengthens those above, so that the chain stays whole.", "Dissolve",
                    dissolved),
      edit_operator("rig.separate", "Separate", icon::kCut, "Cuts the chosen bones loose from the others.", "Separate",
                    separated),
      {"rig.parent", "Make parent", "", "Bone", "The chosen bones hang on the active one, where they are.",
       [](Editor& e) { hang(e, Join::KeepOffset); }, needs_two},
      {"rig.connect", "Connect to parent", icon::kLinkViews, "Bone",
       "The chosen bones hang on the active one and move to its tail.", [](Editor& e) { hang(e, Join::Connected); },
       needs_two},
      edit_operator("rig.clear_parent", "Clear parent", "", "The chosen bones hang on nothing.", "Clear parent of",
                    unparented),
      edit_operator("rig.flip_direction", "Flip direction", "",
                    "Head and tail of the chosen bones change places; a chain runs the other way.", "Flip direction of",
                    with_flipped_direction),
      {"rig.mirror", "Mirror", icon::kMirror, "Bone",
       "The chosen bones go to the other side, with their weights and keys.",
       [](Editor& e) { mirror_bones(e, bones_chosen_last(e), naming_chosen(e, "Mirror")); }, needs_rig_bone},
      {"rig.symmetrize", "Symmetrize", icon::kMirror, "Bone",
       "The other side of the chosen bones becomes their mirror image; what is missing there is added.", symmetrize,
       needs_rig_bone},
      {"rig.recalculate_roll", "Recalculate roll", "", "Bone", "The chosen bones' own z axes look forward.",
       [](Editor& e) {
         edit(
             e, "Recalculate roll of",
             [](const Armature& rig, const std::vector<int>& bones) {
               return with_z_towards(rig, bones, {0, -1, 0});
             },
             Sides::Mirrored);
       },
       needs_rig_bone},
      {"rig.motion_range", "Range of motion...", "", "Bone",
       "Limits that are usual for a joint, by its name or as chosen.", ask_motion_range, needs_rig_bone},
      {"rig.batch_rename", "Rename bones...", icon::kRename, "Bone",
       "Changes the names of many bones: replaces, prefixes, suffixes, sides.", ask_names, needs_rig_in_workspace},
      {"rig.snap_pie", "Snap menu", icon::kSnap, "Bone", "Lists what joints snap to, at the pointer.",
       [](Editor& e) { e.open_popup = "Snap"; }, needs_rig_workspace},
      {"rig.joints_to_bone", "Joint to bone middle", "", "Bone",
       "The chosen joints go to the middle of the bone tissue around them, across their bone.", joints_to_bone,
       needs_joint_in_volume},
      {"rig.joints_to_voxels", "Joint to voxel", "", "Bone",
       "The chosen joints go to the centres of the voxels nearest to them.", joints_to_voxels, needs_joint_in_volume},
      {"rig.joint_to_cross_hair", "Joint to cross-hair", icon::kCrossHair, "Bone",
       "The chosen joint or bones go to where the slices meet.", joint_to_cross_hair, needs_joint_in_volume},
      {"rig.cross_hair_to_joint", "Cross-hair to joint", icon::kCrossHair, "Bone",
       "The slices go through the chosen joint.", cross_hair_to_joint, needs_joint_in_volume},
      {"rig.next_leaving", "Next bone outside tissue", "", "Bone", "Goes to the next bone that leaves the tissue.",
       show_next_leaving, needs_leaving},
      {"view.rig_check", "Where the rig leaves tissue", "", "View",
       "Marks bones and joints outside of tissue in the Rig workspace.",
       [](Editor& e) { e.transform_settings->rig_check_marks = !e.transform_settings->rig_check_marks; }, nullptr,
       [](const Editor& e) { return e.transform_settings->rig_check_marks; }},
      {"rig.snap", "Snap without Ctrl", icon::kSnap, "Bone", "Transforms snap without Ctrl, and with Ctrl they do not.",
       [](Editor& e) { e.transform_settings->snapping = !e.transform_settings->snapping; }, nullptr,
       [](const Editor& e) { return e.transform_settings->snapping; }},
      snap_operator("snap.steps", "Snap to steps", "Of 5 mm, 5 degrees or a tenth; with Shift finer.", Snap::Steps),
      snap_operator("snap.voxel", "Snap to voxels", "A moved joint goes to the centre of the nearest voxel.",
                    Snap::Voxel),
      snap_operator("snap.joint", "Snap to joints", "A moved joint goes where another one is.", Snap::Joint),
      snap_operator("snap.bone_middle", "Bone middle",
                    "A moved joint goes to the middle of the bone tissue under the pointer.", Snap::BoneMiddle),
  };
}

}  // namespace limber::editor
