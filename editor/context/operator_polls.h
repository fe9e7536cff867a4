// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks that many operators share. Each function returns the reason why an operator cannot run now, or "" if it can.
#pragma once

#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

inline std::string needs_volume(const Editor& editor) { return editor.document().volume ? "" : "Open a volume first"; }
inline std::string needs_tissue(const Editor& editor) {
  if (!editor.document().volume) return "Open a volume first";
  return editor.selection.tissue ? "" : "Select a tissue first";
}

inline std::string needs_bone(const Editor& editor) {
  if (!editor.document().armature) return "Import a rig first";
  return editor.selection.bone && *editor.selection.bone < std::ssize(editor.document().armature->bones)
             ? ""
             : "Select a bone first";
}

}  // namespace limber::editor
