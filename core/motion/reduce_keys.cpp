// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/reduce_keys.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/motion/key_curve.h"

namespace limber {

namespace {

constexpr int kSteps = 3;  // steps of the Gauss-Newton method: a fourth step would change speeds by less than a percent
constexpr int kNear = 3;   // number of keys on either side of a removed key whose speeds are fitted again
// Weight of a small term in the fit that pulls a key's speed towards the central difference of the frames. It defines
// the speed where there are no frames between two keys.
constexpr double kPull = 1e-3;

double size_of_error(const glm::dquat& wanted, const glm::dquat& value) {
  return glm::degrees(glm::length(turn_between(value, wanted)));
}
double size_of_error(const glm::dvec3& wanted, const glm::dvec3& value) { return glm::length(wanted - value); }
glm::dvec3 way_from(const glm::dquat& from, const glm::dquat& to) { return turn_between(from, to); }
glm::dvec3 way_from(const glm::dvec3& from, const glm::dvec3& to) { return to - from; }
glm::dquat bezier_at(const glm::dquat& a, const glm::dvec3& v0, const glm::dquat& b, const glm::dvec3& v1,
                     double frames, double share) {
  return bezier_rotation(a, v0, b, v1, frames, share);
}
glm::dvec3 bezier_at(const glm::dvec3& a, const glm::dvec3& v0, const glm::dvec3& b, const glm::dvec3& v1,
                     double frames, double share) {
  return bezier_shift(a, v0, b, v1, frames, share);
}

struct SplineKey {
  int frame = 0;
  glm::dvec3 speed{0};
};
using Curve = std::vector<SplineKey>;

// Fits a curve through some of the recorded values. Keys are addressed by their index in `keys`.
template <class Value>
class Spline {
 public:
  // Makes a spline without keys; fitted() adds them.
  //   recorded  the values at frames 0, 1, ...
  //   allowed   the largest error at each frame
  Spline(const std::vector<Value>& recorded, const std::vector<double>& allowed, Progress& progress)
      : recorded_(recorded),
        allowed_(allowed),
        most_(*std::max_element(allowed.begin(), allowed.end())),
        progress_(progress) {}

  Curve fitted() {
    const int last = static_cast<int>(recorded_.size()) - 1;
    keys_ = {{0}, {last, {}}};
    keys_[0].speed = difference_at(0);
    keys_[1].speed = difference_at(last);
    fit(keys_, 0, 1);
    while (part_spans()) fit(keys_, 0, static_cast<int>(keys_.size()) - 1);
    remove_needless();
    return keys_;
  }

 private:
  struct Worst {
    int frame = -1;
    double error = 0;  // error divided by the error that is allowed at the frame
  };

  // Returns the speed at a frame as the central difference of the neighbouring frames.
  glm::dvec3 difference_at(int frame) const {
    const int before = std::max(0, frame - 1), after = std::min(static_cast<int>(recorded_.size()) - 1, frame + 1);
    return way_from(recorded_[before], recorded_[after]) / static_cast<double>(after - before);
  }

  Value value(const Curve& keys, int span, int frame) const {
    const SplineKey &a = keys[span], &b = keys[span + 1];
    const double frames = b.frame - a.frame;
    return bezier_at(recorded_[a.frame], a.speed, recorded_[b.frame], b.speed, frames, (frame - a.frame) / frames);
  }

  Worst worst_of(const Curve& keys, int span) const {
    if (progress_.cancelled()) throw Cancelled();
    Worst worst;
    for (int frame = keys[span].frame + 1; frame < keys[span + 1].frame; ++frame)
      if (const double error = size_of_error(recorded_[frame], value(keys, span, frame)) / allowed_[frame];
          error > worst.error)
        worst = {frame, error};
    return worst;
  }

  // Inserts a key at the worst frame of each span whose error is too large. Returns false if no span needs one.
  bool part_spans() {
    Curve parted;
    for (int span = 0; span + 1 < std::ssize(keys_); ++span) {
      parted.push_back(keys_[span]);
      if (const Worst worst = worst_of(keys_, span); worst.error > 1)
        parted.push_back({worst.frame, difference_at(worst.frame)});
    }
    parted.push_back(keys_.back());
    const bool any = parted.size() > keys_.size();
    keys_ = std::move(parted);
    return any;
  }

