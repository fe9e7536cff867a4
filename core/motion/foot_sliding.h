// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the feet of a retargeted body from sliding further than the feet of its source.
//
// Legs of other proportions take steps of other lengths and bend to other heights. A body that travels exactly as the
// hips of its source would therefore slide and float. Three things are corrected: the body's travel, the thighs and
// shanks, which turn a little, and the feet, which turn a little too. The corrections minimize, over the whole motion,
//   sum over frames, legs, points p (ankle, toes):  stands_p |slide_p|^2 / (speed_p^2 + still^2)^(3/2)
// where slide_p is the difference between the motion of the point and that of the source's point; a small cost is added
// for each correction and for its rate of change. As a result, a rolling foot keeps its slower point in place. Where
// two standing feet disagree, the legs make up for it, before, during and after. Where a bone would turn beyond its
// limit, its cost is raised and the whole problem is solved again. Vertically, a low foot is as high above its rest
// height as the source's foot is above its lowest position.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

// The positions of one leg's joints at every frame, mm, z up. The source's positions are scaled to the body's size.
struct FootTrack {
  enum Point { Ankle, Toes };
  // Positions of ankle and toes: those of the source, and those of the body before the correction. The entry for the
  // toes is empty when the leg has no toes.
  std::array<std::vector<glm::dvec3>, 2> source, body;
  double rest_height = 0;             // height of the body's ankle in the rest pose, mm
  std::vector<glm::dvec3> hip, knee;  // positions of the body's joints, mm; a leg without a shank has its ankle as knee
  double most_turn = 0;               // largest rotation of thigh, shank and foot, radians
  bool has_toes() const { return !source[Toes].empty(); }
};

struct FootMending {
  std::vector<glm::dvec3> travel;  // shift of the body's position at each frame, mm
  // Displacements along the ground for each leg and frame, mm. The leg moves the ankle; the foot then moves the toes
  // further.
  std::vector<std::vector<glm::dvec2>> ankle_aside, toes_aside;
};

// The smallest rotations of thigh and shank that move the ankle along the ground and, where the knee is bent, keep the
// ankle's height. They are rotation vectors in world axes, radians.
struct TurnsOfLeg {
  glm::dvec3 thigh, shank;
  double most() const { return std::max(glm::length(thigh), glm::length(shank)); }
};
//   thigh, shank  vectors from hip to knee and from knee to ankle, mm
TurnsOfLeg turns_of_leg(const glm::dvec3& thigh, const glm::dvec3& shank, const glm::dvec2& ankle_aside);

// Computes the corrections for one or two legs. Without `along_ground` only the body's height is corrected. At frame 0
// nothing is corrected along the ground.
FootMending mend_sliding(const std::vector<FootTrack>& legs, double frame_time, bool along_ground);

}  // namespace limber
