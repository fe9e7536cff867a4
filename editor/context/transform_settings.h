// SPDX-License-Identifier: AGPL-3.0-or-later
// Settings of the tools that transform bones, such as the axes that gizmos and axis locks use and what a transform
// snaps to. The settings are not part of the document, so changing them is no edit.
#pragma once

#include <memory>
#include <string>

#include <glm/glm.hpp>

#include "core/pose/pose_library.h"
#include "core/rig/pose.h"

namespace limber::editor {

enum class Space { Global, Local, Parent, View };
const char* name_of(Space space);  // returns the name shown to the user, such as "Global"

enum class Snap { Steps, Voxel, Joint, BoneMiddle };

struct KnownBodyFrames;
struct KnownRigCheck;
struct ProposedJoint;
struct ViewProjection;

struct TransformSettings {
  enum class Part { Whole, Head, Tail };

  Space space = Space::Global;
  bool auto_ik = true;      // true: dragging a joint moves its limb by inverse kinematics
  bool x_mirror = false;    // true: the bone on the body's other side makes the mirrored motion
  Part part = Part::Whole;  // part of the active bone that is selected in the Rig workspace
  Snap snap = Snap::Steps;
  bool snapping = false;  // true: snaps unless Ctrl is held; false: snaps while Ctrl is held
  struct {                // the pole target (it directs the knee or elbow) that is being dragged
    std::string bone;     // name of the limb's last bone; "" if no pole target is dragged
    glm::dvec3 place{0};
  } shown_pole;

  // Joint axis that the user may accept (joint_axis_fit.h); null: no axis is proposed.
  std::shared_ptr<ProposedJoint> proposed_joint;
  // Result of the last rig check (rig_check.h); null: not checked yet.
  mutable std::shared_ptr<KnownRigCheck> rig_check;
  // Coordinate frames of the rig's joints (clinical_angle_edits.h); null: not found yet.
  mutable std::shared_ptr<const KnownBodyFrames> body_frames;
  bool rig_check_marks = true;  // true: the views mark the problems that rig_check found

  struct {             // the bone whose row in the outliner is being dragged
    std::string bone;  // name of the bone; "" if no row is dragged
    glm::vec2 begin{0};
    bool moved = false;
  } row_drag;

  // Name of the selected pose of the library. For a built-in body pose, this is its library_name() (body_pose_cards.h).
  std::string library_pose;
  mutable struct {  // the program's own body poses, made for the current rig
    std::shared_ptr<const Armature> armature;
    PoseLibrary poses;  // the poses' pictures are drawn when they are first shown
  } body_poses;
  struct {  // the pose whose card is being dragged, and the pointer's x when the drag began
    std::string pose;
    float begin = 0;
    bool moved = false;
  } library_drag;
};

// Returns the x, y and z axes of a coordinate space, as the columns of a matrix, for a bone of a posed rig. For a root
// bone, the space Parent is the world.
glm::dmat3 axes_of(Space space, const Armature& armature, const Pose& pose, int bone, const ViewProjection& view);

// Returns the bone's own axes in the pose, in world coordinates, as columns x, y (along the bone), z.
glm::dmat3 posed_axes(const Armature& armature, const Pose& pose, int bone);

}  // namespace limber::editor
