// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that edit the rig in its rest pose.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/project/job.h"
#include "core/rig/joint_ranges.h"
#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/transform_settings.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/rig/rig_check.h"
#include "editor/rig/rig_edits.h"
#include "editor/rig/rig_transform_tool.h"
#include "editor/ui/icons.h"
#include "editor/viewport/snap.h"

namespace limber::editor {

namespace {

std::string needs_rig_workspace(const Context& context) {
  return context.workspace() == Workspace::Rig ? "" : "Switch to the Rig workspace first";
}

std::string needs_rig_bone(const Context& context) {
  const std::string why = needs_rig_workspace(context);
  return why.empty() ? needs_bone(context) : why;
}

std::string needs_place(const Context& context) {
  const std::string why = needs_rig_workspace(context);
  return why.empty() ? needs_volume(context) : why;
}

std::string needs_two(const Context& context) {
  if (const std::string why = needs_rig_bone(context); !why.empty()) return why;
  return context.selection->bones.size() > 1 ? "" : "Select the children first, then the parent";
}

std::string needs_rig_in_workspace(const Context& context) {
  const std::string why = needs_rig_workspace(context);
  return !why.empty() || context.document().armature ? why : "Import a rig first";
}

std::string needs_leaving(const Context& context) {
  if (const std::string why = needs_rig_workspace(context); !why.empty()) return why;
  if (!context.document().armature || !context.document().volume) return "Open a volume and a rig first";
  return rig_check(context)->bones.empty() ? "Every bone lies in tissue" : "";
}

void transform(Context& context, RigChange::Kind kind) {
  begin_tool(context, begin_rig_change(context, chosen_change(context, kind)));
}

void extrude(Context& context) {
  const RigChange change = extrusion(context);
  context.transform_settings->part = TransformSettings::Part::Tail;
  begin_tool(context, begin_rig_change(context, change));
}

// Adds a bone that points up from the cross-hair. The bone's length is an eighth of the volume's height.
void add(Context& context) {
  const Armature armature = context.document().armature ? *context.document().armature : Armature{};
  const Box box = world_box(context.document());
  const glm::dvec3 head = context.views->cross_hair, tail = head + glm::dvec3(0, 0, (box.high.z - box.low.z) / 8);
  commit_rig(context, "Add bone", with_bone(armature, "Bone", -1, head, tail),
             {static_cast<int>(armature.bones.size())});
  context.transform_settings->part = TransformSettings::Part::Tail;
}

// Adds a bone that fills a gap. With two selected bones, the new bone connects their nearest ends, with its tail at the
// active bone. With one selected bone, the new bone reaches from the selected end to the cross-hair.
void fill(Context& context) {
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const std::vector<int> bones = bones_chosen_last(context);
  Armature next;
  if (bones.size() == 1) {
    const RigChange change = extrusion(context);
    const glm::dvec3 to = context.views->cross_hair;
    if (glm::distance(to, place_of(change.start, change.ends[0])) < 1e-6)
      throw Error("the cross-hair is at the joint", rig->bones[bones[0]].name,
                  "move the cross-hair to where the bone should end: Shift and the right mouse button");
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
  context.transform_settings->part = TransformSettings::Part::Tail;
  commit_rig(context, "Fill gap with bone " + name, mirrored_too(context, std::move(next)), {added});
}

std::string needs_gap(const Context& context) {
  if (const std::string why = needs_rig_bone(context); !why.empty()) return why;
  if (context.selection->bones.size() > 2) return "Select one bone or two";
  return context.selection->bones.size() == 2 ? "" : needs_volume(context);
}

void duplicate(Context& context) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  const std::vector<int> bones = bones_chosen_last(context);
  RigChange change{RigChange::Kind::Move, naming_chosen(context, "Duplicate"), duplicated(*armature, bones), {}, {}};
  // The copies are the last bones of change.start, because duplicated() appends them to the rig's bones.
  for (int copy = static_cast<int>(armature->bones.size()); copy < std::ssize(change.start.bones); ++copy) {
    change.ends.insert(change.ends.end(), {{copy, false}, {copy, true}});
    change.chosen.push_back(copy);
    // A copy whose head lies on the tail of an original bone loses its parent, because moving the copy would otherwise
    // move the original's tail too.
    if (is_connected(change.start, copy) && change.start.bones[copy].parent < std::ssize(armature->bones))
      change.start.bones[copy].parent = -1;
  }
  context.transform_settings->part = TransformSettings::Part::Whole;
  begin_tool(context, begin_rig_change(context, change));
}

// Returns the indices of the bones in the rig `after` that have the names of `bones` in the rig `before`.
std::vector<int> still(const Armature& before, const Armature& after, const std::vector<int>& bones) {
  std::vector<int> found;
  for (const int bone : bones)
    if (const auto place = after.find(before.bones[bone].name)) found.push_back(*place);
  return found;
}

// The bones that an edit changes. Chosen: the selected bones. Mirrored: with X-mirror on, also their counterparts on
// the other side of the body.
enum class Sides { Chosen, Mirrored };

template <class Edit>
void edit(Context& context, const char* verb, const Edit& change, Sides sides = Sides::Chosen) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  const std::vector<int> bones = bones_chosen_last(context);
  Armature next = change(*before, sides == Sides::Mirrored ? with_other_sides(context, bones) : bones);
  const std::vector<int> left = still(*before, next, bones);
  context.transform_settings->part = TransformSettings::Part::Whole;
  commit_rig(context, naming_chosen(context, verb), std::move(next), left);
}

void hang(Context& context, Join join) {
  edit(context, join == Join::Connected ? "Connect" : "Parent", [&](const Armature&, std::vector<int> bones) {
    const int parent = bones.back();
    bones.pop_back();
    return hung(context, bones, parent, join);
  });
}

void subdivide(Context& context) {
  act_and_allow_redo(
      context, {number_of("Parts", "Number of bones into which each selected bone is divided.", 2, 2, 100, "%.0f")},
      [](Context& c, const std::vector<FormField>& fields) {
        edit(
            c, "Subdivide",
            [&](const Armature& rig, const std::vector<int>& bones) {
              return subdivided(rig, bones, static_cast<int>(std::round(fields[0].value)));
            },
            Sides::Mirrored);
      });
}

void symmetrize(Context& context) {
  const std::vector<Bone>& all = context.document().armature->bones;
  const std::vector<int> chosen = bones_chosen_last(context);
  if (std::none_of(chosen.begin(), chosen.end(), [&](int bone) { return mirrored_name(all[bone].name).has_value(); }))
    throw Error("the bone's name has no side", all[chosen.back()].name,
                "first give it a name that contains a side, such as Arm.L or LeftArm");
  act_and_allow_redo(context,
                     {choice_of("From side", "The side that is copied to the other side as its mirror image.",
                                {"Selected", "Not selected"})},
                     [](Context& c, const std::vector<FormField>& fields) {
                       edit(c, "Symmetrize", [&](const Armature& rig, const std::vector<int>& bones) {
                         std::vector<int> from = bones;
                         const std::vector<int> pairs = mirror_pairs(rig);
                         if (fields[0].chosen == 1)
                           for (int& bone : from) bone = pairs[bone];
                         return symmetrized(rig, from);
                       });
                     });
}

// Returns the rig in which the bones have the usual limits of a joint.
//   joint  index into usual_joints(); -1: each bone gets the limits of the joint that its name denotes
//   left   receives the names of the bones whose name denotes no known joint; these bones stay unchanged
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

void ask_motion_range(Context& context) {
  std::vector<std::string> joints = usual_joints();
  joints.insert(joints.begin(), "By the bone's name");
  const auto outcome = [](const Context& c, const std::vector<FormField>& fields) {
    if (const std::string why = needs_rig_bone(c); !why.empty()) throw Error("no bone is selected", "the rig", why);
    const std::vector<int> bones = bones_chosen_last(c);
    std::vector<std::string> left;
    const Armature next = with_usual_limits(*c.document().armature, bones, fields[0].chosen - 1, left);
    if (left.size() == bones.size())
      throw Error("no joint is known for this bone's name", next.bones[bones.back()].name, "select the joint");
    if (bones.size() == 1) return next.bones[bones[0]].name + ": " + limits_text(next, bones[0]) + ".";
    std::string words = std::to_string(bones.size() - left.size()) + " of " + std::to_string(bones.size()) + " bones";
    for (std::size_t i = 0; i < left.size(); ++i) words += (i == 0 ? "; names that match no joint: " : ", ") + left[i];
    return words + ".";
  };
  const auto act = [](Context& c, const std::vector<FormField>& fields) {
    const std::vector<int> bones = bones_chosen_last(c);
    std::vector<std::string> left;
    commit_rig(c, naming_chosen(c, "Set range of motion of"),
               mirrored_too(c, with_usual_limits(*c.document().armature, bones, fields[0].chosen - 1, left)), bones);
  };
  context.dialogs->open(make_form(
      {"Range of motion",
       "Limits the joints at the heads of the selected bones to the usual range of motion of an adult.",
       "Set limits",
       {choice_of("Joint",
                  "The joint whose range is used, as published by the American Academy of Orthopaedic Surgeons.",
                  joints)},
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

std::vector<int> bones_to_rename(const Context& context, const std::vector<FormField>& fields) {
  std::vector<int> bones(context.document().armature->bones.size());
  std::iota(bones.begin(), bones.end(), 0);
  if (fields[0].chosen == 0) std::erase_if(bones, [&](int bone) { return !context.selection->bones.contains(bone); });
  return bones;
}

void ask_names(Context& context) {
  const auto outcome = [](const Context& c, const std::vector<FormField>& fields) {
    const Armature& before = *c.document().armature;
    const Armature next = with_names_changed(before, bones_to_rename(c, fields), name_change(fields));
    int count = 0;
    std::string first;
    for (std::size_t bone = 0; bone < next.bones.size(); ++bone)
      if (next.bones[bone].name != before.bones[bone].name && count++ == 0)
        first = before.bones[bone].name + " becomes " + next.bones[bone].name;
    if (count == 0) throw NotYet{"Enter at least one change."};
    return first + (count == 1 ? "." : ", and " + std::to_string(count - 1) + " more change.");
  };
  const auto act = [](Context& c, const std::vector<FormField>& fields) {
    const std::vector<int> bones = bones_to_rename(c, fields);
    commit_names(c,
                 bones.size() == 1 ? "Rename " + c.document().armature->bones[bones[0]].name
                                   : "Rename " + std::to_string(bones.size()) + " bones",
                 with_names_changed(*c.document().armature, bones, name_change(fields)),
                 c.selection->bone ? bones_chosen_last(c) : std::vector<int>{});
  };
  context.dialogs->open(make_form(
      {"Rename bones",
       "Changes the names of many bones at once. Their weights, poses, keys, motions and pins are kept.",
       "Rename",
       {choice_of("Bones", "The bones to rename.", {"Selected", "All"}, context.selection->bones.empty() ? 1 : 0),
        text_of("Find", "The text to find in each name.", ""),
        text_of("Replace with", "The text that replaces the found text.", ""),
        text_of("Prefix", "Text added before each name.", ""), text_of("Suffix", "Text added after each name.", ""),
        choice_of("Side", "Whether to swap left and right in the names: Arm.L becomes Arm.R.", {"Keep", "Swap"})},
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
          [verb, change, sides](Context& c) { edit(c, verb, change, sides); },
          needs_rig_bone};
}

// Moves the selected joint, or both ends of every selected bone. Throws Error when no end has a new position.
//   to  called with a bone and the current position of one of its ends, mm. Returns the end's new position, or nothing
//       for an end that keeps its position
void put_joints(Context& context, const char* verb,
                const std::function<std::optional<glm::dvec3>(const Bone&, const glm::dvec3&)>& to) {
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const std::vector<int> bones = bones_chosen_last(context);
  Armature next = *rig;
  bool any = false;
  for (const BoneEnd& end : chosen_change(context, RigChange::Kind::Move).ends)
    if (const auto place = to(rig->bones[end.bone], place_of(*rig, end))) {
      next = with_moved_ends(next, {end}, [&](const glm::dvec3&) { return *place; });
      any = true;
    }
  if (!any)
    throw Error("no bone tissue lies there", naming_chosen(context, "joints of"), "move the joint into a bone first");
  commit_rig(context, naming_chosen(context, verb), mirrored_too(context, std::move(next)), bones);
}

void joints_to_bone(Context& context) {
  put_joints(context, "Move to bone middle:", [&](const Bone& bone, const glm::dvec3& place) {
    const glm::dmat3 axes = rest_axes(bone);
    return middle_of_bone(context.document(), place, axes[0], axes[2]);
  });
}

void joints_to_voxels(Context& context) {
  put_joints(context, "Move to voxel:", [&](const Bone&, const glm::dvec3& place) {
    return nearest_voxel(context.document(), place);
  });
}

const glm::dvec3& chosen_joint(const Context& context) {
  return place_of(*context.document().armature,
                  {*context.selection->bone, context.transform_settings->part == TransformSettings::Part::Tail});
}

// Moves the selected joint, or the selected bones as a whole, to the cross-hair. Whole bones keep length and direction.
void joint_to_cross_hair(Context& context) {
  const glm::dvec3 by = context.views->cross_hair - chosen_joint(context);
  const RigChange change = chosen_change(context, RigChange::Kind::Move);
  commit_rig(
      context, naming_chosen(context, "Move to cross-hair:"),
      mirrored_too(context, with_moved_ends(change.start, change.ends, [&](const glm::dvec3& p) { return p + by; })),
      change.chosen);
}

void cross_hair_to_joint(Context& context) {
  const Box box = world_box(context.document());
  context.views->cross_hair = glm::clamp(chosen_joint(context), box.low, box.high);
}

std::string needs_joint_in_volume(const Context& context) {
  const std::string why = needs_rig_bone(context);
  return why.empty() ? needs_volume(context) : why;
}

Operator snap_operator(const char* id, const char* label, const char* description, Snap snap) {
  return {id,          label,
          icon::kSnap, "Bone",
          description, [snap](Context& c) { c.transform_settings->snap = snap; },
          nullptr,     [snap](const Context& c) { return c.transform_settings->snap == snap; }};
}

}  // namespace

std::vector<Operator> rig_operators() {
  return {
      {"rig.move", "Move", icon::kMove, "Bone",
       "Move the selected joint or bones with the pointer. Connected bones follow.",
       [](Context& c) { transform(c, RigChange::Kind::Move); }, needs_rig_bone},
      {"rig.rotate", "Rotate", icon::kRotate, "Bone", "Turn the selected bones about the head of the active bone.",
       [](Context& c) { transform(c, RigChange::Kind::Turn); }, needs_rig_bone},
      {"rig.scale", "Scale", icon::kScale, "Bone", "Scale the selected bones from the head of the active bone.",
       [](Context& c) { transform(c, RigChange::Kind::Scale); }, needs_rig_bone},
      {"rig.roll", "Roll", "", "Bone", "Turn the selected bones about their own axes.",
       [](Context& c) { transform(c, RigChange::Kind::Roll); }, needs_rig_bone},
      {"rig.add", "Add bone", icon::kAdd, "Bone", "Add a bone at the cross-hair.", add, needs_place},
      {"rig.extrude", "Extrude", icon::kExtrude, "Bone",
       "Add a bone at the selected joint and move its tail with the pointer.", extrude, needs_rig_bone},
      {"rig.fill", "Fill", "", "Bone",
       "Add a bone between two selected bones, or from the selected joint to the cross-hair.", fill, needs_gap},
      {"rig.duplicate", "Duplicate", icon::kDuplicate, "Bone",
       "Copy the selected bones and move the copies with the pointer.", duplicate, needs_rig_bone},
      {"rig.subdivide", "Subdivide", "", "Bone",
       "Divide each selected bone into two. Adjust last operation divides it into more.", subdivide, needs_rig_bone},
      edit_operator("rig.delete", "Delete", icon::kTrash,
                    "Delete the selected bones. Their children are attached to the next bone above.", "Delete",
                    without_bones),
      edit_operator("rig.dissolve", "Dissolve", "",
                    "Delete the selected bones and lengthen their parents, so that the chain stays connected.",
                    "Dissolve", dissolved),
      edit_operator("rig.separate", "Separate", icon::kCut, "Detach the selected bones from all other bones.",
                    "Separate", separated),
      {"rig.parent", "Make parent", "", "Bone",
       "Make the active bone the parent of the selected bones, without moving them.",
       [](Context& c) { hang(c, Join::KeepOffset); }, needs_two},
      {"rig.connect", "Connect to parent", icon::kLinkViews, "Bone",
       "Make the active bone the parent of the selected bones and move them to its tail.",
       [](Context& c) { hang(c, Join::Connected); }, needs_two},
      edit_operator("rig.clear_parent", "Clear parent", "", "Remove the parent of the selected bones.",
                    "Clear parent of", unparented),
      edit_operator("rig.flip_direction", "Flip direction", "",
                    "Swap head and tail of the selected bones. A chain then runs the other way.", "Flip direction of",
                    with_flipped_direction),
      {"rig.mirror", "Mirror bones", icon::kMirror, "Bone",
       "Move the selected bones to the other side of the body, with their weights and keys.",
       [](Context& c) { mirror_bones(c, bones_chosen_last(c), naming_chosen(c, "Mirror")); }, needs_rig_bone},
      {"rig.symmetrize", "Symmetrize", icon::kMirror, "Bone",
       "Make the other side a mirror image of the selected bones. Bones that are missing there are added.", symmetrize,
       needs_rig_bone},
      {"rig.recalculate_roll", "Recalculate roll", "", "Bone",
       "Roll the selected bones so that their z axes point forward.",
       [](Context& c) {
         edit(
             c, "Recalculate roll of",
             [](const Armature& rig, const std::vector<int>& bones) {
               return with_z_towards(rig, bones, {0, -1, 0});
             },
             Sides::Mirrored);
       },
       needs_rig_bone},
      {"rig.motion_range", "Range of motion...", "", "Bone",
       "Limit the selected bones' joints to an adult's usual range. Each joint is found by its bone's name, or you "
       "select it.",
       ask_motion_range, needs_rig_bone},
      {"rig.batch_rename", "Rename bones...", icon::kRename, "Bone",
       "Change the names of many bones: replace text, add a prefix or suffix, swap left and right.", ask_names,
       needs_rig_in_workspace},
      {"rig.snap_pie", "Snap menu", icon::kSnap, "Bone",
       "Open a menu at the pointer in which you select what moved joints snap to.",
       [](Context& c) { c.menus->open_popup = "Snap"; }, needs_rig_workspace},
      {"rig.joints_to_bone", "Joint to bone middle", "", "Bone",
       "Centre each selected joint in the bone tissue around it, by moving it at right angles to its bone.",
       joints_to_bone, needs_joint_in_volume},
      {"rig.joints_to_voxels", "Joint to voxel", "", "Bone",
       "Move the selected joints to the centres of the nearest voxels.", joints_to_voxels, needs_joint_in_volume},
      {"rig.joint_to_cross_hair", "Joint to cross-hair", icon::kCrossHair, "Bone",
       "Move the selected joint or bones to the point where the slices meet.", joint_to_cross_hair,
       needs_joint_in_volume},
      {"rig.cross_hair_to_joint", "Cross-hair to joint", icon::kCrossHair, "Bone",
       "Move the cross-hair and the slices to the selected joint.", cross_hair_to_joint, needs_joint_in_volume},
      {"rig.next_leaving", "Next bone outside tissue", "", "Bone",
       "Select and show the next bone that lies partly outside the tissue.", show_next_leaving, needs_leaving},
      {"view.rig_check", "Bones outside tissue", "", "View",
       "Mark bones and joints outside the tissue in the Rig workspace.",
       [](Context& c) { c.transform_settings->rig_check_marks = !c.transform_settings->rig_check_marks; }, nullptr,
       [](const Context& c) { return c.transform_settings->rig_check_marks; }},
      {"rig.snap", "Snap without Ctrl", icon::kSnap, "Bone",
       "Snap while moving, rotating and scaling. Hold Ctrl to move freely.",
       [](Context& c) { c.transform_settings->snapping = !c.transform_settings->snapping; }, nullptr,
       [](const Context& c) { return c.transform_settings->snapping; }},
      snap_operator("snap.steps", "Snap to steps",
                    "Snap to steps of 5 mm, 5 degrees or a factor of 0.1; finer with Shift.", Snap::Steps),
      snap_operator("snap.voxel", "Snap to voxels", "Snap a moved joint to the centre of the nearest voxel.",
                    Snap::Voxel),
      snap_operator("snap.joint", "Snap to joints", "Snap a moved joint to another joint.", Snap::Joint),
      snap_operator("snap.bone_middle", "Bone middle",
                    "Snap a moved joint to the middle of the bone tissue under the pointer.", Snap::BoneMiddle),
  };
}

}  // namespace limber::editor
