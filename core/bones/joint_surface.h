// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface along which two bones meet in a joint, as anatomy knows it: a knuckle is a ball in a shallow cup, the
// joints of a finger beyond it are rollers about an axis across the finger, the wrist is an egg in a hollow. Where a
// scan shows two bones as one, a cut along that surface leaves each bone its own end.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "core/rig/joint_names.h"

namespace limber {

// A paraboloid through the joint. Lengths and curvatures are in radii of the bones at the joint.
struct JointShape {
  // How far beyond the joint, towards the child, the middle of the surface lies.
  double level = 0;
  // Curvature along the widest direction across the joint, and across that; negative where the parent's end is round.
  double along_hinge = 0, across_hinge = 0;
  // How far the surface turns from halving the angle between the bones (0) to stand across the child (1), or where
  // negative the other way.
  double turn = 0;
  // Where the bones are closed up, what lies off the surface counts as if it were so many times as far off.
  double sharp = 1;
};

// The shape of the joint at the head of a bone with this role; none where it is not known.
std::optional<JointShape> shape_of_joint(const std::optional<JointRole>& role);

struct JointSurface {
  glm::dvec3 joint, axis;  // world, mm; unit, from the parent towards the child
  glm::dvec3 hinge;        // unit, across the axis
  double radius;           // mm, of the bones at the joint
  JointShape shape;
  // mm that a place lies beyond the surface, along the axis.
  double height_of(const glm::dvec3& at) const;
};

JointSurface flat_surface(const glm::dvec3& joint, const glm::dvec3& axis);

// Measures the bones at the joint.
//   bone      world, mm: the places of voxels of either bone
//   volume    mm^3 that each stands for
//   half      mm: half the thickness of the slice across the axis in which they count
//   reach     mm: farther from the joint they do not count
//   smallest  mm: the radius is at least that
JointSurface surface_of_joint(const JointShape& shape, const glm::dvec3& joint, const glm::dvec3& axis,
                              const std::vector<glm::dvec3>& bone, double volume, double half, double reach,
                              double smallest);

}  // namespace limber
