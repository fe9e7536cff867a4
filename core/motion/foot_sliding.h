// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the feet of a retargeted body from sliding further than the feet of its source.
//
// The source is the recorded skeleton. Since the legs of the body have other proportions, feet slide and float if the
// body travels exactly as the source's hips. The corrections shift the body's travel and slightly rotate thighs, shanks
// and feet. They minimize, over the whole motion,
//   sum over frames, legs, points p (ankle, toes):  stands_p |slide_p|^2 / (speed_p^2 + still^2)^(3/2)
// where stands_p is 1 for a point on the ground and 0 for one in the air, speed_p is the speed of the source's point,
// and slide_p is the difference between the movements of the body's point and the source's point. A small cost is added
// for the size of each correction and for its rate of change. As a result, the slower point of a rolling foot stays in
// place. If two standing feet need different shifts, rotations of the legs make up the difference. If a bone would
// rotate beyond its limit, its cost is raised and the whole problem is solved again. Vertically, the body is shifted so
// that a low foot is as high above its rest height as the source's foot is above its lowest position.
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
  double most_turn = 0;               // largest allowed rotation of thigh, shank and foot, radians
  bool has_toes() const { return !source[Toes].empty(); }
};

struct FootMending {
  std::vector<glm::dvec3> travel;  // shift of the body's position at each frame, mm
  // Corrections of ankle and toes along the ground, for each leg and frame, mm. Rotations of thigh and shank move the
  // ankle, and the toes with it; a rotation of the foot then moves the toes further.
  std::vector<std::vector<glm::dvec2>> ankle_aside, toes_aside;
};

// The smallest rotations of thigh and shank that move the ankle along the ground. If the knee is bent, they also keep
// the ankle's height. Rotation vectors in world axes, radians.
struct TurnsOfLeg {
  glm::dvec3 thigh, shank;
  double most() const { return std::max(glm::length(thigh), glm::length(shank)); }
};
// Returns the rotations of thigh and shank that move the ankle by `ankle_aside`.
//   thigh, shank  vectors from hip to knee and from knee to ankle, mm
//   ankle_aside   wanted displacement of the ankle along the ground, mm
TurnsOfLeg turns_of_leg(const glm::dvec3& thigh, const glm::dvec3& shank, const glm::dvec2& ankle_aside);

// Computes the corrections that keep the feet of one or two legs from sliding. If `along_ground` is false, only the
// body's height is corrected. At frame 0 nothing is corrected along the ground.
FootMending mend_sliding(const std::vector<FootTrack>& legs, double frame_time, bool along_ground);

}  // namespace limber
