// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/constraint_edits.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/apply_constraints.h"
#include "core/motion/body_frame.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/input/keymap_overrides.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr std::int64_t kMostFrames = 100'000;  // constraints are not baked into keys if the range has more frames
constexpr double kInFrontMm = 300;             // distance from the bone to the target of a new aim constraint

void change_list(Clip& clip, const std::function<void(Constraints&)>& change) {
  Constraints constraints = clip.constraints ? *clip.constraints : Constraints{};
  change(constraints);
  clip.constraints = std::make_shared<const Constraints>(std::move(constraints));
}

Constraint& named(Constraints& constraints, const std::string& name) {
  const auto found = std::find_if(constraints.list.begin(), constraints.list.end(),
                                  [&](const Constraint& constraint) { return constraint.name == name; });
  if (found == constraints.list.end())
    throw Error("the constraint was removed meanwhile", name, "add the constraint again");
  return *found;
}

// Throws Error if the constraint cannot be applied together with the other constraints.
void require_applicable(const Document& document, const Constraints& constraints, const std::string& name) {
  const ConstraintStack stack(std::make_shared<const Constraints>(constraints), document.armature);
  for (std::size_t i = 0; i < constraints.list.size(); ++i)
    if (constraints.list[i].name == name) stack.require_applied(i);
}

// Returns the initial target position of a constraint in the document's pose: the planted point of a hand or foot, a
// point in front of a bone that aims, otherwise the bone's tail.
glm::dvec3 end_of(const Constraint& constraint, const Armature& armature, const PosedRig& rig, int bone) {
  if (constraint.kind == ConstraintKind::Plant)
    return planted_point(on_rig(constraint, armature, planted_limbs(armature)), rig);
  if (constraint.kind != ConstraintKind::Aim) return rig.tail(bone);
  const int aim = static_cast<int>(constraint.aim);
  const glm::dvec3 axis = (aim % 2 == 0 ? 1.0 : -1.0) * rest_axes(armature.bones[bone])[aim / 2];
  return rig.tail(bone) + kInFrontMm * (rig.turn(bone) * axis);
}

// Gives the constraint a target that does not change the pose: the bone already reaches the target or points at it.
void place_target(Constraint& constraint, const Armature& armature, const Pose& pose) {
  const ConstraintTarget needed = constraint_rule(constraint.kind).target;
  if (needed != ConstraintTarget::Place) return;
  const PosedRig rig(armature, pose);
  const int bone = require_bone(armature, constraint.bone);
  const bool on_bone = !constraint.target.empty();
  const int target = on_bone ? require_bone(armature, constraint.target) : -1;
  // The target position is the limb's current position; if there is a target bone, it is stored in that bone's
  // coordinates. A bone that aims at another bone gets that bone's tail as its target position.
  const glm::dvec3 place =
      on_bone && constraint.kind == ConstraintKind::Aim ? rig.tail(target) : end_of(constraint, armature, rig, bone);
  constraint.place = on_bone ? inverse(rig.posed(target)) * place : place;
  const glm::dquat frame = on_bone ? rig.turn(target) : glm::dquat(1, 0, 0, 0);
  constraint.rotation = glm::normalize(glm::conjugate(frame) * rig.turn(bone));
}

// Returns the axis with which a bone aims at a target. This is the bone's own +y axis, which runs along the bone. A
// head aims with its x, y or z axis that points most nearly to the front at rest.
BoneAxis looking_axis(const Armature& armature, int bone) {
  const auto role = skeleton_of(armature).role[static_cast<std::size_t>(bone)];
  if (!role || role->part != BodyPart::Head) return BoneAxis::PlusY;
  const glm::dvec3 front = glm::transpose(rest_axes(armature.bones[bone])) * glm::dvec3(0, -1, 0);
  int axis = 0;
  for (const int other : {1, 2})
    if (std::abs(front[other]) > std::abs(front[axis])) axis = other;
  return static_cast<BoneAxis>(2 * axis + (front[axis] < 0 ? 1 : 0));
}

std::optional<int> other_bone(const Selection& selection) {
  std::optional<int> other;
  for (const int bone : selection.bones)
    if (bone != selection.bone) {
      if (other) return std::nullopt;
      other = bone;
    }
  return other;
}

