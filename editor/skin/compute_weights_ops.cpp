// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_polls.h"
#include "editor/skin/compute_weights.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_rig(const Editor& editor) {
  if (!editor.document().volume || !editor.document().tissues) return "Open a volume first";
  return editor.document().armature ? "" : "Import a rig first";
}

Operator binding_operator(const char* id, const char* label, const char* description, BindingMethod method) {
  return {id,        label,       icon::kSkin,
          "Weights", description, [method](Editor& e) { start_binding(e, {.method = method}); },
          needs_rig};
}

void drop_weights(Editor& editor) {
  Document next = editor.document();
  next.weights.reset();
  next.layers.reset();
  editor.history.commit("Drop weights", std::move(next));
}

}  // namespace

std::vector<Operator> skin_operators() {
  return {
      binding_operator("skin.heat", "Heat diffusion",
                       "Computes weights by heat that flows from the bones through the tissue.", BindingMethod::Heat),
      binding_operator("skin.geodesic", "Geodesic", "Computes weights by the shortest ways inside the tissue.",
                       BindingMethod::Geodesic),
      binding_operator("skin.rigid", "Rigid", "Every voxel follows its nearest bone alone.", BindingMethod::Rigid),
      {"skin.compute", "Compute weights...", icon::kSkin, "Weights",
       "Computes weights by a method of choice, also of some bones or tissues alone, with a stiffness for each kind of "
       "tissue.",
       ask_computation, needs_rig},
      {"skin.drop_weights", "Drop weights", icon::kTrash, "Weights", "Takes the weights away.", drop_weights,
       [](const Editor& e) { return e.document().weights ? std::string() : std::string("There are no weights"); }},
  };
}

}  // namespace limber::editor
