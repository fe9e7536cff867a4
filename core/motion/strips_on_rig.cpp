// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/strips_on_rig.h"

#include <algorithm>
#include <cmath>

#include "core/motion/clip.h"
#include "core/rig/mirror.h"

namespace limber {

namespace {

// frames; a frame number nearer than this to a whole number is rounded, so that rounding errors change no pose
constexpr double kWhole = 1e-6;

const glm::dquat kNoTurn(1, 0, 0, 0);

glm::dquat mixed(const glm::dquat& from, const glm::dquat& to, double share) {
  return share == 1 ? to : glm::normalize(glm::slerp(from, to, share));
}

// Returns `first`, then `second`, as one move.
GroundMove both(const GroundMove& first, const GroundMove& second) {
  return {first.turn + second.turn, first.from, second.place(first.to)};
}

int root_count(const Armature& armature) {
  return static_cast<int>(
      std::count_if(armature.bones.begin(), armature.bones.end(), [](const Bone& bone) { return bone.parent < 0; }));
}

}  // namespace

StripsOnRig::StripsOnRig(std::shared_ptr<const Strips> strips, std::shared_ptr<const Armature> armature, double rate,
                         const StripsOnRig* before)
    : strips_(std::move(strips)),
      armature_(std::move(armature)),
      has_one_root_(root_count(*armature_) == 1) {
  for (std::size_t t = 0; t < strips_->tracks.size(); ++t) {
    if (!plays(*strips_, t)) continue;
    const StripTrack& track = strips_->tracks[t];
    const std::vector<StripRun> runs = runs_of(track, rate);
    std::vector<OnRig> row;
    for (std::size_t i = 0; i < track.strips.size(); ++i)
      if (!track.strips[i].muted) row.push_back(prepared(track.strips[i], runs[i], rate, before));
    std::stable_sort(row.begin(), row.end(), [](const OnRig& a, const OnRig& b) { return a.run.head < b.run.head; });
    if (!row.empty()) tracks_.push_back(std::move(row));
  }
}

StripsOnRig::OnRig StripsOnRig::prepared(const Strip& strip, const StripRun& run, double rate,
                                         const StripsOnRig* before) {
  std::shared_ptr<const ClipOnRig>& clip = clips_[strip.clip.get()];
  if (!clip) {
    const ClipOnRig* known = nullptr;
    if (before)
      for (const auto& [of, on_rig] : before->clips_) {
        if (of == strip.clip.get() && on_rig->armature() == armature_) clip = on_rig;
        if (of->motion == strip.clip->motion) known = on_rig.get();
      }
    if (!clip) clip = std::make_shared<const ClipOnRig>(strip.clip, armature_, known);
    if (problem_.empty() && !clip->problem().empty())
      problem_ = "the strip \"" + strip.name + "\" does not move this rig: " + clip->problem();
  }
  OnRig one{.strip = &strip, .clip = clip, .run = run};
  one.ratio = frames_per_frame(strip, rate);
  one.total = frames_of_cycles(strip);
  one.end = end_of(strip, rate);
  find_bones(one);
  const double steps = strip.last - strip.first;
  if (one.strip->goes_on && has_one_root_ && strip.repeat > 1 && steps > 0)
    one.cycle = move_to(*armature_, cycle_pose(one, 0), cycle_pose(one, steps));
  if (strip.blend == StripBlend::AddChange) one.first_pose = cycle_pose(one, 0);
  return one;
}

void StripsOnRig::find_bones(OnRig& strip) const {
  if (!strip.strip->bones) return;
  strip.changes_root = false;
  for (const Bone& bone : armature_->bones) {
    const bool is_changed = strip.strip->bones->contains(bone.name);
    strip.changes.push_back(is_changed);
    if (is_changed && bone.parent < 0) strip.changes_root = true;
  }
}

Pose StripsOnRig::cycle_pose(const OnRig& one, double passed) const {
  const Strip& strip = *one.strip;
  const double frame = strip.reversed ? strip.last - passed : strip.first + passed;
  const double whole = std::round(frame);
  const auto pose_at = [&](double at) {
    const Pose pose = one.clip->at(static_cast<int>(at));
    return strip.mirrored ? flipped(pose, *armature_) : pose;
  };
  if (std::abs(frame - whole) < kWhole) return pose_at(whole);
  Pose pose = pose_at(std::floor(frame));
  const Pose after = pose_at(std::floor(frame) + 1);
  const double share = frame - std::floor(frame);
  for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone)
    pose.rotation[bone] = mixed(pose.rotation[bone], after.rotation[bone], share);
  pose.root_translation = glm::mix(pose.root_translation, after.root_translation, share);
  return pose;
}

