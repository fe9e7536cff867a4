// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/keyframes.h"

namespace limber {

namespace {

template <class Act>
void for_tracks(Keys& keys, const Act& act) {
  for (auto& [bone, track] : keys.bones) act(track);
  act(keys.root);
  std::erase_if(keys.bones, [](const auto& bone) { return bone.second.empty(); });
}

template <class Track>
void place(Track& track, const std::map<int, int>& frame_of, bool keep) {
  Track moved;
  for (const auto& [from, to] : frame_of)
    if (const auto key = track.find(from); key != track.end()) moved.emplace(to, key->second);
  if (!keep) std::erase_if(track, [&](const auto& key) { return frame_of.contains(key.first); });
  for (const auto& [frame, value] : moved) track[frame] = value;
}

}  // namespace

std::set<int> frames_of(const Keys& keys) {
  std::set<int> frames;
  for (const auto& [bone, track] : keys.bones)
    for (const auto& [frame, rotation] : track) frames.insert(frame);
  for (const auto& [frame, place] : keys.root) frames.insert(frame);
  return frames;
}

void insert_key(Keys& keys, const Armature& armature, const Pose& pose, const std::vector<int>& bones, int frame) {
  for (int bone : bones) {
    keys.bones[armature.bones[bone].name][frame] = pose.rotation[bone];
    if (armature.bones[bone].parent < 0) keys.root[frame] = pose.root_translation;
  }
}

bool delete_key(Keys& keys, const Armature& armature, const std::vector<int>& bones, int frame) {
  bool any = false;
  for (int bone : bones) {
    if (const auto track = keys.bones.find(armature.bones[bone].name); track != keys.bones.end())
      any |= track->second.erase(frame) > 0;
    if (armature.bones[bone].parent < 0) any |= keys.root.erase(frame) > 0;
  }
  std::erase_if(keys.bones, [](const auto& bone) { return bone.second.empty(); });
  return any;
}

void delete_keys(Keys& keys, const std::set<int>& frames) {
  for_tracks(keys,
             [&](auto& track) { std::erase_if(track, [&](const auto& key) { return frames.contains(key.first); }); });
}

void move_keys(Keys& keys, const std::map<int, int>& frame_of) {
  for_tracks(keys, [&](auto& track) { place(track, frame_of, false); });
}

void copy_keys(Keys& keys, const std::map<int, int>& frame_of) {
  for_tracks(keys, [&](auto& track) { place(track, frame_of, true); });
}

}  // namespace limber
