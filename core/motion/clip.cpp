// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/clip.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/constraint_stack.h"
#include "core/motion/key_curve.h"
#include "core/motion/strips_on_rig.h"

namespace limber {

namespace {

// The keys before and after a frame, and the share of the interval between the two keys that has passed at the frame,
// [0, 1].
template <class Value>
struct Between {
  const std::pair<const int, Value>*before, *after;
  double share;
};

template <class Value>
Between<Value> around(const std::map<int, Value>& track, int frame) {
  const auto after = track.lower_bound(frame);
  if (after == track.end()) return {&*track.rbegin(), &*track.rbegin(), 0};
  if (after == track.begin() || after->first == frame) return {&*after, &*after, 0};
  const auto before = std::prev(after);
  return {&*before, &*after, static_cast<double>(frame - before->first) / (after->first - before->first)};
}

// Returns the interpolation of the last key before a frame. Returns Constant for a frame that has a key, or that lies
// before the first key or after the last.
template <class Value>
Interpolation interpolation_at(const Between<Value>& between, const KeyShapes& shapes) {
  return between.share == 0 ? Interpolation::Constant : shape_at(shapes, between.before->first).next;
}

}  // namespace

Clip clip_of(std::shared_ptr<const Motion> motion, std::string name, int start) {
  Clip clip;
  clip.name = std::move(name);
  const double rate = 1 / motion->frame_time;
  clip.rate = std::isfinite(rate) && rate >= 0.01 && rate <= 10'000 ? std::round(rate * 1000) / 1000 : 30;
  clip.start = clip.range_start = start;
  clip.last = std::max(0, motion->frame_count - 1);
  clip.range_end = clip.end();
  clip.motion = std::move(motion);
  return clip;
}

std::string unique_clip_name(const std::vector<std::shared_ptr<const Clip>>& clips, const std::string& wanted) {
  const auto taken = [&](const std::string& name) {
    return std::any_of(clips.begin(), clips.end(), [&](const auto& clip) { return clip->name == name; });
  };
  std::string name = wanted;
  for (int number = 2; taken(name); ++number) name = wanted + " " + std::to_string(number);
  return name;
}

ClipOnRig::ClipOnRig(std::shared_ptr<const Clip> clip, std::shared_ptr<const Armature> armature,
                     const ClipOnRig* before)
    : clip_(std::move(clip)),
      armature_(std::move(armature)) {
  if (clip_->constraints && !clip_->constraints->list.empty()) {
    const bool is_known = before && before->constraints_ && before->armature_ == armature_ &&
                          before->clip_->constraints == clip_->constraints;
    constraints_ =
        is_known ? before->constraints_ : std::make_shared<const ConstraintStack>(clip_->constraints, armature_);
  }
  if (clip_->strips) {
    const bool is_known = before && before->strips_ && before->armature_ == armature_ &&
                          before->clip_->strips == clip_->strips && before->clip_->rate == clip_->rate;
    strips_ = is_known ? before->strips_
                       : std::make_shared<const StripsOnRig>(clip_->strips, armature_, clip_->rate,
                                                             before ? before->strips_.get() : nullptr);
    problem_ = strips_->problem();
    return;
  }
  if (!clip_->motion) return;
  if (before && before->armature_ == armature_ && before->clip_->motion == clip_->motion &&
      before->clip_->map == clip_->map && before->clip_->retarget == clip_->retarget) {
    retarget_ = before->retarget_;
    problem_ = before->problem_;
    return;
  }
  try {
    const RetargetMap known = known_part(clip_->map, *clip_->motion, *armature_);
    if (known.sources.empty() && !clip_->map.sources.empty())
      throw Error("the map names no bone of this rig", clip_->name, "match the joints again");
    RetargetMap map = clip_->map.sources.empty() ? match_by_names(*clip_->motion, *armature_) : known;
    map.stances = clip_->map.stances;
    retarget_ = std::make_shared<const Retarget>(*clip_->motion, *armature_, map, clip_->retarget);
  } catch (const Error& error) {
    problem_ = error.what();
  }
}

Pose ClipOnRig::base_at(int frame) const {
  if (strips_) return strips_->at(frame);
  if (!retarget_) return rest_pose(*armature_);
  const int most = clip_->motion->frame_count - 1;
  const std::int64_t wanted = std::int64_t{frame} - clip_->start + clip_->first;
  const int last = std::clamp(clip_->last, 0, most), first = std::clamp(clip_->first, 0, last);
  return retarget_->at(static_cast<int>(std::clamp<std::int64_t>(wanted, first, last)));
}

void ClipOnRig::move_root(Pose& pose, int frame, const std::function<const Pose&(int)>& base) const {
  const Keys& keys = clip_->keys;
  const auto between = around(keys.root, frame);
  const auto& [before, after, share] = between;
  if (before->first == frame) {
    pose.root_translation = before->second;
    return;
  }
  const auto moved = [&](const auto& key) { return key.second - base(key.first).root_translation; };
  switch (interpolation_at(between, keys.root_shapes)) {
    case Interpolation::Constant: pose.root_translation += moved(*before); break;
    case Interpolation::Linear: pose.root_translation += glm::mix(moved(*before), moved(*after), share); break;
    case Interpolation::Bezier: {
      std::map<int, glm::dvec3> shifts = keys_around(keys.root, frame);
      for (auto& key : shifts) key.second = moved(key);
      pose.root_translation += value_at(shifts, keys.root_shapes, frame);
    }
  }
}

Pose ClipOnRig::at(int frame) const {
  const Pose pose = unconstrained_at(frame);
  return constraints_ ? constraints_->constrained(pose, clip_->keys, frame) : pose;
}

Pose ClipOnRig::unconstrained_at(int frame) const {
  Pose pose = base_at(frame);
  const Keys& keys = clip_->keys;
  if (keys.empty()) return pose;

  // Cache of the motion's pose at each frame that has a key. The poses are few, since most bones have keys at the same
  // frames.
  std::map<int, Pose> bases;
  const auto base = [&](int at) -> const Pose& {
    const auto found = bases.find(at);
    return found != bases.end() ? found->second : bases.emplace(at, base_at(at)).first->second;
  };
  for (int bone = 0; bone < std::ssize(armature_->bones); ++bone) {
    const auto track = keys.bones.find(armature_->bones[bone].name);
    if (track == keys.bones.end() || track->second.empty()) continue;
    const KeyShapes& shapes = shapes_of(keys, track->first);
    const auto between = around(track->second, frame);
    const auto& [before, after, share] = between;
    const Interpolation way = interpolation_at(between, shapes);
    if (!has_base() || before->first == frame) {
      pose.rotation[bone] = way == Interpolation::Constant ? before->second
                            : way == Interpolation::Linear
                                ? glm::normalize(glm::slerp(before->second, after->second, share))
                                : value_at(track->second, shapes, frame);
      continue;
    }
    const auto turn = [&](const auto& key) {
      return glm::normalize(key.second * glm::conjugate(base(key.first).rotation[bone]));
    };
    const auto eased = [&] {
      std::map<int, glm::dquat> turns = keys_around(track->second, frame);
      for (auto& key : turns) key.second = turn(key);
      return value_at(turns, shapes, frame);
    };
    const glm::dquat turned = way == Interpolation::Constant ? turn(*before)
                              : way == Interpolation::Linear
                                  ? glm::normalize(glm::slerp(turn(*before), turn(*after), share))
                                  : eased();
    pose.rotation[bone] = glm::normalize(turned * pose.rotation[bone]);
  }
  if (!keys.root.empty()) move_root(pose, frame, base);
  return pose;
}

}  // namespace limber
