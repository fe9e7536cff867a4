// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes skin weights in a job and commits them as one edit: all weights, or only those of some bones or tissues
// while the rest stays as painted.
#pragma once

#include "core/binding/heat_diffusion.h"
#include "editor/context/editor.h"

namespace limber::editor {

enum class BindingMethod { Heat, Geodesic, Rigid };

struct Computation {
  enum class Bones { All, Chosen, Unlocked };
  // The voxels whose weights are computed. ChosenBones: those where a selected bone has the largest weight.
  enum class Where { Everywhere, ChosenTissue, ChosenBones };

  BindingMethod method = BindingMethod::Heat;
  Bones bones = Bones::All;
  Where where = Where::Everywhere;
  BlendStiffness stiffness;  // factors per tissue; rigid weights do not use them

  // Whether only some weights are computed. A full computation replaces the base weights below all layers; a partial
  // one edits the active layer.
  bool in_part() const { return bones != Bones::All || where != Where::Everywhere; }
};

// Starts the computation in a job. Needs a volume, tissues and an armature. A partial computation also needs weights
// that belong to this armature.
void start_binding(Editor& editor, const Computation& computation);
// Opens a dialog that asks for the computation's settings and starts it.
void ask_computation(Editor& editor);

}  // namespace limber::editor
