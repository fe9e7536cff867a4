// SPDX-License-Identifier: AGPL-3.0-or-later
// A joint's axis as it would be moved (core/autorig/joint_axis_fit.h), before the user takes it or leaves it: the views
// show through the flesh which bone enters which when the joint turns, about the old axis or about the new one, and a
// card has the figures.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "core/autorig/joint_axis_fit.h"
#include "editor/context/editor.h"

namespace limber::editor {

struct ProposedJoint {
  std::shared_ptr<const LabelVolume> volume;  // of the document that it is for; another one ends it
  std::shared_ptr<const Armature> from, fitted;
  std::string bone;
  FittedJoint fit;
  std::shared_ptr<const TissueVoxels> tissue;
  std::array<std::shared_ptr<const std::vector<glm::u8vec3>>, 2>
      colours;  // #tissue, of the tissues and what collides: before, after
  bool shows_after = false;
};

// Fits the axis of the active bone's hinge, as a job that ends in a proposal.
void start_joint_fit(Editor& editor);
// Null: nothing is proposed, or not here.
const ProposedJoint* proposed_joint(const Editor& editor);
// Into the scene of this frame.
void show_proposed_joint(Editor& editor);
void take_proposed_joint(Editor& editor);  // one edit
void leave_proposed_joint(Editor& editor);
// The card, over a view.
void draw_proposed_joint(Editor& editor, const Rect& view);

}  // namespace limber::editor