void show_changed(Context& context, const std::function<void(Clip&)>& change) {
  stop_playing(context);
  settle_frame(context);
  const ClipOnRig* on_rig = clip_on_rig(context);
  if (!on_rig) return;
  Clip clip = *on_rig->clip();
  change(clip);
  const ClipOnRig changed(std::make_shared<const Clip>(std::move(clip)), on_rig->armature(), on_rig);
  show_pose(context, constrained_pose(changed, unconstrained_pose(context), context.document().frame));
}

// Moves the constraint at index `from` to index `to`. The constraints between them move by one index.
void move_in_list(std::vector<Constraint>& list, std::size_t from, std::size_t to) {
  const auto first = list.begin();
  const auto at = [&](std::size_t index) { return first + static_cast<std::ptrdiff_t>(index); };
  if (to < from) std::rotate(at(to), at(from), at(from + 1));
  else std::rotate(at(from), at(from + 1), at(to + 1));
}

bool share_turned_bones(const ConstraintStack& stack, std::size_t one, std::size_t other) {
  const std::vector<int>&a = stack.turned(one), &b = stack.turned(other);
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

// Returns the names of this constraint and of all constraints that turn at least one of the bones that it turns, in the
// order in which the constraints are applied.
std::vector<std::string> order_of_rivals(const ConstraintStack& stack, const std::string& name) {
  const auto& list = stack.constraints()->list;
  const auto place = std::find_if(list.begin(), list.end(), [&](const Constraint& one) { return one.name == name; });
  const auto own = static_cast<std::size_t>(place - list.begin());
  std::vector<std::string> names;
  for (const std::size_t index : stack.order())
    if (index == own || share_turned_bones(stack, own, index)) names.push_back(list[index].name);
  return names;
}

void put_weight(Clip& clip, const std::string& name, int frame, double weight) {
  if (clip.keys.weights.contains(name)) return insert_weight_key(clip.keys, name, frame, weight);
  change_list(clip, [&](Constraints& constraints) { named(constraints, name).weight = weight; });
}

}  // namespace

const Constraints& constraints_of(const Document& document) {
  static const Constraints kNone;
  const Clip* clip = document.shown_clip();
  return clip && clip->constraints ? *clip->constraints : kNone;
}

std::vector<std::size_t> constraints_of_no_bone(const Document& document) {
  std::vector<std::size_t> found;
  const auto& list = constraints_of(document).list;
  for (std::size_t i = 0; document.armature && i < list.size(); ++i)
    if (!document.armature->find(list[i].bone)) found.push_back(i);
  return found;
}

std::vector<std::size_t> constraints_of_bone(const Document& document, int bone) {
  std::vector<std::size_t> found;
  const auto& list = constraints_of(document).list;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].bone == document.armature->bones[bone].name) found.push_back(i);
  return found;
}

const Constraint* find_constraint(const Document& document, const std::string& name) {
  for (const Constraint& constraint : constraints_of(document).list)
    if (constraint.name == name) return &constraint;
  return nullptr;
}

const Constraint* active_constraint(const Context& context) {
  const Document& document = context.document();
  const auto bone = context.selection->bone;
  if (!document.armature || !bone || *bone >= std::ssize(document.armature->bones)) return nullptr;
  const Constraint* first = nullptr;
  for (const std::size_t index : constraints_of_bone(document, *bone)) {
    const Constraint& constraint = constraints_of(document).list[index];
    if (constraint.name == context.timeline->constraint) return &constraint;
    if (!first) first = &constraint;
  }
  return first;
}

void add_constraint(Context& context, ConstraintKind kind) {
  stop_playing(context);
  settle_frame(context);
  const Armature& armature = *context.document().armature;
  const ConstraintRule& rule = constraint_rule(kind);
  if (constraints_of(context.document()).list.size() >= kMostConstraints)
    throw Error("the clip has too many constraints", rule.name, "remove a constraint first");
  Constraint added{.kind = kind, .bone = armature.bones[*context.selection->bone].name};
  if (const auto other = other_bone(context.selection); other && rule.target != ConstraintTarget::None)
    added.target = armature.bones[*other].name;
  if (rule.target == ConstraintTarget::Bone && added.target.empty())
    throw Error("the constraint needs a target", rule.name, "select the target bone, then with Shift the bone");
  if (kind == ConstraintKind::Aim) added.aim = looking_axis(armature, *context.selection->bone);
  added.name = unique_constraint_name(constraints_of(context.document()), rule.name + " " + added.bone);
  place_target(added, armature, pose_of(context.document()));
  Constraints next = constraints_of(context.document());
  next.list.push_back(added);
  require_applicable(context.document(), next, added.name);
  change_free_clip(context, rule.name,
                   [&](Clip& clip) { clip.constraints = std::make_shared<const Constraints>(next); });
  context.timeline->constraint = added.name;
}

