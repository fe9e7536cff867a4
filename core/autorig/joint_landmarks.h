// SPDX-License-Identifier: AGPL-3.0-or-later
// Joints told by shape alone, whatever the proportions of the body that was laid over them:
//   girth  the limb's cross-section is least a little above the elbow, at the knee and a little above the wrist; the
//   neck
//          begins where the section has grown to twice its least one. What lies between that place and the joint is a
//          share of the bone's length, as measured on segmented adults.
//   balls  the heads of humerus and femur are spheres, and their centres are the joints: every point of bone surface
//   votes
//          for the centres that its normal points away from [Ballard 1981, generalized Hough transform; Cameron et al.
//          1997 on the hip as the centre of its head].
#pragma once

#include <optional>
#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/mesh/surface_points.h"

namespace limber {

struct JointLandmark {
  int bone = 0;  // of the mannequin, whose head it is
  glm::dvec3 place{0};
  double bend = 0;  // radians, of the limb there
};

// Elbows, knees, wrists and the neck, those that can be told; both sides agree on how far along the limb they lie.
std::vector<JointLandmark> girth_landmarks(const Mannequin& mannequin, const Occupancy& body);

// Shoulders and hips.
//   bone  the surface of bone tissue
std::vector<JointLandmark> ball_landmarks(const Mannequin& mannequin, const FitSurface& bone);

// The middle of the ball, of the size of an adult's times `scale`, that most of a surface's points lie around within 35
// mm times `scale` of `start`.
std::optional<glm::dvec3> ball_near(const std::vector<SurfacePoint>& points, const glm::dvec3& start, double scale);

}  // namespace limber
