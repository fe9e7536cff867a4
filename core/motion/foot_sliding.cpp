// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/foot_sliding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace limber {

namespace {
// Speeds of a foot, mm/s. A foot slower than kStanding counts as standing; one faster than twice kStanding does not
// count at all. The slower a standing foot, the more its sliding costs; below about kStill the cost no longer grows.
constexpr double kStanding = 200, kStill = 20;
// Height of a foot above its lowest position, mm, up to which the foot counts fully as standing. The weight falls to 0
// at twice this height.
constexpr double kLifted = 60;
// The body's height is corrected in each frame by the weighted mean of what the two feet need. A foot's weight is from
// 0 (lifted) to 1 (standing), plus this number, so that the sum of the weights is never 0.
constexpr double kInTheAir = 0.02;
constexpr double kOfToes = 0.2;  // factor on the cost of sliding toes, relative to a sliding ankle
// Costs of correcting a foot's position. For comparison: a foot that should stand still but slides at 1 mm/s costs 1 /
// kStill^2 per second.
constexpr double kGiven = 1e-6;   // cost of the size of a correction, per mm^2 and second
constexpr double kGiving = 1e-7;  // cost of the rate of change of a correction, per (mm/s)^2 and second
constexpr int kMostRounds = 40;
// A stance is a span of frames in which an ankle or the toes of the source stand on the ground. If the body's ankle or
// toes slide further than allowed in a stance, the weight of this stance (its "urge") grows from round to round.
constexpr double kShortestStance = 0.1;       // seconds; a shorter stance is ignored
constexpr double kMaySlide = 1.01;            // allowed slide of the body's foot, as a multiple of the source's slide
constexpr double kMayExceed[] = {0.25, 0.6};  // mm added to the allowed slide: of the ankle, of the toes
// Factor on kMayExceed for stances that are found with the full limits of speed and height. Stances that are found with
// half of these limits have the factor 1.
constexpr double kMayExceedMoving = 3;
// The factor by which the weight of a stance (its "urge") is multiplied in one round is clamped to this range.
constexpr double kLeastUrging = 0.8, kMostUrging = 1.5;
// Regularization of the rotations of thigh and shank that move the ankle (turns_of_leg), as a share of the summed
// squared lengths of thigh and shank. kMayMiss is for horizontal movement, kMayRise for vertical. The larger the share,
// the further the ankle may end from its target.
constexpr double kMayMiss = 1e-4, kMayRise = 0.04;

// The number of unknowns per frame along one horizontal axis: the correction of the body's travel, then for each of two
// legs the displacement of the ankle and of the toes, all in mm.
constexpr int kUnknowns = 5;
using Block = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Sides = Eigen::Matrix<double, kUnknowns, 2>;  // the unknowns along x in column 0, along y in column 1
int swing_of(std::size_t leg) { return 1 + 2 * static_cast<int>(leg); }
int turn_of(std::size_t leg) { return 2 + 2 * static_cast<int>(leg); }

// A quadratic energy over the frames of a motion, whose terms couple only neighbouring frames. With the unknowns u[f]
// of frame f it is the sum over f of
//   (u[f] - u[f-1])' link[f] (u[f] - u[f-1]) + 2 (u[f] - u[f-1])' pull[f] + u[f]' diag(hold[f]) u[f]
// least() minimizes it by block elimination: a pass forward through the frames, and a pass back.
struct Chain {
  std::vector<Block> link;
  std::vector<Sides> pull;
  std::vector<Eigen::Matrix<double, kUnknowns, 1>> hold;

  explicit Chain(int frames)
      : link(frames, Block::Zero()),
        pull(frames, Sides::Zero()),
        hold(frames, Eigen::Matrix<double, kUnknowns, 1>::Zero()) {}

