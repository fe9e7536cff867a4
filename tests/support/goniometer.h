// SPDX-License-Identifier: AGPL-3.0-or-later
// An independent goniometer: measures the angles of joints from the voxels of bones in a posed label volume. It shares
// no code with the program's clinical angles. Each bone's voxels at rest are registered to the posed voxels of the same
// labels by iterated closest points [Besl & McKay 1992], and the bone's landmarks (joint centres at rest) turn with it.
// Angles follow from the directions between landmarks by the definitions of Grood & Suntay [1983], written down here a
// second time. As in a clinic, rotation about a limb is seen by the limb below, bent at knee or elbow, since a round
// bone does not show how it is turned about its own length.
//
// Bodies stand along LPS: x to the left, y to the back, z up. Lengths are in mm, angles in degrees.
#pragma once

#include <set>
#include <vector>

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"

namespace limber::test {

// Returns the centres, mm, of those voxels of some labels that have a face neighbour of another label.
std::vector<glm::dvec3> surface_of_labels(const LabelVolume& volume, const std::set<Label>& labels);

struct Registration {
  glm::dmat3 rotation{1};
  glm::dvec3 shift{0};     // posed = rotation * rest + shift
  double residual_mm = 0;  // root mean square distance of the points that were not left out
};

// Registers points of a bone at rest to the surface of the labels that contain the bone in the posed volume. Each
// iteration ignores the fifth of the points that lie furthest off, because other bones hide them at the joints.
//   start    initial rotation and shift of the search
//   spacing  size of a voxel, mm
Registration register_points(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed,
                             const Registration& start, double spacing);

struct LimbAngles {
  double flexion = 0, abduction = 0;  // angles of the upper limb, degrees; both are 0 if it hangs straight down
  double rotation = 0;                // internal rotation, degrees; only meaningful if the lower limb is bent
  double bend = 0;                    // angle between upper and lower limb, degrees; 0: straight
};

// Measures an arm or a leg from the directions of its upper and lower part.
//   out    +1 for left, -1 for right limbs
//   bends  +1 for knees, which bend backwards, -1 for elbows
//   raised true: the upper limb moved sideways by more than 90 degrees
LimbAngles limb_angles(const glm::dvec3& upper, const glm::dvec3& lower, double out, double bends, bool raised = false);

// Measures pronation: the angle about the forearm by which the line from the index to the little finger's knuckle is
// turned from the axis of the bent elbow. 0: palm up with the elbow bent, forward in a hanging arm.
double pronation_angle(const glm::dvec3& upper, const glm::dvec3& forearm, const glm::dvec3& index_to_little,
                       double out);

double degrees_between_vectors(const glm::dvec3& a, const glm::dvec3& b);

// Returns the rotation's angle times its axis, degrees.
glm::dvec3 rotation_vector_of(const glm::dmat3& rotation);

}  // namespace limber::test