void remove_constraint(Context& context, const std::string& name) {
  change_free_clip(context, "Remove constraint", [&](Clip& clip) {
    change_list(clip, [&](Constraints& constraints) {
      std::erase_if(constraints.list, [&](const Constraint& constraint) { return constraint.name == name; });
    });
    clip.keys.weights.erase(name);
    clip.keys.weight_shapes.erase(name);
  });
}

const Constraint* order_neighbour(const Context& context, const std::string& name, InOrder where) {
  const auto& list = constraints_of(context.document()).list;
  const auto& armature = context.document().armature;
  const auto place = std::find_if(list.begin(), list.end(), [&](const Constraint& one) { return one.name == name; });
  if (place == list.end() || !armature) return nullptr;
  const ClipOnRig* clip = context.timeline->prepared.get();
  const bool is_shown = clip && clip->clip().get() == context.document().shown_clip();
  const ConstraintStack* shown = is_shown ? clip->constraints() : nullptr;
  const auto own = static_cast<std::size_t>(place - list.begin());
  const auto is_changed_by_move_to = [&](std::size_t other) {
    Constraints both{list};
    both.list[own].on = both.list[other].on = true;
    const bool as_shown = shown && list[own].on && list[other].on && shown->constraints()->list == list;
    std::optional<ConstraintStack> made;
    if (!as_shown) made.emplace(std::make_shared<const Constraints>(both), armature);
    const ConstraintStack& now = as_shown ? *shown : *made;
    if (!share_turned_bones(now, own, other)) return false;
    const std::vector<std::string> before = order_of_rivals(now, name);
    move_in_list(both.list, own, other);
    return order_of_rivals(ConstraintStack(std::make_shared<const Constraints>(both), armature), name) != before;
  };
  const bool earlier = where == InOrder::Earlier;
  for (std::size_t step = 1; step <= (earlier ? own : list.size() - 1 - own); ++step)
    if (const std::size_t other = earlier ? own - step : own + step; is_changed_by_move_to(other)) return &list[other];
  return nullptr;
}

void move_constraint(Context& context, const std::string& name, InOrder where) {
  clip_on_rig(context);  // retargets the clip to the rig if needed; order_neighbour() uses the result
  const Constraint* found = order_neighbour(context, name, where);
  if (!found) return;
  const std::string neighbour = found->name;
  const bool earlier = where == InOrder::Earlier;
  change_free_clip(context, earlier ? "Move constraint up" : "Move constraint down", [&](Clip& clip) {
    change_list(clip, [&](Constraints& constraints) {
      auto& list = constraints.list;
      const auto at = [&](const std::string& wanted) {
        return std::find_if(list.begin(), list.end(), [&](const Constraint& one) { return one.name == wanted; });
      };
      move_in_list(list, static_cast<std::size_t>(at(name) - list.begin()),
                   static_cast<std::size_t>(at(neighbour) - list.begin()));
    });
  });
}

void change_constraint(Context& context, const std::string& name, const std::string& label,
                       const std::function<void(Constraint&)>& change) {
  Constraints next = constraints_of(context.document());
  change(named(next, name));
  if (next == constraints_of(context.document())) return drop_shown_pose(context);
  require_applicable(context.document(), next, name);
  change_free_clip(context, label, [&](Clip& clip) { clip.constraints = std::make_shared<const Constraints>(next); });
}

void preview_constraint(Context& context, const std::string& name, const std::function<void(Constraint&)>& change) {
  show_changed(context, [&](Clip& clip) {
    change_list(clip, [&](Constraints& constraints) { change(named(constraints, name)); });
  });
}

void set_target(Context& context, const std::string& name, const std::string& bone) {
  settle_frame(context);
  change_constraint(context, name, "Set target", [&](Constraint& constraint) {
    constraint.target = bone;
    place_target(constraint, *context.document().armature, pose_of(context.document()));
  });
}

void set_planted_point(Context& context, const std::string& name, PlantPoint point) {
  settle_frame(context);
  change_constraint(context, name, "Set planted point", [&](Constraint& constraint) {
    constraint.point = point;
    place_target(constraint, *context.document().armature, pose_of(context.document()));
  });
}

