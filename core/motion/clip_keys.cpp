// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/clip_keys.h"

#include <map>

#include "core/motion/constraint.h"

namespace limber {

void delete_clip_keys(Clip& clip, const std::set<int>& frames) {
  const std::map<std::string, std::map<int, double>> before = clip.keys.weights;
  delete_keys(clip.keys, frames);
  if (!clip.constraints || clip.keys.weights.size() == before.size()) return;
  Constraints constraints = *clip.constraints;
  for (Constraint& constraint : constraints.list)
    if (const auto track = before.find(constraint.name);
        track != before.end() && !clip.keys.weights.contains(constraint.name))
      constraint.weight = track->second.rbegin()->second;
  clip.constraints = std::make_shared<const Constraints>(std::move(constraints));
}

void delete_clip_keys_outside(Clip& clip, int low, int high) {
  const Keys before = clip.keys;
  for (std::size_t i = 0; clip.constraints && i < clip.constraints->list.size(); ++i) {
    const Constraint& constraint = clip.constraints->list[i];
    const auto track = before.weights.find(constraint.name);
    if (track == before.weights.end()) continue;
    for (const int end : {low, high})
      if (end == low ? track->second.begin()->first < low : track->second.rbegin()->first > high)
        insert_weight_key(clip.keys, constraint.name, end, weight_at(constraint, before, end));
  }
  std::set<int> outside;
  for (const int frame : frames_of(clip.keys))
    if (frame < low || frame > high) outside.insert(frame);
  delete_clip_keys(clip, outside);
}

}  // namespace limber
