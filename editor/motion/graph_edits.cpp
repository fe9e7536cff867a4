// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/graph_edits.h"

#include <algorithm>
#include <cmath>

#include "core/motion/euler_channels.h"
#include "core/motion/key_curve.h"

namespace limber::editor {

namespace {

constexpr double kFurthest = 1e7;  // frame numbers are clamped to plus or minus this

// For each track, the frames at which keys are selected, and for each frame the selected channels (X, Y, Z).
using FramesOfTracks = std::map<GraphTrack, std::map<int, glm::bvec3>>;

FramesOfTracks by_track(const std::set<GraphKey>& keys) {
  FramesOfTracks tracks;
  for (const GraphKey& key : keys) {
    auto& channels = tracks[key.channel.track].try_emplace(key.frame, false, false, false).first->second;
    channels[key.channel.axis] = true;
  }
  return tracks;
}

KeyShape shape_of(const Keys& keys, const GraphTrack& track, int frame) {
  return shape_at(track.is_shift ? keys.root_shapes : shapes_of(keys, track.bone), frame);
}
void put_shape(Keys& keys, const GraphTrack& track, int frame, const KeyShape& shape) {
  const glm::dvec3 most(kSteepestTangent);
  const KeyShape within{shape.next, shape.handles, glm::clamp(shape.in, -most, most),
                        glm::clamp(shape.out, -most, most)};
  if (track.is_shift) set_root_shape(keys, frame, within);
  else set_shape(keys, track.bone, frame, within);
}

Tangents tangents_of(const GraphCurves& curves, const GraphTrack& track, int frame) {
  const GraphCurve& curve = curves.tracks.at(track);
  return track.is_shift ? tangents_at(curve.shifts, curve.shapes, frame)
                        : tangents_at(curve.turns, curve.shapes, frame);
}

// Returns the key's shape with free handles. The handles keep the key's current tangents.
KeyShape freed(const GraphCurves& curves, const GraphTrack& track, int frame, KeyShape shape) {
  if (shape.handles == HandleKind::Free) return shape;
  const Tangents tangents = tangents_of(curves, track, frame);
  return {shape.next, HandleKind::Free, tangents.in, tangents.out};
}

// Returns the tangent (angular velocity) of a rotation key after its angles have changed from `before` to `after`
// (degrees). The new tangent gives each channel its old slope, multiplied by the channel's factor in `factors`. In
// gimbal lock, a part of the tangent belongs to no channel; this part does not change.
glm::dvec3 tangent_at_angles(const glm::dvec3& tangent, const glm::dvec3& before, const glm::dvec3& after,
                             const glm::dvec3& factors) {
  const glm::dvec3 speeds = channel_speeds(glm::radians(before), tangent);
  const glm::dvec3 left = tangent - velocity_of_channels(glm::radians(before), speeds);
  return velocity_of_channels(glm::radians(after), factors * speeds) + left;
}

// Changes the value of some channels of a key. Tangents that the user has set are scaled with the values.
void change_value(const GraphCurves& curves, Keys& keys, const GraphTrack& track, int frame, const glm::bvec3& channels,
                  const GraphMap& value) {
  const glm::dvec3 before = graph_values(curves, track, frame);
  glm::dvec3 after = before, factors(1);
  for (int axis = 0; axis < 3; ++axis) {
    if (!channels[axis]) continue;
    after[axis] = value.at(before[axis]);
    factors[axis] = value.scale;
  }
  KeyShape shape = shape_of(keys, track, frame);
  if (track.is_shift) {
    keys.root[frame] = glm::clamp(after, -kFarthestShift, kFarthestShift);
    shape.in *= factors;
    shape.out *= factors;
  } else {
    glm::dquat& rotation = keys.bones[track.bone][frame];
    const glm::dquat turned = rotation_of_channels(glm::radians(after));
    rotation = glm::dot(turned, rotation) < 0 ? -turned : turned;
    for (glm::dvec3* tangent : {&shape.in, &shape.out}) *tangent = tangent_at_angles(*tangent, before, after, factors);
  }
  if (shape.handles == HandleKind::Aligned || shape.handles == HandleKind::Free) put_shape(keys, track, frame, shape);
}

// Calls way() with the values of a key and of the next key, and returns the result and the number of frames between the
// two keys. Returns nothing for the last key.
template <class Value, class Way>
std::optional<std::pair<glm::dvec3, int>> way_on(const std::map<int, Value>& keys, int frame, const Way& way) {
  const auto key = keys.find(frame);
  if (key == keys.end() || std::next(key) == keys.end()) return std::nullopt;
  return std::pair(way(key->second, std::next(key)->second), std::next(key)->first - frame);
}

}  // namespace

Keys with_keys_changed(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed,
                       const GraphMap& time, const GraphMap& value) {
  Keys next = keys;
  for (const auto& [track, channels_at] : by_track(changed)) {
    std::map<int, int> frame_of;
    for (const auto& [frame, channels] : channels_at) {
      if (value != GraphMap{}) change_value(curves, next, track, frame, channels, value);
      frame_of[frame] = mapped_frame(time, frame);
      if (time.scale == 1) continue;
      KeyShape shape = shape_of(next, track, frame);
      shape.in /= time.scale;
      shape.out /= time.scale;
      put_shape(next, track, frame, shape);
    }
    if (time == GraphMap{}) continue;
    if (track.is_shift) move_root_keys(next, frame_of);
    else move_bone_keys(next, track.bone, frame_of);
  }
  return next;
}

Keys with_keys_copied(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& copied,
                      const GraphMap& time, const GraphMap& value) {
  Keys next = with_keys_changed(curves, keys, copied, time, value);
  for (const auto& [track, channels_at] : by_track(copied)) {
    std::set<int> taken;
    for (const auto& [frame, channels] : channels_at) taken.insert(mapped_frame(time, frame));
    for (const auto& [frame, channels] : channels_at) {
      if (taken.contains(frame)) continue;
      if (track.is_shift) next.root[frame] = keys.root.at(frame);
      else next.bones[track.bone][frame] = keys.bones.at(track.bone).at(frame);
      put_shape(next, track, frame, shape_of(keys, track, frame));
    }
  }
  return next;
}

int mapped_frame(const GraphMap& time, int frame) {
  return static_cast<int>(std::lround(std::clamp(time.at(frame), -kFurthest, kFurthest)));
}

std::set<GraphKey> mapped_keys(const GraphMap& time, const std::set<GraphKey>& keys) {
  std::set<GraphKey> after;
  for (GraphKey key : keys) {
    key.frame = mapped_frame(time, key.frame);
    after.insert(key);
  }
  return after;
}

Keys with_keys_deleted(const Keys& keys, const std::set<GraphKey>& deleted) {
  Keys next = keys;
  for (const GraphKey& key : deleted) {
    if (key.channel.track.is_shift) delete_root_keys(next, {key.frame});
    else delete_bone_keys(next, key.channel.track.bone, {key.frame});
  }
  return next;
}

Keys with_interpolation(const Keys& keys, const std::set<GraphKey>& changed, Interpolation interpolation) {
  Keys next = keys;
  for (const auto& [track, frames] : by_track(changed))
    for (const auto& [frame, channels] : frames) {
      KeyShape shape = shape_of(next, track, frame);
      shape.next = interpolation;
      put_shape(next, track, frame, shape);
    }
  return next;
}

Keys with_handles(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed, HandleKind handles) {
  Keys next = keys;
  for (const auto& [track, frames] : by_track(changed))
    for (const auto& [frame, channels] : frames) {
      const Tangents tangents = tangents_of(curves, track, frame);
      KeyShape shape{shape_of(next, track, frame).next, handles};
      if (handles == HandleKind::Free) {
        shape.in = tangents.in;
        shape.out = tangents.out;
      } else if (handles == HandleKind::Aligned) {
        shape.in = shape.out = (tangents.in + tangents.out) / 2.0;
      }
      put_shape(next, track, frame, shape);
    }
  return next;
}

Keys with_slope(const GraphCurves& curves, const Keys& keys, const GraphKey& key, KeySide side, double speed) {
  const GraphTrack& track = key.channel.track;
  const auto now = graph_speeds(curves, track, key.frame, side);
  if (!now) return keys;
  glm::dvec3 speeds = *now;
  speeds[key.channel.axis] = speed;
  const glm::dvec3 tangent = tangent_of_speeds(curves, track, key.frame, speeds);
  Keys next = keys;
  KeyShape shape = shape_of(next, track, key.frame);
  if (shape.handles != HandleKind::Free) {
    shape.handles = HandleKind::Aligned;
    shape.in = shape.out = tangent;
  } else {
    (side == KeySide::In ? shape.in : shape.out) = tangent;
  }
  put_shape(next, track, key.frame, shape);
  return next;
}

Keys with_easing(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed, Easing easing) {
  Keys next = keys;
  for (const auto& [track, frames] : by_track(changed)) {
    const GraphCurve& curve = curves.tracks.at(track);
    for (const auto& [frame, channels] : frames) {
      const auto way = track.is_shift ? way_on(curve.shifts, frame, [](const auto& a, const auto& b) { return b - a; })
                                      : way_on(curve.turns, frame, turn_between);
      if (!way) continue;
      const glm::dvec3 full = 2.0 * way->first / static_cast<double>(way->second);
      KeyShape first = freed(curves, track, frame, shape_of(next, track, frame));
      first.next = Interpolation::Bezier;
      first.out = easing == Easing::Out ? full : glm::dvec3(0);
      put_shape(next, track, frame, first);
      const int end = frame + way->second;
      KeyShape last = freed(curves, track, end, shape_of(next, track, end));
      last.in = easing == Easing::In ? full : glm::dvec3(0);
      put_shape(next, track, end, last);
    }
  }
  return next;
}

}  // namespace limber::editor
