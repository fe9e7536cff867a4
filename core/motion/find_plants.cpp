// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds when the feet of a motion stand (plants_of_feet()), and when limbs rest at a place (plants_at_rest()).
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/motion/plants.h"

namespace limber {

namespace {

// A foot stands while it moves slower than kStanding, mm/s, and is less than kLifted, mm, above its lowest positions.
// Both limits are for a leg of length kUsualLeg, mm, and are scaled with the length of the leg.
constexpr double kStanding = 250, kLifted = 60, kUsualLeg = 850;
// A limb rests if it moves less than this distance, mm, within kShortestStance seconds, and stays this near to one
// position.
constexpr double kRest = 2;
// If a limb drifts slowly before or after a rest, the rest is searched for with this limit instead of kRest, mm.
constexpr double kHeld = 0.3;
constexpr double kLowest = 0.02;         // quantile of a point's heights that is taken as the height of the ground
constexpr double kShortestStance = 0.1;  // seconds; shorter stances are ignored
constexpr double kLongestGap = 0.05;     // seconds; a shorter interruption does not end a stance

// Returns the spans of frames for which `stands` is true. Short interruptions are closed and short spans dropped.
std::vector<std::array<int, 2>> spans_of(const std::vector<bool>& stands, double rate) {
  const int longest_gap = static_cast<int>(kLongestGap * rate);
  const int shortest = std::max(2, static_cast<int>(std::ceil(kShortestStance * rate)));
  std::vector<std::array<int, 2>> spans;
  for (int f = 0; f < std::ssize(stands); ++f) {
    if (!stands[f]) continue;
    if (!spans.empty() && f - spans.back()[1] <= longest_gap + 1) spans.back()[1] = f;
    else spans.push_back({f, f});
  }
  std::erase_if(spans, [&](const auto& span) { return span[1] - span[0] + 1 < shortest; });
  return spans;
}

// Finds the spans of frames in which a point of the foot stands on the ground.
//   size  the leg's length as a multiple of kUsualLeg
std::vector<std::array<int, 2>> stances_of(const std::vector<glm::dvec3>& places, double size, double rate) {
  std::vector<double> heights;
  for (const glm::dvec3& place : places) heights.push_back(place.z);
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kLowest * double(heights.size() - 1));
  std::nth_element(heights.begin(), low, heights.end());
  const double ground = *low;
  std::vector<bool> stands(places.size());
  const int last = static_cast<int>(places.size()) - 1;
  for (int f = 0; f <= last; ++f) {
    const int before = std::max(0, f - 1), after = std::min(last, f + 1);
    const double speed = glm::distance(places[before], places[after]) * rate / std::max(1, after - before);
    stands[f] = speed < kStanding * size && places[f].z < ground + kLifted * size;
  }
  return spans_of(stands, rate);
}

int window_of(double rate) { return std::max(1, static_cast<int>(std::lround(kShortestStance * rate))); }

glm::dvec3 mean_of(const std::vector<glm::dvec3>& values, int first, int last) {
  glm::dvec3 sum(0);
  for (int f = first; f <= last; ++f) sum += values[f];
  return sum / double(last - first + 1);
}

// Finds the spans of frames in `within` in which a point is still: it moves less than `near` mm within `window` frames
// before or after.
std::vector<std::array<int, 2>> still_spans(const std::vector<glm::dvec3>& places, const std::array<int, 2>& within,
                                            int window, double near) {
  // A point counts as still in a frame if it does not move in the frames just before or in those just after. In the
  // first frame of a rest it has moved just before, in the last frame it moves just after.
  const auto is_still = [&](int f) {
    const auto stays_to = [&](int g) {
      return g >= 0 && g < std::ssize(places) && glm::distance(places[f], places[g]) < near;
    };
    return stays_to(f - window) || stays_to(f + window);
  };
  std::vector<std::array<int, 2>> spans;
  for (int f = within[0]; f <= within[1]; ++f) {
    if (!is_still(f)) continue;
    if (!spans.empty() && spans.back()[1] == f - 1) spans.back()[1] = f;
    else spans.push_back({f, f});
  }
  return spans;
}

// Returns the longest part of a span in which a still point stays within `near` mm of one position. Returns nothing if
// the point drifts.
std::optional<Plant> rest_in(const std::vector<glm::dvec3>& places, const std::array<int, 2>& span, int window,
                             double near) {
  auto [from, to] = span;
  if (to - from < window) return {};
  // The position is the mean of the middle half of the frames: in the first and last quarter the limb may still move.
  const int quarter = (to - from + 1) / 4;
  const glm::dvec3 place = mean_of(places, from + quarter, to - quarter);
  const auto is_there = [&](int f) { return glm::distance(places[f], place) <= near; };
  while (from <= to && !is_there(from)) ++from;
  while (from <= to && !is_there(to)) --to;
  // In the frames of the span outside from .. to the limb arrives or leaves. If either takes more than `window` frames,
  // the limb drifts and does not rest.
  bool stays = to - from >= window && from - span[0] <= window && span[1] - to <= window;
  for (int f = from; f <= to; ++f) stays = stays && is_there(f);
  if (!stays) return {};
  return Plant{.first = from, .last = to, .place = mean_of(places, from, to)};
}

// Finds the spans of frames in which a point rests, and the point's mean position in each span.
std::vector<Plant> rests_of(const std::vector<glm::dvec3>& places, double rate) {
  const int window = window_of(rate);
  std::vector<Plant> rests;
  for (const auto& span : still_spans(places, {0, static_cast<int>(places.size()) - 1}, window, kRest)) {
    if (const auto rest = rest_in(places, span, window, kRest)) {
      rests.push_back(*rest);
      continue;
    }
    // The span is a slow drift, but a limb may rest in a part of it. Such a rest is far stiller than a drift, so it is
    // searched for with the smaller limit kHeld.
    for (const auto& inner : still_spans(places, span, window, kHeld))
      if (const auto rest = rest_in(places, inner, window, kHeld)) rests.push_back(*rest);
  }
  return rests;
}

// Sets the position of each plant of a foot's tip to the mean over its frames. Plants of the tip during which the joint
// stays planted get the same position.
//   tips, joints  plants of one foot, sorted by frames
void place_tips(std::vector<Plant>& tips, const std::vector<Plant>& joints, const std::vector<glm::dvec3>& tip) {
  for (std::size_t from = 0, to = 0; from < tips.size(); from = to) {
    const auto is_held_on = [&](const Plant& before, const Plant& after) {
      return std::any_of(joints.begin(), joints.end(),
                         [&](const Plant& joint) { return joint.first <= before.last && joint.last >= after.first; });
    };
    for (to = from + 1; to < tips.size() && is_held_on(tips[to - 1], tips[to]);) ++to;
    glm::dvec3 sum(0);
    int frames = 0;
    for (std::size_t k = from; k < to; ++k)
      for (int f = tips[k].first; f <= tips[k].last; ++f, ++frames) sum += tip[f];
    for (std::size_t k = from; k < to; ++k) tips[k].place = sum / double(frames);
  }
}

double length_of(const PlantedLimb& leg, const Armature& armature) {
  const glm::dvec3 hip = armature.bones[leg.upper].head, knee = armature.bones[leg.lower].head,
                   ankle = leg.end >= 0 ? armature.bones[leg.end].head : armature.bones[leg.lower].tail;
  return glm::distance(hip, knee) + glm::distance(knee, ankle);
}

}  // namespace

