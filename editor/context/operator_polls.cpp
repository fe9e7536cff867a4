// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_polls.h"

#include <iterator>

#include "core/project/document.h"
#include "editor/context/context.h"
#include "editor/context/selection.h"

namespace limber::editor {

std::string needs_volume(const Context& context) { return context.document().volume ? "" : "Open a volume first"; }

std::string needs_tissue(const Context& context) {
  if (!context.document().volume) return "Open a volume first";
  return context.selection->tissue ? "" : "Select a tissue first";
}

std::string needs_bone(const Context& context) {
  if (!context.document().armature) return "Import a rig first";
  return context.selection->bone && *context.selection->bone < std::ssize(context.document().armature->bones)
             ? ""
             : "Select a bone first";
}

}  // namespace limber::editor
