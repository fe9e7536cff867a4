// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/preview_blend.h"

#include "core/resample/deformation_method.h"

namespace limber::editor {

// Resampling methods that do not blend bone transforms (finite elements) are previewed by the default blend.
Blend preview_blend(const Editor& editor) {
  return find_method(editor.resampling.method)->blend.value_or(*deformation_methods().front().blend);
}

}  // namespace limber::editor
