// SPDX-License-Identifier: AGPL-3.0-or-later
// Chooses from which side a picture shows a bent joint.
#pragma once

#include <glm/glm.hpp>

#include "core/study/cell_result.h"
#include "core/study/picture.h"

namespace limber {

// Returns a frame in the plane in which the joint turns, through the joint's head. If possible, the head end of the
// body is up in the picture. The viewer looks along the axis of the rotation.
PictureFrame joint_plane(const JointFigures& joint);

// Returns the unit vector, perpendicular to the joint's axis, from the joint to the side on which flesh folds: the
// inside of the elbow, the back of the knee. For a joint that is straight in the pose, this is the side towards which
// it turned.
glm::dvec3 folding_side(const JointFigures& joint);

// Returns the frame of a 3D picture of a bent joint. The viewer looks along the joint's axis, turned by 35 degrees
// towards the folding side, so that the fold is visible. Of the two ends of the axis, the viewer is at the outer one,
// so that the body does not hide a limb.
//   body_centre  middle of the body's tissue, world space, mm
PictureFrame folding_view(const JointFigures& joint, const glm::dvec3& body_centre);

}  // namespace limber
