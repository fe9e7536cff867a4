// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/deform/skinning.h"

namespace limber::editor {

struct ResamplingSettings;

// Returns how the preview of the pose blends the transforms of bones. The preview uses the same blend as the selected
// resampling method, so that it predicts the method's result.
Blend preview_blend(const ResamplingSettings& resampling);

}  // namespace limber::editor
