// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/deform/skinning.h"
#include "editor/context/editor.h"

namespace limber::editor {

// Returns how the preview of the pose blends bone transforms: in the same way as the selected resampling method.
Blend preview_blend(const Editor& editor);

}  // namespace limber::editor
