// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/bone_names.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <type_traits>

#include "core/base/error.h"
#include "core/motion/constraint.h"
#include "core/motion/strips.h"
#include "core/rig/mirror.h"

namespace limber {

namespace {

class Names {
 public:
  Names(const Armature& before, const Armature& after) {
    for (std::size_t bone = 0; bone < before.bones.size(); ++bone) {
      now_[before.bones[bone].name] = after.bones[bone].name;
      before_[after.bones[bone].name] = before.bones[bone].name;
    }
  }

  bool changed(const std::string& now) const {
    const auto found = before_.find(now);
    return found != before_.end() && found->second != now;
  }
  // Returns the name that the bone with the earlier name `name` has after the edit. Returns nothing when that bone was
  // removed and another bone has taken its name.
  std::optional<std::string> now(const std::string& name) const {
    if (const auto found = now_.find(name); found != now_.end()) return found->second;
    return before_.contains(name) ? std::nullopt : std::optional(name);
  }

  template <class Value>
  std::map<std::string, Value> follow(const std::map<std::string, Value>& by_bone) const {
    std::map<std::string, Value> next;
    for (const auto& [bone, value] : by_bone)
      if (const auto name = now(bone)) next[*name] = value;
    return next;
  }

 private:
  std::map<std::string, std::string> now_, before_;
};

// Replaces a part of the document only where the new value differs, so that an unchanged part keeps its pointer.
template <class Part>
void take(std::shared_ptr<const Part>& part, Part next) {
  if (next != *part) part = std::make_shared<const Part>(std::move(next));
}

RetargetMap matched(const Clip& clip, const Armature& armature) {
  try {
    return match_by_names(*clip.motion, armature);
  } catch (const Error&) {
    return {};  // the clip does not move any bone, since none of its joints matches one
  }
}

// Prepares the clip's retargeting without the motion of the root bone. Preparing that motion is slow, and
// follow_motion() needs only the rest offsets and the scale.
Retarget prepared(const Clip& clip, const Armature& armature, const RetargetMap& map) {
  RetargetSettings settings = clip.retarget;
  settings.travel = Travel::Locked;
  return Retarget(*clip.motion, armature, map, settings);
}

void drop_weights(Clip& clip, const std::string& constraint) {
  clip.keys.weights.erase(constraint);
  clip.keys.weight_shapes.erase(constraint);
}

void take_list(Clip& clip, Constraints next) {
  if (next.list.empty()) clip.constraints = nullptr;
  else take(clip.constraints, std::move(next));
}

// Updates the bone names of constraints. Removes a constraint if its bone or target was removed and another bone has
// taken the name.
void follow_constraints(Clip& clip, const Names& names) {
  if (!clip.constraints) return;
  Constraints next;
  std::vector<std::string> bones;
  for (Constraint constraint : clip.constraints->list) {
    const auto bone = names.now(constraint.bone), target = names.now(constraint.target);
    if (!bone || !target) {
      drop_weights(clip, constraint.name);
      continue;
    }
    bones.push_back(constraint.bone);
    constraint.bone = *bone;
    constraint.target = *target;
    next.list.push_back(constraint);
  }
  name_after_bones(next.list, clip.keys, bones);
  take_list(clip, std::move(next));
}

// Replaces the bone names in the strips' lists of bones.
//   follow  returns the new names for a set of old names
void follow_strips(Clip& clip, const std::function<std::set<std::string>(const std::set<std::string>&)>& follow) {
  if (!clip.strips) return;
  Strips next = *clip.strips;
  for (StripTrack& track : next.tracks)
    for (Strip& strip : track.strips)
      if (strip.bones) strip.bones = follow(*strip.bones);
  take(clip.strips, std::move(next));
}

void follow_motion(Clip& clip, const Armature& before, const Armature& after, const Names& names) {
  const bool by_names = clip.map.sources.empty();
  RetargetMap old = by_names ? matched(clip, before) : known_part(clip.map, *clip.motion, before);
  old.stances = clip.map.stances;
  clip.map.sources = names.follow(clip.map.sources);
  if (old.sources.empty()) return;

  RetargetMap next{names.follow(old.sources), clip.map.stances};
  RetargetMap found = by_names ? matched(clip, after) : RetargetMap{};
  found.stances = clip.map.stances;
  for (const auto& [bone, source] : found.sources)
    if (names.changed(bone)) next.sources.insert({bone, source});
  const Retarget was = prepared(clip, before, old), is = prepared(clip, after, next);
  bool as_it_was = is.scale() == was.scale();
  const RetargetMap turned = is.map();
  for (const auto& [bone, source] : was.map().sources) {
    const std::string name = *names.now(bone);
    if (glm::dot(*source.rest_offset, *turned.sources.at(name).rest_offset) > 1 - 1e-12) continue;
    next.sources[name].rest_offset = source.rest_offset;
    as_it_was = false;
  }
  if (by_names && as_it_was && next == found) return;
  if (is.scale() != was.scale()) clip.retarget.scale = was.scale();
  for (const auto& [bone, source] : next.sources) clip.map.sources[bone] = source;
}

// The mirrored bones that did not swap names with a counterpart: each moves to the other side under a new name.
struct GoneOver {
  std::map<std::string, std::string> names;  // old name -> new name

