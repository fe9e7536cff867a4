// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/skin/compute_weights.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_rig(const Context& context) {
  if (!context.document().volume || !context.document().tissues) return "Open a volume first";
  return context.document().armature ? "" : "Import a rig first";
}

Operator binding_operator(const char* id, const char* label, const char* description, BindingMethod method) {
  return {id,        label,       icon::kSkin,
          "Weights", description, [method](Context& c) { start_binding(c, {.method = method}); },
          needs_rig};
}

void drop_weights(Context& context) {
  Document next = context.document();
  next.weights.reset();
  next.layers.reset();
  context.history->commit("Remove weights", std::move(next));
}

}  // namespace

std::vector<Operator> skin_operators() {
  return {
      binding_operator("skin.heat", "Heat diffusion",
                       "Compute weights as heat that flows from the bones through the tissue.", BindingMethod::Heat),
      binding_operator("skin.geodesic", "Geodesic",
                       "Compute weights from the shortest paths between bones and voxels inside the tissue.",
                       BindingMethod::Geodesic),
      binding_operator("skin.rigid", "Rigid", "Let every voxel follow only its nearest bone.", BindingMethod::Rigid),
      {"skin.compute", "Compute weights...", icon::kSkin, "Weights",
       "Compute weights with a method you select, for all or some bones and tissues, with a stiffness for each kind of "
       "tissue.",
       ask_computation, needs_rig},
      {"skin.drop_weights", "Remove weights", icon::kTrash, "Weights",
       "Remove all weights and layers from the project.", drop_weights,
       [](const Context& c) { return c.document().weights ? std::string() : std::string("There are no weights"); }},
  };
}

}  // namespace limber::editor
