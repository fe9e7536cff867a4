// SPDX-License-Identifier: AGPL-3.0-or-later
// Why an operator cannot run, for many of them.
#pragma once

#include <string>

#include "editor/editor.h"

namespace limber::editor {

inline std::string needs_volume(const Editor& editor) { return editor.document().volume ? "" : "Open a volume first"; }
inline std::string needs_tissue(const Editor& editor) {
  if (!editor.document().volume) return "Open a volume first";
  return editor.selection.tissue ? "" : "Choose a tissue first";
}

}  // namespace limber::editor
