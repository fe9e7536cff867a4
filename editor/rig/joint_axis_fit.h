// SPDX-License-Identifier: AGPL-3.0-or-later
// A proposed joint axis (core/autorig/joint_axis_fit.h) that the user accepts or rejects. The views draw soft tissue
// transparent and mark the bone voxels that collide when the joint turns about the old or the proposed axis. A card
// over the view shows the overlap in voxels and how far the axis moves.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "core/autorig/joint_axis_fit.h"

namespace limber::editor {

struct Context;
struct Rect;

struct ProposedJoint {
  // The volume in which the axis was fitted. The proposal ends when the volume changes.
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const Armature> from, fitted;
  std::string bone;
  FittedJoint fit;
  std::shared_ptr<const TissueVoxels> tissue;
  // The colours of the tissue voxels, sRGB, with colliding bone voxels marked: before the fit, and after it.
  std::array<std::shared_ptr<const std::vector<glm::u8vec3>>, 2> colours;
  bool shows_after = false;
};

// Starts a job that fits the axis of the active bone's hinge. The result is a proposal that the user accepts or
// rejects.
void start_joint_fit(Context& context);
// Returns the proposed joint axis; null when there is none, when the volume or the rig has changed since the fit, and
// outside the Rig workspace.
const ProposedJoint* proposed_joint(const Context& context);
// Shows the proposed axis and the collisions in the scene of this frame.
void show_proposed_joint(Context& context);
void take_proposed_joint(Context& context);  // commits the proposed axis as one edit
void leave_proposed_joint(Context& context);
// Draws the card with the proposal's numbers and buttons over a view.
void draw_proposed_joint(Context& context, const Rect& view);

}  // namespace limber::editor
