// SPDX-License-Identifier: AGPL-3.0-or-later
// Models the anatomical surface along which two bones meet in a joint: a knuckle is a ball in a shallow cup, the finger
// joints beyond it are rollers about an axis across the finger, the wrist is an egg in a hollow. Where a scan shows two
// bones as one, a cut along that surface leaves each bone its own end.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "core/rig/joint_names.h"

namespace limber {

// A paraboloid through the joint. Lengths and curvatures are in radii of the bones at the joint.
struct JointShape {
  // Distance of the surface's middle from the joint, towards the child bone.
  double level = 0;
  // Curvatures along the hinge (the widest direction of the joint) and at right angles to it. They are negative where
  // the parent's end is round.
  double along_hinge = 0, across_hinge = 0;
  // Orientation of the surface. 0: on the plane that halves the angle between the bones; 1: at right angles to the
  // child bone; negative: turned away from the child.
  double turn = 0;
  // Factor for distances from the surface where the bones are fused. Above 1, the cut follows the surface more closely.
  double sharp = 1;
};

// Returns the shape of the joint at the head of a bone with this role; none where the shape is not known.
std::optional<JointShape> shape_of_joint(const std::optional<JointRole>& role);

struct JointSurface {
  // Position of the joint (world, mm), and unit vector from the parent towards the child.
  glm::dvec3 joint, axis;
  glm::dvec3 hinge;  // unit vector at right angles to the axis
  double radius;     // radius of the bones at the joint, mm
  JointShape shape;
  // Returns the distance of a point from the surface along the axis, mm; positive beyond it, towards the child.
  double height_of(const glm::dvec3& at) const;
};

JointSurface flat_surface(const glm::dvec3& joint, const glm::dvec3& axis);

// Measures the radius and the hinge direction of the bones at a joint.
//   bone      positions of the voxels of both bones; world, mm
//   volume    volume of a voxel, mm^3
//   half      only voxels in a slice through the joint, perpendicular to the axis, are used; half its thickness, mm
//   reach     voxels further than this from the joint are ignored, mm
//   smallest  smallest radius that is returned, mm
JointSurface surface_of_joint(const JointShape& shape, const glm::dvec3& joint, const glm::dvec3& axis,
                              const std::vector<glm::dvec3>& bone, double volume, double half, double reach,
                              double smallest);

}  // namespace limber