  // Returns the weight of a frame in the fit. Frames with a smaller allowed error have larger weights, so that frames
  // with a larger allowed error cannot bend the curve there. The smallest weight is 1, so that kPull stays small beside
  // all weights.
  double weight_of(int frame) const { return (most_ / allowed_[frame]) * (most_ / allowed_[frame]); }

  // Fits the speeds of the keys `low` to `high` to the frames of the adjacent spans. A change of a key's speed moves
  // the curve, to first order, by the cubic Hermite functions of the two spans at the key.
  void fit(Curve& keys, int low, int high) const {
    const int count = high - low + 1;
    std::vector<double> own(count), with_next(count);
    std::vector<glm::dvec3> wanted(count);
    for (int step = 0; step < kSteps; ++step) {
      std::fill(own.begin(), own.end(), kPull);
      std::fill(with_next.begin(), with_next.end(), 0.0);
      for (int i = 0; i < count; ++i) wanted[i] = kPull * (difference_at(keys[low + i].frame) - keys[low + i].speed);
      for (int span = std::max(0, low - 1); span <= high && span + 1 < std::ssize(keys); ++span) {
        const double frames = keys[span + 1].frame - keys[span].frame;
        const int i = span - low;
        for (int frame = keys[span].frame + 1; frame < keys[span + 1].frame; ++frame) {
          const double t = (frame - keys[span].frame) / frames, first = frames * t * (1 - t) * (1 - t),
                       second = -frames * t * t * (1 - t);
          const glm::dvec3 off = way_from(value(keys, span, frame), recorded_[frame]);
          const double weight = weight_of(frame);
          if (i >= 0) {
            own[i] += weight * first * first;
            wanted[i] += weight * first * off;
          }
          if (i + 1 < count) {
            own[i + 1] += weight * second * second;
            wanted[i + 1] += weight * second * off;
          }
          if (i >= 0 && i + 1 < count) with_next[i] += weight * first * second;
        }
      }
      for (int i = 1; i < count; ++i) {
        const double share = with_next[i - 1] / own[i - 1];
        own[i] -= share * with_next[i - 1];
        wanted[i] -= share * wanted[i - 1];
      }
      for (int i = count - 1; i >= 0; --i) {
        if (i + 1 < count) wanted[i] -= with_next[i] * wanted[i + 1];
        wanted[i] /= own[i];
        keys[low + i].speed += wanted[i];
      }
    }
  }

  // Removes the key if `fresh` is empty; else replaces the key and the next one by the one key of `fresh`. Then fits
  // the speeds of the neighbouring keys again. Returns whether all changed spans stay within the allowed error; if not,
  // changes nothing. Works on a copy of the neighbouring keys only, because a long recording has very many keys.
  bool replace(int key, const Curve& fresh) {
    const int last = static_cast<int>(keys_.size()) - 2, low = std::max(0, key - kNear),
              high = std::min(last, key + kNear - 1), begin = std::max(0, low - 1), end = std::min(last, high + 1) + 2;
    Curve near(keys_.begin() + begin, keys_.begin() + key);
    near.insert(near.end(), fresh.begin(), fresh.end());
    near.insert(near.end(), keys_.begin() + key + 1 + std::ssize(fresh), keys_.begin() + end);
    fit(near, low - begin, high - begin);
    for (int span = 0; span + 1 < std::ssize(near); ++span)
      if (worst_of(near, span).error > 1) return false;
    keys_.erase(keys_.begin() + key);
    std::copy(near.begin(), near.end(), keys_.begin() + begin);
    return true;
  }

  // Replaces a key and the next one by one key between them, if the curve then stays within the allowed error. Returns
  // whether it did so.
  bool merge(int key) {
    const SplineKey from = keys_[key], to = keys_[key + 1];
    for (const double share : {0.5, 0.25, 0.75}) {
      const int frame = from.frame + static_cast<int>(std::lround(share * (to.frame - from.frame)));
      if (frame != from.frame && frame != to.frame && replace(key, {{frame, (from.speed + to.speed) / 2.0}}))
        return true;
    }
    return false;
  }

