// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/preview_blend.h"

namespace limber::editor {

// Where the method is none of blending, as the default blends.
Blend preview_blend(const Editor& editor) {
  return editor.resampling.method == "fem" ? Blend::Mixed : blend_named(editor.resampling.method);
}

}  // namespace limber::editor