void keep_direction(Context& context, const std::string& name, bool keeps) {
  settle_frame(context);
  change_constraint(context, name, "Keep direction", [&](Constraint& constraint) {
    constraint.keeps_rotation = keeps;
    if (keeps) place_target(constraint, *context.document().armature, pose_of(context.document()));
  });
}

void aim_at_cross_hair(Context& context, const std::string& name) {
  settle_frame(context);
  change_constraint(context, name, "Target to cross-hair", [&](Constraint& constraint) {
    const PosedRig rig(*context.document().armature, pose_of(context.document()));
    const glm::dvec3 place = context.views->cross_hair;
    constraint.place =
        constraint.target.empty() ? place : inverse(rig.posed(require_bone(rig.armature(), constraint.target))) * place;
  });
}

bool has_weight_key(const Document& document, const Constraint& constraint, int frame) {
  const Clip* clip = shown_clip(document);
  const auto track = clip->keys.weights.find(constraint.name);
  return track != clip->keys.weights.end() && track->second.contains(frame);
}

double shown_weight(const Context& context, const Constraint& constraint) {
  return weight_at(constraint, shown_clip(context.document())->keys, shown_frame(context));
}

void set_weight(Context& context, const std::string& name, double weight) {
  settle_frame(context);
  const int frame = context.document().frame;
  change_free_clip(context, "Set constraint weight", [&](Clip& clip) { put_weight(clip, name, frame, weight); });
}

void preview_weight(Context& context, const std::string& name, double weight) {
  show_changed(context, [&](Clip& clip) { put_weight(clip, name, context.document().frame, weight); });
}

void toggle_weight_key(Context& context, const std::string& name) {
  settle_frame(context);
  const Constraint* constraint = find_constraint(context.document(), name);
  if (!constraint) return;
  const int frame = context.document().frame;
  const double weight = shown_weight(context, *constraint);
  const bool is_keyed = has_weight_key(context.document(), *constraint, frame);
  change_free_clip(context, is_keyed ? "Delete weight key" : "Insert weight key", [&](Clip& clip) {
    if (is_keyed) delete_weight_key(clip.keys, name, frame);
    else insert_weight_key(clip.keys, name, frame, weight);
    // If the last weight key was deleted, the constraint keeps that key's weight.
    if (!clip.keys.weights.contains(name))
      change_list(clip, [&](Constraints& constraints) { named(constraints, name).weight = weight; });
  });
}

void switch_weight(Context& context, const std::string& name) {
  settle_frame(context);
  const Constraint* constraint = find_constraint(context.document(), name);
  if (!constraint) return;
  const int frame = context.document().frame;
  const int later = frame + std::max(1, static_cast<int>(std::lround(frame_rate(context.document()) / 3)));
  const double weight = shown_weight(context, *constraint);
  change_free_clip(context, "Switch constraint weight", [&](Clip& clip) {
    insert_weight_key(clip.keys, name, frame, weight);
    insert_weight_key(clip.keys, name, later, weight > 0.5 ? 0 : 1);
    for (int between = frame + 1; between < later; ++between) delete_weight_key(clip.keys, name, between);
  });
  context.messages->info(weight > 0.5 ? "The constraint fades out" : "The constraint fades in",
                         "From frame " + std::to_string(frame) + " to " + std::to_string(later));
}

void set_weight_steps(Context& context, const std::string& name, Interpolation next) {
  change_free_clip(context, "Set interpolation of constraint weight",
                   [&](Clip& clip) { set_weight_interpolation(clip.keys, name, next); });
}

void apply_constraints(Context& context) {
  stop_playing(context);
  settle_frame(context);
  const std::shared_ptr<const Clip> source =
      context.document().clips[static_cast<std::size_t>(context.document().clip)];
  const auto [first, last] = all_frames(*source);
  if (std::int64_t{last} - first >= kMostFrames)
    throw Error("the clip is too long to be baked", source->name, "trim it, or set a shorter range");
  start_task(context, "Apply constraints",
             [source, rig = context.document().armature, first = first, last = last](Progress& progress) -> Finish {
               const auto made =
                   std::make_shared<const Clip>(with_constraints_as_keys(source, rig, first, last, progress));
               return [=](Context& c) {
                 take_in_clip(c, source, rig, "Apply constraints", *made, false);
                 c.messages->ok("Constraints applied", "Each turned bone has a key in frames " + std::to_string(first) +
                                                           " to " + std::to_string(last));
               };
             });
}

}  // namespace limber::editor