std::vector<Plant> plants_of_feet(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                  const std::vector<Pose>& poses, double rate, Progress& progress) {
  std::vector<Plant> plants;
  if (poses.empty()) return plants;
  const LimbTracks tracks = limb_tracks(armature, limbs, poses, progress);
  for (int l = 0; l < std::ssize(limbs); ++l) {
    const PlantedLimb& limb = limbs[l];
    if (!limb.is_leg) continue;
    const auto& [joint, tip] = tracks[l];
    const double size = length_of(limb, armature) / kUsualLeg;
    std::vector<Plant> tips, joints;
    if (limb.end >= 0)
      for (const auto& [first, last] : stances_of(tip, size, rate))
        tips.push_back({l, PlantPoint::Tip, first, last, {}});
    for (const auto& [first, last] : stances_of(joint, size, rate))
      joints.push_back({l, PlantPoint::Joint, first, last, mean_of(joint, first, last)});
    place_tips(tips, joints, tip);
    for (Plant& plant : joints) {
      // Moves the joint's plant so that its distance from the tip's plant is the length of the foot.
      for (const Plant& other : tips) {
        const int from = std::max(plant.first, other.first), to = std::min(plant.last, other.last);
        if (from > to) continue;
        const glm::dvec3 along = mean_of(joint, from, to) - mean_of(tip, from, to);
        const Bone& foot = armature.bones[limb.end];
        if (glm::length(along) > 0)
          plant.place = other.place + glm::normalize(along) * glm::distance(foot.head, foot.tail);
        break;
      }
    }
    plants.insert(plants.end(), joints.begin(), joints.end());
    plants.insert(plants.end(), tips.begin(), tips.end());
  }
  return plants;
}

std::vector<Plant> plants_at_rest(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                  const std::vector<Pose>& poses, double rate, Progress& progress) {
  const LimbTracks tracks = limb_tracks(armature, limbs, poses, progress);
  std::vector<Plant> plants;
  for (int l = 0; l < std::ssize(limbs); ++l)
    for (const PlantPoint point : {PlantPoint::Joint, PlantPoint::Tip}) {
      // For hands only the tip is examined, since a hand holds on to things with its tip. For feet, joint and tip are
      // examined.
      if (point == PlantPoint::Joint ? !limbs[l].is_leg : limbs[l].is_leg && limbs[l].end < 0) continue;
      for (Plant rest : rests_of(tracks[l][static_cast<int>(point)], rate)) {
        rest.limb = l;
        rest.point = point;
        plants.push_back(rest);
      }
    }
  return plants;
}

std::vector<Plant> held_by_world(const std::vector<Plant>& rests, const Armature& armature,
                                 const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& poses, double rate,
                                 Progress& progress) {
  const int last = static_cast<int>(poses.size()) - 1, window = window_of(rate);
  std::vector<Plant> held;
  for (const Plant& rest : rests) {
    const PlantedLimb& limb = limbs[rest.limb];
    const int trunk = armature.bones[limb.upper].parent;
    bool moves = limb.is_leg || trunk < 0;
    if (!moves) {
      // Computes the positions of the point relative to the trunk.
      const int from = std::max(0, rest.first - window), to = std::min(last, rest.last + window);
      std::vector<glm::dvec3> places;
      for (int f = from; f <= to; ++f) {
        if (progress.cancelled()) throw Cancelled();
        const RigidTransform posed = posed_from_rest(armature, poses[f])[trunk];
        places.push_back(inverse(posed) * place_of(limb, rest.point, armature, poses[f]));
      }
      const glm::dvec3 place = mean_of(places, rest.first - from, rest.last - from);
      moves = std::any_of(places.begin(), places.end(),
                          [&](const glm::dvec3& at) { return glm::distance(at, place) > kRest; });
    }
    if (moves) held.push_back(rest);
  }
  return held;
}

}  // namespace limber
