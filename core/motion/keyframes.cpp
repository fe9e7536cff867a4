// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/keyframes.h"

namespace limber {

namespace {

void put_shape(KeyShapes& shapes, int frame, const KeyShape& shape) {
  if (shape == KeyShape{}) shapes.erase(frame);
  else shapes[frame] = shape;
}

// Calls act(track, shapes) for the keys of each bone and for the keys of the body's shift.
template <class Act>
void for_tracks(Keys& keys, const Act& act) {
  for (auto& [bone, track] : keys.bones) act(track, keys.shapes[bone]);
  act(keys.root, keys.root_shapes);
  for (auto& [constraint, track] : keys.weights) act(track, keys.weight_shapes[constraint]);
}

void drop_empty(Keys& keys) {
  std::erase_if(keys.bones, [](const auto& bone) { return bone.second.empty(); });
  std::erase_if(keys.shapes, [](const auto& bone) { return bone.second.empty(); });
  std::erase_if(keys.weights, [](const auto& constraint) { return constraint.second.empty(); });
  std::erase_if(keys.weight_shapes, [](const auto& constraint) { return constraint.second.empty(); });
}

template <class Track>
void remove(Track& track, KeyShapes& shapes, const std::set<int>& frames) {
  for (const int frame : frames) {
    track.erase(frame);
    shapes.erase(frame);
  }
}

template <class Track>
void place(Track& track, KeyShapes& shapes, const std::map<int, int>& frame_of, bool keep) {
  Track moved;
  KeyShapes moved_shapes;
  for (const auto& [from, to] : frame_of)
    if (const auto key = track.find(from); key != track.end()) {
      moved.emplace(to, key->second);
      moved_shapes.emplace(to, shape_at(shapes, from));
    }
  if (!keep)
    for (const auto& [from, to] : frame_of) {
      track.erase(from);
      shapes.erase(from);
    }
  for (const auto& [frame, value] : moved) {
    track[frame] = value;
    put_shape(shapes, frame, moved_shapes.at(frame));
  }
}

template <class Track>
void insert(Track& track, KeyShapes& shapes, int frame, const typename Track::mapped_type& value) {
  const auto after = track.upper_bound(frame);
  if (!track.contains(frame) && !track.empty()) {
    const int like = after == track.begin() ? after->first : std::prev(after)->first;
    put_shape(shapes, frame, {.next = shape_at(shapes, like).next});
  }
  track[frame] = value;
}

}  // namespace

std::set<int> frames_of(const Keys& keys) {
  std::set<int> frames;
  for (const auto& [bone, track] : keys.bones)
    for (const auto& [frame, rotation] : track) frames.insert(frame);
  for (const auto& [frame, place] : keys.root) frames.insert(frame);
  for (const auto& [constraint, track] : keys.weights)
    for (const auto& [frame, weight] : track) frames.insert(frame);
  return frames;
}

KeyShape shape_at(const KeyShapes& shapes, int frame) {
  const auto found = shapes.find(frame);
  return found == shapes.end() ? KeyShape{} : found->second;
}

const KeyShapes& shapes_of(const Keys& keys, const std::string& bone) {
  static const KeyShapes kNone;
  const auto found = keys.shapes.find(bone);
  return found == keys.shapes.end() ? kNone : found->second;
}

void set_shape(Keys& keys, const std::string& bone, int frame, const KeyShape& shape) {
  put_shape(keys.shapes[bone], frame, shape);
  drop_empty(keys);
}

void set_root_shape(Keys& keys, int frame, const KeyShape& shape) { put_shape(keys.root_shapes, frame, shape); }

void scale_tangents(Keys& keys, double factor) {
  for_tracks(keys, [&](auto&, KeyShapes& shapes) {
    for (auto& [frame, shape] : shapes) {
      shape.in *= factor;
      shape.out *= factor;
    }
  });
  drop_empty(keys);
}

void insert_key(Keys& keys, const Armature& armature, const Pose& pose, const std::vector<int>& bones, int frame) {
  for (int bone : bones) {
    const std::string& name = armature.bones[bone].name;
    insert(keys.bones[name], keys.shapes[name], frame, pose.rotation[bone]);
    if (armature.bones[bone].parent < 0) insert(keys.root, keys.root_shapes, frame, pose.root_translation);
  }
  drop_empty(keys);
}

bool delete_key(Keys& keys, const Armature& armature, const std::vector<int>& bones, int frame) {
  bool any = false;
  for (int bone : bones) {
    const std::string& name = armature.bones[bone].name;
    if (const auto track = keys.bones.find(name); track != keys.bones.end()) any |= track->second.contains(frame);
    delete_bone_keys(keys, name, {frame});
    if (armature.bones[bone].parent >= 0) continue;
    any |= keys.root.contains(frame);
    delete_root_keys(keys, {frame});
  }
  return any;
}

void insert_weight_key(Keys& keys, const std::string& constraint, int frame, double weight) {
  insert(keys.weights[constraint], keys.weight_shapes[constraint], frame, weight);
  drop_empty(keys);
}

bool delete_weight_key(Keys& keys, const std::string& constraint, int frame) {
  const auto track = keys.weights.find(constraint);
  if (track == keys.weights.end() || !track->second.contains(frame)) return false;
  remove(track->second, keys.weight_shapes[constraint], {frame});
  drop_empty(keys);
  return true;
}

void set_weight_interpolation(Keys& keys, const std::string& constraint, Interpolation next) {
  const auto track = keys.weights.find(constraint);
  if (track == keys.weights.end()) return;
  for (const auto& [frame, weight] : track->second) put_shape(keys.weight_shapes[constraint], frame, {.next = next});
  drop_empty(keys);
}

void delete_keys(Keys& keys, const std::set<int>& frames) {
  for_tracks(keys, [&](auto& track, KeyShapes& shapes) { remove(track, shapes, frames); });
  drop_empty(keys);
}

void move_keys(Keys& keys, const std::map<int, int>& frame_of) {
  for_tracks(keys, [&](auto& track, KeyShapes& shapes) { place(track, shapes, frame_of, false); });
  drop_empty(keys);
}

void copy_keys(Keys& keys, const std::map<int, int>& frame_of) {
  for_tracks(keys, [&](auto& track, KeyShapes& shapes) { place(track, shapes, frame_of, true); });
  drop_empty(keys);
}

void move_bone_keys(Keys& keys, const std::string& bone, const std::map<int, int>& frame_of) {
  place(keys.bones[bone], keys.shapes[bone], frame_of, false);
  drop_empty(keys);
}

void move_root_keys(Keys& keys, const std::map<int, int>& frame_of) {
  place(keys.root, keys.root_shapes, frame_of, false);
}

void delete_bone_keys(Keys& keys, const std::string& bone, const std::set<int>& frames) {
  remove(keys.bones[bone], keys.shapes[bone], frames);
  drop_empty(keys);
}

void delete_root_keys(Keys& keys, const std::set<int>& frames) { remove(keys.root, keys.root_shapes, frames); }

}  // namespace limber