  std::string now(const std::string& bone) const { return names.contains(bone) ? names.at(bone) : bone; }
  // Returns whether `bone` is the name of a removed bone, and a mirrored bone takes this name.
  bool is_left_over(const std::string& bone) const {
    return !names.contains(bone) &&
           std::any_of(names.begin(), names.end(), [&](const auto& name) { return name.second == bone; });
  }
};

void carry_constraints(Clip& clip, const Armature& before, const Armature& after, const GoneOver& gone_over,
                       const MirrorPlane& plane) {
  if (!clip.constraints) return;
  Constraints next;
  std::vector<std::string> bones;
  for (Constraint constraint : clip.constraints->list) {
    if (gone_over.is_left_over(constraint.bone) || gone_over.is_left_over(constraint.target)) {
      drop_weights(clip, constraint.name);
      continue;
    }
    const bool bone_goes = gone_over.names.contains(constraint.bone);
    // A position is mirrored if the bone that it is fixed to is mirrored. A position in the world, or on a bone without
    // a side, is mirrored together with the constrained bone.
    const bool place_goes =
        gone_over.names.contains(constraint.target) || (bone_goes && !mirrored_name(constraint.target));
    const Constraint was = constraint;
    if (const auto bone = before.find(constraint.bone); bone && bone_goes)
      constraint = mirror_image(constraint, before.bones[*bone], after.bones[*bone], plane);
    constraint.place = place_goes ? plane.place(was.place) : was.place;
    constraint.rotation = place_goes ? plane.rotation(was.rotation) : was.rotation;
    bones.push_back(constraint.bone);
    constraint.bone = gone_over.now(constraint.bone);
    constraint.target = gone_over.now(constraint.target);
    next.list.push_back(constraint);
  }
  name_after_bones(next.list, clip.keys, bones);
  take_list(clip, std::move(next));
}

}  // namespace

void follow_names(Document& document, const Armature& before, const Armature& after) {
  const Names names(before, after);
  const auto follow = [&](const std::set<std::string>& bones) {
    std::set<std::string> next;
    for (const std::string& bone : bones)
      if (const auto name = names.now(bone)) next.insert(*name);
    return next;
  };
  for (auto& part : document.clips) {
    Clip clip = *part;
    clip.keys.bones = names.follow(clip.keys.bones);
    clip.keys.shapes = names.follow(clip.keys.shapes);
    follow_constraints(clip, names);
    follow_strips(clip, follow);
    if (clip.motion && clip.motion->frame_count > 0) follow_motion(clip, before, after, names);
    take(part, std::move(clip));
  }
  for (auto& part : document.poses) {
    NamedPose pose = *part;
    pose.rotation = names.follow(pose.rotation);
    take(part, std::move(pose));
  }
  if (document.locks) take(document.locks, WeightLocks{follow(document.locks->bones)});
  if (document.anchors)
    take(document.anchors, Anchors{follow(document.anchors->pins), names.follow(document.anchors->poles)});
  if (!document.bone_map) return;
  BoneMap map;
  for (const auto& [label, bone] : *document.bone_map)
    if (const auto name = names.now(bone)) map[label] = *name;
  take(document.bone_map, std::move(map));
}

void follow_mirrored(Document& document, const Armature& before, const Armature& after, const std::vector<int>& bones) {
  const MirrorPlane plane = mirror_plane(before);
  GoneOver gone_over;
  for (const int bone : bones) {
    const std::string& name = before.bones[bone].name;
    if (!mirrored_name(name) || (after.bones[bone].name != name && before.find(after.bones[bone].name))) continue;
    gone_over.names[name] = after.bones[bone].name;
    if (!document.pose) continue;
    Pose pose = *document.pose;
    pose.rotation[bone] = plane.rotation(pose.rotation[bone]);
    document.pose = std::make_shared<const Pose>(std::move(pose));
  }
  // Drops data of a removed bone whose name a mirrored bone takes; else the mirrored bone would inherit these data.
  const auto carry = [&](auto& by_bone, const auto& in_the_mirror) {
    std::remove_reference_t<decltype(by_bone)> next;
    for (const auto& [bone, value] : by_bone) {
      if (gone_over.is_left_over(bone)) continue;
      next[gone_over.now(bone)] = gone_over.names.contains(bone) ? in_the_mirror(value) : value;
    }
    by_bone = std::move(next);
  };
  const auto carried = [&](const std::set<std::string>& bones) {
    std::set<std::string> next;
    for (const std::string& bone : bones) next.insert(gone_over.now(bone));
    return next;
  };
  const auto turned = [&](const glm::dquat& rotation) { return plane.rotation(rotation); };
  for (auto& part : document.clips) {
    Clip clip = *part;
    carry(clip.keys.bones, [&](std::map<int, glm::dquat> track) {
      for (auto& [frame, rotation] : track) rotation = plane.rotation(rotation);
      return track;
    });
    carry(clip.keys.shapes, [&](KeyShapes shapes) {
      // A rotation reverses its sense in a mirror, so its vector is negated after the reflection.
      for (auto& [frame, shape] : shapes)
        for (glm::dvec3* tangent : {&shape.in, &shape.out}) *tangent = -plane.direction(*tangent);
      return shapes;
    });
    carry(clip.map.sources, [](const RetargetMap::Source& source) { return RetargetMap::Source{source.joint, {}}; });
    carry_constraints(clip, before, after, gone_over, plane);
    follow_strips(clip, carried);
    take(part, std::move(clip));
  }
  for (auto& part : document.poses) {
    NamedPose pose = *part;
    carry(pose.rotation, turned);
    take(part, std::move(pose));
  }
  if (document.locks) {
    WeightLocks locks = *document.locks;
    locks.bones = carried(locks.bones);
    take(document.locks, std::move(locks));
  }
  if (!document.anchors) return;
  Anchors anchors = *document.anchors;
  anchors.pins = carried(anchors.pins);
  carry(anchors.poles, [&](const glm::dvec3& place) { return plane.place(place); });
  take(document.anchors, std::move(anchors));
}

}  // namespace limber