  std::vector<Sides> least() const {
    const int frames = static_cast<int>(link.size());
    std::vector<Block> carry(frames);
    std::vector<Sides> u(frames);
    for (int f = 0; f < frames; ++f) {
      Block own = link[f];
      own.diagonal() += hold[f];
      Sides right = -pull[f];
      if (f + 1 < frames) own += link[f + 1], right += pull[f + 1];
      if (f > 0) own -= link[f] * carry[f - 1], right += link[f] * u[f - 1];
      const Eigen::LDLT<Block> solver(own);
      if (f + 1 < frames) carry[f] = solver.solve(link[f + 1]);
      u[f] = solver.solve(right);
    }
    for (int f = frames - 2; f >= 0; --f) u[f] += carry[f] * u[f + 1];
    return u;
  }
};

// Computes the rotation by which a leg moves its ankle by `aside`, mm. Returns this rotation divided by the largest
// allowed one, so that a result above 1 is not allowed.
double share_of_leg(const FootTrack& leg, std::size_t frame, const glm::dvec2& aside) {
  return turns_of_leg(leg.knee[frame] - leg.hip[frame], leg.body[FootTrack::Ankle][frame] - leg.knee[frame], aside)
             .most() /
         leg.most_turn;
}
double share_of_foot(const FootTrack& leg, std::size_t frame, const glm::dvec2& aside) {
  const glm::dvec3 toes = leg.body[FootTrack::Toes][frame] - leg.body[FootTrack::Ankle][frame];
  const double down = std::max(std::abs(toes.z), 1.0);
  return std::hypot(glm::length(aside), glm::dot(glm::dvec2(toes), aside) / down) /
         (leg.most_turn * std::max(glm::length(toes), 1.0));
}

std::vector<double> lowest_places(const FootTrack& leg) {
  std::vector<double> lowest;
  for (const auto& places : leg.source) {
    lowest.push_back(1e300);
    for (const glm::dvec3& place : places) lowest.back() = std::min(lowest.back(), place.z);
  }
  return lowest;
}

// A stance: the frames [begin, end) during which a point (ankle or toes) of the source stands on the ground.
struct Stance {
  std::size_t leg;
  int point;
  std::size_t begin, end;
  // The distance that the source's point slides during the stance, and the excess that the body's point is allowed
  // above kMaySlide times this distance, mm.
  double slides, may_exceed;
};

template <typename PlaceAt>
double slide_in(std::size_t begin, std::size_t end, PlaceAt place_at) {
  const glm::dvec2 first(place_at(begin));
  double farthest = 0;
  for (std::size_t f = begin + 1; f < end; ++f)
    farthest = std::max(farthest, glm::distance(first, glm::dvec2(place_at(f))));
  return farthest;
}

// Returns all stances (spans of frames in which a foot is below the limits of speed and height). Spans that also stay
// below half of both limits are listed a second time, with a smaller allowed slide.
std::vector<Stance> stances_of(const std::vector<FootTrack>& legs, const std::vector<std::vector<double>>& ground,
                               double frame_time) {
  std::vector<Stance> stances;
  for (std::size_t leg = 0; leg < legs.size(); ++leg) {
    for (const int point : {FootTrack::Ankle, FootTrack::Toes}) {
      const auto& places = legs[leg].source[point];
      for (const double part : {1.0, 0.5}) {
        const auto stands = [&](std::size_t f) {
          const double moved = glm::distance(glm::dvec2(places[f]), glm::dvec2(places[f - 1]));
          return moved < part * kStanding * frame_time && places[f].z < ground[leg][point] + part * kLifted;
        };
        for (std::size_t begin = 0, end = 0; begin + 1 < places.size(); begin = end) {
          for (end = begin + 1; end < places.size() && stands(end);) ++end;
          if (static_cast<double>(end - 1 - begin) * frame_time < kShortestStance) continue;
          const double slides = slide_in(begin, end, [&](std::size_t f) { return places[f]; });
          stances.push_back({leg, point, begin, end, slides, (part == 1 ? kMayExceedMoving : 1) * kMayExceed[point]});
        }
      }
    }
  }
  return stances;
}

using Urges = std::vector<std::array<std::vector<double>, 2>>;  // weight of each leg's ankle and toes at each frame

// Sets the energy terms that couple neighbouring frames: the cost of sliding ankles and toes, and the cost of the rate
// of change of the corrections.
void link_slides(const std::vector<FootTrack>& legs, const std::vector<std::vector<double>>& ground, const Urges& urges,
                 double frame_time, Chain& chain) {
  for (std::size_t f = 1; f < chain.link.size(); ++f) {
    chain.link[f] = Block::Identity() * (kGiving / frame_time);
    chain.pull[f].setZero();
    for (std::size_t i = 0; i < legs.size(); ++i) {
      for (const int point : {FootTrack::Ankle, FootTrack::Toes}) {
        if (point == FootTrack::Toes && !legs[i].has_toes()) continue;
        const auto &source = legs[i].source[point], &body = legs[i].body[point];
        const glm::dvec2 moved = source[f] - source[f - 1], slid = glm::dvec2(body[f] - body[f - 1]) - moved;
        const double speed = glm::length(moved) / frame_time;
        const double stands = std::clamp(2 - (source[f].z - ground[i][point]) / kLifted, 0.0, 1.0) *
                              std::clamp(2 - speed / kStanding, 0.0, 1.0);
        const double still = kStill / std::hypot(speed, kStill),
                     of_point = (point == FootTrack::Toes ? kOfToes : 1) * urges[i][point][f];
        const double counts = of_point * stands * still * still * still / (kStill * kStill * frame_time);
        Eigen::Matrix<double, kUnknowns, 1> moves =
            Eigen::Matrix<double, kUnknowns, 1>::Unit(0) + Eigen::Matrix<double, kUnknowns, 1>::Unit(swing_of(i));
        if (point == FootTrack::Toes) moves += Eigen::Matrix<double, kUnknowns, 1>::Unit(turn_of(i));
        chain.link[f] += counts * moves * moves.transpose();
        chain.pull[f] += counts * moves * Eigen::RowVector2d(slid.x, slid.y);
      }
    }
  }
}

// Minimizes the energy and stores the corrections of the feet in `mending`. A correction beyond its limit is cut to the
// limit, and its cost is raised for the next round. Returns false if any correction was cut.
bool solve_within_limits(const std::vector<FootTrack>& legs, double frame_time, Chain& chain, FootMending& mending) {
  const std::vector<Sides> given = chain.least();
  bool all_may = true;
  for (std::size_t f = 1; f < given.size(); ++f) {
    mending.travel[f].x = given[f](0, 0), mending.travel[f].y = given[f](0, 1);
    for (std::size_t i = 0; i < legs.size(); ++i) {
      const auto allowed = [&](int unknown, auto share_of) {
        const glm::dvec2 wanted(given[f](unknown, 0), given[f](unknown, 1));
        const double share = share_of(wanted);
        if (share > 1.001) all_may = false;
        chain.hold[f](unknown) = std::max(chain.hold[f](unknown) * share, kGiven * frame_time);
        return wanted / std::max(share, 1.0);
      };
      mending.ankle_aside[i][f] =
          allowed(swing_of(i), [&](const glm::dvec2& aside) { return share_of_leg(legs[i], f, aside); });
      if (legs[i].has_toes())
        mending.toes_aside[i][f] =
            allowed(turn_of(i), [&](const glm::dvec2& aside) { return share_of_foot(legs[i], f, aside); });
    }
  }
  return all_may;
}

// Returns the excess of the worst stance, as a multiple of the excess that is allowed for it; above 1, a foot slides
// too far. Raises the weights of stances whose excess is too large, and lowers the others.
double urge_stances(const std::vector<FootTrack>& legs, const std::vector<Stance>& stances, const FootMending& mending,
                    Urges& urges) {
  double worst = 0;
  for (const Stance& stance : stances) {
    const double slides = slide_in(stance.begin, stance.end, [&](std::size_t f) {
      const glm::dvec2 place =
          glm::dvec2(legs[stance.leg].body[stance.point][f] + mending.travel[f]) + mending.ankle_aside[stance.leg][f];
      return stance.point == FootTrack::Toes ? place + mending.toes_aside[stance.leg][f] : place;
    });
    const double excess = std::max(slides - kMaySlide * stance.slides, 0.0) / stance.may_exceed;
    worst = std::max(worst, excess);
    for (std::size_t f = stance.begin + 1; f < stance.end; ++f) {
      double& urge = urges[stance.leg][stance.point][f];
      urge = std::max(urge * std::clamp(std::sqrt(excess), kLeastUrging, kMostUrging), 1.0);
    }
  }
  return worst;
}
}  // namespace

