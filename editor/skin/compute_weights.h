// SPDX-License-Identifier: AGPL-3.0-or-later
// Computing how tissue follows the bones, as a job and one edit: all of it, or some bones or places anew while the rest
// stays as it was painted.
#pragma once

#include "core/binding/heat_diffusion.h"
#include "editor/context/editor.h"

namespace limber::editor {

enum class BindingMethod { Heat, Geodesic, Rigid };

struct Computation {
  enum class Bones { All, Chosen, Unlocked };
  enum class Where { Everywhere, ChosenTissue, ChosenBones };  // the last: where these have most of the weight

  BindingMethod method = BindingMethod::Heat;
  Bones bones = Bones::All;
  Where where = Where::Everywhere;
  BlendStiffness stiffness;  // not of rigid weights

  // Where it is not, layers stay above what is computed; where it is, that goes to the active layer.
  bool in_part() const { return bones != Bones::All || where != Where::Everywhere; }
};

// Needs a volume, tissues and an armature; weights of that rig where it is in part.
void start_binding(Editor& editor, const Computation& computation);
// Asks for all of it in a dialog.
void ask_computation(Editor& editor);

}  // namespace limber::editor
