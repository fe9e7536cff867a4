// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds joints by shape alone, whatever the proportions of the body that was fitted:
//   girth  A limb's cross-section is smallest slightly above the elbow, at the knee and slightly above the wrist. The
//          neck begins where its section is twice its smallest section. The joint is at a distance from this section of
//          the limb or neck that is a fixed share of the bone's length, as measured on segmented adults.
//   balls  The heads of humerus and femur are spheres whose centres are the joints: every point of the bone surface
//          votes for the centres that are behind it along its normal [Ballard 1981, generalized Hough transform;
//          Cameron et al. 1997 on the hip as the centre of its head].
#pragma once

#include <optional>
#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/mesh/surface_points.h"

namespace limber {

struct JointLandmark {
  int bone = 0;         // index of the mannequin's bone whose head the landmark locates
  glm::dvec3 place{0};  // position of the landmark, world, mm
  double bend = 0;      // bend of the limb at the joint, radians
};

// Returns the landmarks of elbows, knees, wrists and neck that can be found. For a left and a right joint, the mean of
// their two distances along the limb is used, unless the distances differ much.
std::vector<JointLandmark> girth_landmarks(const Mannequin& mannequin, const Occupancy& body);

// Returns the landmarks of shoulders and hips that can be found.
//   bone  the surface of bone tissue
std::vector<JointLandmark> ball_landmarks(const Mannequin& mannequin, const FitSurface& bone);

// Returns the centre of the sphere near `start` on which most surface points are. The sphere's radius is that of an
// adult's humerus or femur head times `scale`, and its centre is within 35 mm times `scale` of `start`.
std::optional<glm::dvec3> ball_near(const std::vector<SurfacePoint>& points, const glm::dvec3& start, double scale);

}  // namespace limber
