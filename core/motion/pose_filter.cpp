// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/pose_filter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "core/base/error.h"

namespace limber {

namespace {

// Returns the cutoff of one pass. Two passes lower the frequency at which half of the power is left, so each pass needs
// a higher cutoff.
double of_two_passes(double cutoff) { return cutoff / std::pow(std::numbers::sqrt2 - 1, 0.25); }

// A Butterworth low-pass filter of second order.
class LowPass {
 public:
  LowPass(double rate, double cutoff) {
    const double k = std::tan(std::numbers::pi * of_two_passes(cutoff) / rate);
    const double norm = 1 / (1 + std::numbers::sqrt2 * k + k * k);
    in_ = k * k * norm;
    before_ = 2 * (k * k - 1) * norm;
    twice_before_ = (1 - std::numbers::sqrt2 * k + k * k) * norm;
  }

  // Filters values in place, from first to last. The filter starts as if the first value had always been there.
  template <class Iterator>
  void run(Iterator begin, Iterator end) const {
    double x1 = *begin, x2 = *begin, y1 = *begin, y2 = *begin;
    for (; begin != end; ++begin) {
      const double x = *begin, y = in_ * (x + 2 * x1 + x2) - before_ * y1 - twice_before_ * y2;
      x2 = std::exchange(x1, x);
      y2 = std::exchange(y1, y);
      *begin = y;
    }
  }

 private:
  double in_, before_, twice_before_;
};

// Filters the track forwards and backwards. First the straight line between the track's ends is subtracted; it is added
// again afterwards. The remainder is extended beyond each end by point reflection, by `margin` frames. The ends are
// then neither flattened nor do they ring.
void filter(std::vector<double>& track, const LowPass& low_pass, std::ptrdiff_t margin) {
  const std::ptrdiff_t count = std::ssize(track), period = 2 * (count - 1);
  const double first = track.front(), slope = (track.back() - first) / double(count - 1);
  for (std::ptrdiff_t i = 0; i < count; ++i) track[i] -= first + slope * double(i);
  std::vector<double> longer(count + 2 * margin);
  for (std::ptrdiff_t i = 0; i < std::ssize(longer); ++i) {
    const std::ptrdiff_t at = ((i - margin) % period + period) % period;
    longer[i] = at < count ? track[at] : -track[period - at];
  }
  low_pass.run(longer.begin(), longer.end());
  low_pass.run(longer.rbegin(), longer.rend());
  for (std::ptrdiff_t i = 0; i < count; ++i) track[i] = longer[margin + i] + first + slope * double(i);
}

}  // namespace

std::vector<Pose> smoothed(const std::vector<Pose>& poses, double rate, double cutoff) {
  if (!(cutoff > 0) || of_two_passes(cutoff) >= 0.49 * rate) {
    char frequencies[96];
    std::snprintf(frequencies, sizeof frequencies, "%g Hz in a motion of %g frames per second", cutoff, rate);
    throw Error("the cutoff frequency does not fit the motion", frequencies,
                "use a frequency above 0 and below two fifths of the frames per second, such as 6");
  }
  std::vector<Pose> result = poses;
  if (poses.size() < 3) return result;
  const LowPass low_pass(rate, cutoff);
  const auto margin = static_cast<std::ptrdiff_t>(std::min(std::ceil(3 * rate / cutoff), 1e6));
  std::vector<double> track(poses.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t f = 0; f < poses.size(); ++f) track[f] = poses[f].root_translation[axis];
    filter(track, low_pass, margin);
    for (std::size_t f = 0; f < poses.size(); ++f) result[f].root_translation[axis] = track[f];
  }
  for (std::size_t bone = 0; bone < poses.front().rotation.size(); ++bone) {
    // q and -q are the same rotation; each frame uses the sign that is nearer to the frame before.
    std::vector<glm::dquat> turn(poses.size());
    for (std::size_t f = 0; f < poses.size(); ++f) {
      turn[f] = poses[f].rotation[bone];
      if (f > 0 && glm::dot(turn[f], turn[f - 1]) < 0) turn[f] = -turn[f];
    }
    for (int part = 0; part < 4; ++part) {
      for (std::size_t f = 0; f < poses.size(); ++f) track[f] = turn[f][part];
      filter(track, low_pass, margin);
      for (std::size_t f = 0; f < poses.size(); ++f) turn[f][part] = track[f];
    }
    for (std::size_t f = 0; f < poses.size(); ++f) result[f].rotation[bone] = glm::normalize(turn[f]);
  }
  return result;
}

}  // namespace limber