TurnsOfLeg turns_of_leg(const glm::dvec3& thigh, const glm::dvec3& shank, const glm::dvec2& ankle_aside) {
  const auto reach_of = [](const glm::dvec3& way) {
    return glm::dmat3(glm::dot(way, way)) - glm::outerProduct(way, way);
  };
  glm::dmat3 reach = reach_of(thigh) + reach_of(shank);
  const double size = glm::dot(thigh, thigh) + glm::dot(shank, shank);
  for (const int axis : {0, 1, 2}) reach[axis][axis] += size * (axis == 2 ? kMayRise : kMayMiss);
  const glm::dvec3 pull = glm::inverse(reach) * glm::dvec3(ankle_aside, 0);
  return {glm::cross(thigh, pull), glm::cross(shank, pull)};
}

FootMending mend_sliding(const std::vector<FootTrack>& legs, double frame_time, bool along_ground) {
  const std::size_t frames = legs.front().source[FootTrack::Ankle].size();
  std::vector<std::vector<double>> ground;
  for (const FootTrack& leg : legs) ground.push_back(lowest_places(leg));

  FootMending mending;
  mending.travel.assign(frames, glm::dvec3(0));
  for (std::size_t f = 0; f < frames; ++f) {
    double lift = 0, weights = 0;
    for (std::size_t i = 0; i < legs.size(); ++i) {
      const double height = legs[i].source[FootTrack::Ankle][f].z - ground[i][FootTrack::Ankle];
      const double counts = std::clamp(2 - height / kLifted, 0.0, 1.0) + kInTheAir;
      lift += counts * (height - (legs[i].body[FootTrack::Ankle][f].z - legs[i].rest_height));
      weights += counts;
    }
    mending.travel[f].z = lift / weights;
  }
  if (!along_ground) return mending;

  mending.ankle_aside.assign(legs.size(), std::vector<glm::dvec2>(frames));
  mending.toes_aside = mending.ankle_aside;
  const std::vector<Stance> stances = stances_of(legs, ground, frame_time);
  Urges urges(legs.size());
  for (auto& of_points : urges) of_points.fill(std::vector<double>(frames, 1.0));
  Chain chain(static_cast<int>(frames));
  for (std::size_t f = 0; f < frames; ++f) chain.hold[f].tail<kUnknowns - 1>().setConstant(kGiven * frame_time);
  chain.hold[0].setConstant(1e3);

  FootMending best;
  double least_excess = std::numeric_limits<double>::infinity();
  for (int round = 0;; ++round) {
    link_slides(legs, ground, urges, frame_time, chain);
    const bool all_may = solve_within_limits(legs, frame_time, chain, mending);
    const double excess = urge_stances(legs, stances, mending, urges);
    if (excess < least_excess || (all_may && excess <= 1)) least_excess = excess, best = mending;
    if ((all_may && excess <= 1) || round == kMostRounds) return best;
  }
}

}  // namespace limber
