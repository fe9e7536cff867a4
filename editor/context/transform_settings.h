// SPDX-License-Identifier: AGPL-3.0-or-later
// How bones are taken hold of: the axes that gizmos and locks go by, what a transform snaps to.
// Not a part of the document: changing it is no edit.
#pragma once

#include <memory>
#include <string>

#include <glm/glm.hpp>

#include "core/pose/pose_library.h"
#include "core/rig/pose.h"

namespace limber::editor {

enum class Space { Global, Local, Parent, View };
const char* name_of(Space space);  // "Global"

enum class Snap { Steps, Voxel, Joint, BoneMiddle };

struct KnownRigCheck;
struct ProposedJoint;
struct ViewProjection;

struct TransformSettings {
  enum class Part { Whole, Head, Tail };

  Space space = Space::Global;
  bool auto_ik = true;      // a dragged joint takes its limb along
  bool x_mirror = false;    // the other side does the same, mirrored
  Part part = Part::Whole;  // of the active bone, in the rig
  Snap snap = Snap::Steps;
  bool snapping = false;  // always; Ctrl then leaves it
  struct {                // a pole that is dragged, in place of the document's
    std::string bone;     // "" for none
    glm::dvec3 place{0};
  } shown_pole;

  std::shared_ptr<ProposedJoint> proposed_joint;  // of joint_axis_fit.h; null: nothing is proposed
  std::shared_ptr<KnownRigCheck> rig_check;       // of rig_check.h; null: not checked yet
  bool rig_check_marks = true;                    // over the views

  struct {             // the bone of the outliner whose row is pressed
    std::string bone;  // "" for none
    glm::vec2 begin{0};
    bool moved = false;
  } row_drag;

  std::string library_pose;  // the chosen pose of the library; a body's own by library_name() of body_pose_cards.h
  struct {                   // the poses that any body can take, on the rig
    std::shared_ptr<const Armature> armature;
    PoseLibrary poses;  // with pictures once they were shown
  } body_poses;
  struct {  // the one whose card is pressed, and where that began
    std::string pose;
    float begin = 0;
    bool moved = false;
  } library_drag;
};

// Columns x, y, z of a space for a bone of a posed rig. A root's parent is the world.
glm::dmat3 axes_of(Space space, const Armature& armature, const Pose& pose, int bone, const ViewProjection& view);

// Where the bone's own axes point in that pose: columns x, y (along the bone), z.
glm::dmat3 posed_axes(const Armature& armature, const Pose& pose, int bone);

}  // namespace limber::editor