Pose StripsOnRig::pose_of(const OnRig& one, int frame) const {
  const Strip& strip = *one.strip;
  const double steps = strip.last - strip.first;
  double passed =
      std::clamp(strip.skip + (double(frame) - strip.start) * one.ratio, std::min(strip.skip, one.total), one.total);
  // At the exact end of the last cycle the last pose plays, not the first pose of a further cycle.
  int cycles = 0;
  if (steps > 0) {
    cycles = static_cast<int>(std::floor(passed / steps + kWhole / steps));
    if (cycles > 0 && cycles * steps > one.total - kWhole) --cycles;
    passed = std::max(0.0, passed - cycles * steps);
  }
  Pose pose = cycle_pose(one, passed);
  if (!has_one_root_) return pose;
  GroundMove move;
  for (int cycle = 0; cycle < cycles && strip.goes_on; ++cycle) move = cycle == 0 ? one.cycle : both(move, one.cycle);
  if (strip.place != GroundMove{}) move = move == GroundMove{} ? strip.place : both(move, strip.place);
  return move == GroundMove{} ? pose : moved(*armature_, std::move(pose), move);
}

// Returns whether the last pose of an ended strip is still held. A strip that replaces the pose is held while later
// strips play, so that they fade in over its last pose. A strip that adds to the pose is held only until a later strip
// begins, since otherwise the effects of both would add up.
bool StripsOnRig::is_held(const std::vector<OnRig>& track, const OnRig& ended, int frame) {
  if (!ended.strip->holds || ended.strip->blend == StripBlend::Replace) return ended.strip->holds;
  return std::none_of(track.begin(), track.end(), [&](const OnRig& other) {
    return &other != &ended && other.run.start >= ended.end && other.run.start <= frame;
  });
}

std::vector<StripsOnRig::Layer> StripsOnRig::layers_at(int frame) const {
  std::vector<Layer> layers;
  const auto add = [&](const OnRig& one, int at) {
    const double share = one.strip->influence * share_at(one.run, at);
    if (share > 0) layers.push_back({&one, share});
  };
  for (const std::vector<OnRig>& track : tracks_) {
    // In a frame in which one strip ends and another begins, only the second plays.
    const bool begins = std::any_of(track.begin(), track.end(),
                                    [&](const OnRig& one) { return one.run.start == frame && one.run.end > frame; });
    std::vector<const OnRig*> ended, playing;
    for (const OnRig& one : track) {
      const bool is_over =
          one.end < frame || (one.end == frame && (one.run.has_next || (begins && one.run.start < frame)));
      if (is_over && one.run.has_next) continue;
      if (is_over) ended.push_back(&one);
      else if (one.strip->start <= frame) playing.push_back(&one);
    }
    std::stable_sort(ended.begin(), ended.end(), [](const OnRig* a, const OnRig* b) { return a->end < b->end; });
    for (const OnRig* one : ended)
      if (is_held(track, *one, frame)) add(*one, one->end);
    for (const OnRig* one : playing) add(*one, frame);
    const OnRig& first = track.front();
    if (ended.empty() && playing.empty() && first.strip->holds) add(first, first.strip->start);
  }
  return layers;
}

// Returns whether the layer replaces the whole pose below it.
bool StripsOnRig::covers(const Layer& layer) const {
  return layer.share == 1 && layer.strip->changes.empty() && layer.strip->strip->blend == StripBlend::Replace;
}

void StripsOnRig::blend(Pose& pose, const Layer& layer, int frame) const {
  const OnRig& one = *layer.strip;
  const Pose its = pose_of(one, frame);
  const bool replaces = one.strip->blend == StripBlend::Replace;
  for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone) {
    if (!one.changes.empty() && !one.changes[bone]) continue;
    glm::dquat& rotation = pose.rotation[bone];
    if (replaces) {
      rotation = mixed(rotation, its.rotation[bone], layer.share);
      continue;
    }
    const glm::dquat change =
        one.first_pose ? glm::conjugate(one.first_pose->rotation[bone]) * its.rotation[bone] : its.rotation[bone];
    if (change != kNoTurn) rotation = glm::normalize(rotation * mixed(kNoTurn, change, layer.share));
  }
  if (!one.changes_root) return;
  const glm::dvec3 shift = its.root_translation;
  if (replaces) pose.root_translation = layer.share == 1 ? shift : glm::mix(pose.root_translation, shift, layer.share);
  else pose.root_translation += layer.share * (one.first_pose ? shift - one.first_pose->root_translation : shift);
}

Pose StripsOnRig::at(int frame) const {
  const std::vector<Layer> layers = layers_at(frame);
  auto lowest = std::find_if(layers.rbegin(), layers.rend(), [&](const Layer& layer) { return covers(layer); });
  Pose pose = lowest == layers.rend() ? rest_pose(*armature_) : pose_of(*lowest->strip, frame);
  for (auto layer = lowest.base(); layer != layers.end(); ++layer) blend(pose, *layer, frame);
  return pose;
}

}  // namespace limber