  // Removes and merges keys while the curve stays within the allowed error.
  void remove_needless() {
    for (bool any = true; any;) {
      any = false;
      for (int key = 1; key + 1 < std::ssize(keys_); ++key)
        if (replace(key, {})) {
          any = true;
          --key;
        }
      for (int key = 1; key + 2 < std::ssize(keys_); ++key) any |= merge(key);
    }
  }

  const std::vector<Value>& recorded_;
  const std::vector<double>& allowed_;
  double most_;
  Progress& progress_;
  Curve keys_;
};

// Returns the keys of the recorded values. If the value is `rest` at every frame, there are no keys.
template <class Value>
ReducedTrack<Value> reduced(const std::vector<Value>& recorded, const Value& rest, int start,
                            const std::vector<double>& allowed, Progress& progress) {
  ReducedTrack<Value> track;
  const auto all_are = [&](const Value& value) {
    return std::all_of(recorded.begin(), recorded.end(),
                       [&](const Value& one) { return size_of_error(one, value) < 1e-9; });
  };
  if (all_are(rest)) return track;
  if (all_are(recorded[0])) {
    track.keys[start] = recorded[0];
    return track;
  }
  for (const SplineKey& key : Spline<Value>(recorded, allowed, progress).fitted()) {
    track.keys[start + key.frame] = recorded[key.frame];
    track.shapes[start + key.frame] = {Interpolation::Bezier, HandleKind::Aligned, key.speed, key.speed};
  }
  for (int i = 0; i < std::ssize(recorded); ++i)
    track.error = std::max(track.error, size_of_error(recorded[i], value_at(track.keys, track.shapes, start + i)));
  return track;
}

}  // namespace

AllowedErrors allowed_everywhere(const Armature& armature, std::size_t frames, const ReduceSettings& settings) {
  if (!(settings.degrees > 0) || !(settings.mm > 0))
    throw Error("the allowed error must be positive", "keys", "enter an error above 0");
  return {std::vector(armature.bones.size(), std::vector(frames, settings.degrees)), std::vector(frames, settings.mm)};
}

ReducedKeys reduced_to_keys(const Armature& armature, const std::vector<Pose>& poses, int start,
                            const ReduceSettings& settings, Progress& progress) {
  return KeyFitter(armature, poses, start).fitted(allowed_everywhere(armature, poses.size(), settings), progress);
}

KeyFitter::KeyFitter(const Armature& armature, const std::vector<Pose>& poses, int start)
    : armature_(armature),
      poses_(poses),
      start_(start),
      allowed_{std::vector<std::vector<double>>(armature.bones.size()), {}},
      tracks_(armature.bones.size()) {}

ReducedKeys KeyFitter::fitted(const AllowedErrors& allowed, Progress& progress) {
  ReducedKeys result;
  if (poses_.empty()) return result;
  parallel_for(std::ssize(tracks_), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t bone = begin; bone < end; ++bone) {
      if (progress.cancelled()) throw Cancelled();
      if (allowed_.degrees[bone] == allowed.degrees[bone]) continue;
      std::vector<glm::dquat> recorded;
      for (const Pose& pose : poses_) recorded.push_back(pose.rotation[bone]);
      tracks_[bone] = reduced(recorded, glm::dquat(1, 0, 0, 0), start_, allowed.degrees[bone], progress);
      allowed_.degrees[bone] = allowed.degrees[bone];
    }
  });
  for (std::size_t bone = 0; bone < tracks_.size(); ++bone) {
    const std::string& name = armature_.bones[bone].name;
    const auto& [keys, shapes, error] = tracks_[bone];
    if (error > result.most_degrees) {
      result.most_degrees = error;
      result.worst_bone = name;
    }
    result.count += std::ssize(keys);
    if (!keys.empty()) result.keys.bones[name] = keys;
    if (!shapes.empty()) result.keys.shapes[name] = shapes;
  }
  if (allowed_.mm != allowed.mm) {
    std::vector<glm::dvec3> shift;
    for (const Pose& pose : poses_) shift.push_back(pose.root_translation);
    root_ = reduced(shift, glm::dvec3(0), start_, allowed.mm, progress);
    allowed_.mm = allowed.mm;
  }
  result.count += std::ssize(root_.keys);
  result.most_mm = root_.error;
  result.keys.root = root_.keys;
  result.keys.root_shapes = root_.shapes;
  return result;
}

}  // namespace limber
