// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes skin weights in a job and commits them as one edit. The job computes all weights, or only the weights of
// some bones or tissues; the other weights then stay unchanged.
#pragma once

#include "core/binding/heat_diffusion.h"

namespace limber::editor {

struct Context;

enum class BindingMethod { Heat, Geodesic, Rigid };

struct Computation {
  enum class Bones { All, Chosen, Unlocked };
  // The voxels whose weights are computed. ChosenTissue: the voxels of the selected tissues. ChosenBones: the voxels
  // in which a selected bone has the largest weight.
  enum class Where { Everywhere, ChosenTissue, ChosenBones };

  BindingMethod method = BindingMethod::Heat;
  Bones bones = Bones::All;
  Where where = Where::Everywhere;
  BlendStiffness stiffness;  // stiffness of each tissue where bones blend; unused by rigid weights

  // Returns true if only some of the weights are computed. Such a partial computation edits the active weight layer. A
  // full computation replaces the base weights, which lie below all layers.
  bool in_part() const { return bones != Bones::All || where != Where::Everywhere; }
};

// Starts the computation in a job. Needs a volume, tissues and an armature. A partial computation also needs weights
// that belong to this armature.
void start_binding(Context& context, const Computation& computation);
// Opens a dialog that asks for the computation's settings and starts it.
void ask_computation(Context& context);

}  // namespace limber::editor
