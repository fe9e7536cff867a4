// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/deform/skinning.h"
#include "editor/context/editor.h"

namespace limber::editor {

// By what the pose is previewed: as it would be resampled.
Blend preview_blend(const Editor& editor);

}  // namespace limber::editor
