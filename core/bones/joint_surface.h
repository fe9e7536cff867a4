// SPDX-License-Identifier: AGPL-3.0-or-later
// Models the anatomical surface along which two bones meet in a joint. A knuckle is a ball in a shallow cup, the finger
// joints beyond it are rollers about an axis across the finger, and the wrist is an egg in a hollow. If a scan shows
// two bones as one, a cut along this surface leaves each bone its own end.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "core/rig/joint_names.h"

namespace limber {

// The surface between two bones as a paraboloid through the joint. Lengths and curvatures are in units of the radius of
// the bones at the joint.
struct JointShape {
  // Distance of the surface's middle from the rig's joint, positive towards the child bone.
  double level = 0;
  // Curvatures along the hinge (the widest direction of the joint) and perpendicular to it. They are negative if the
  // end of the parent bone is round.
  double along_hinge = 0, across_hinge = 0;
  // Orientation of the surface. 0: in the plane that bisects the angle between the bones; 1: perpendicular to the child
  // bone; negative: tilted the other way.
  double turn = 0;
  // Factor on distances from the surface if the bones are fused. Above 1, the cut follows the surface more closely.
  double sharp = 1;
};

// Returns the shape of the joint at the head of a bone with this role in the body; none if no shape is known.
std::optional<JointShape> shape_of_joint(const std::optional<JointRole>& role);

struct JointSurface {
  // Position of the joint (world, mm), and the unit vector of the joint's axis, from the parent bone towards the child.
  glm::dvec3 joint, axis;
  glm::dvec3 hinge;  // unit vector along the hinge, perpendicular to the axis
  double radius;     // radius of the bones at the joint, mm
  JointShape shape;
  // Returns the distance of a point from the surface along the joint's axis, mm; positive on the child's side.
  double height_of(const glm::dvec3& at) const;
};

JointSurface flat_surface(const glm::dvec3& joint, const glm::dvec3& axis);

// Measures the radius and the hinge direction of the bones at a joint.
//   bone      positions of the voxels of both bones; world, mm
//   volume    volume of a voxel, mm^3
//   half      half the thickness of the slice through the joint, perpendicular to the axis, whose voxels are used, mm
//   reach     voxels farther than this from the joint are ignored, mm
//   smallest  smallest radius that is returned, mm
JointSurface surface_of_joint(const JointShape& shape, const glm::dvec3& joint, const glm::dvec3& axis,
                              const std::vector<glm::dvec3>& bone, double volume, double half, double reach,
                              double smallest);

}  // namespace limber
