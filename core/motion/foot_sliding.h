// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the feet of a body that follows another's motion from sliding further than that one's feet do.
//
// Legs of other proportions take steps of other lengths and bend to other heights, so a body that travels as its
// source's hips do slides and floats. Three things may give: the body's travel, thighs and shanks that turn a little,
// and feet that do. Over the whole take they are the least squares of
//   sum over frames, legs, points p (ankle, toes):  stands_p |slide_p|^2 / (speed_p^2 + still^2)^(3/2)
// with slide_p what the point moves more than its source, plus little for what gives and for how fast it does. So of a
// foot that rolls the stiller point holds, and what two feet that stand want differently is taken up by their legs
// before, between and after. Where a bone would turn more than it may, its leg or foot is held harder and all is solved
// again. Vertically low feet are as high above where they rest as the source's above their lowest place.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

// Of one leg, by frame: mm, z up, the source's scaled to the body.
struct FootTrack {
  enum Point { Ankle, Toes };
  std::array<std::vector<glm::dvec3>, 2> source,
      body;                           // of the body before it is mended; without toes the second are empty
  double rest_height = 0;             // of the body's ankle
  std::vector<glm::dvec3> hip, knee;  // of the body; without a shank the knee is the ankle
  double most_turn = 0;               // radians that thigh, shank and foot may be turned
  bool has_toes() const { return !source[Toes].empty(); }
};

struct FootMending {
  std::vector<glm::dvec3> travel;  // by frame: added to the body's place
  std::vector<std::vector<glm::dvec2>> ankle_aside,
      toes_aside;  // by leg and frame: mm that the ankle is moved by the leg, and the toes by the foot beside it
};

// Rotation vectors in the world: small turns of thigh and shank that move the ankle aside along the ground and, where
// the knee is bent, keep its height; of all that do so the least.
struct TurnsOfLeg {
  glm::dvec3 thigh, shank;
  double most() const { return std::max(glm::length(thigh), glm::length(shank)); }
};
//   thigh, shank  from hip to knee and on to the ankle
TurnsOfLeg turns_of_leg(const glm::dvec3& thigh, const glm::dvec3& shank, const glm::dvec2& ankle_aside);

// At most two legs. `along_ground`: otherwise only heights are mended. Nothing gives at frame 0.
FootMending mend_sliding(const std::vector<FootTrack>& legs, double frame_time, bool along_ground);

}  // namespace limber
