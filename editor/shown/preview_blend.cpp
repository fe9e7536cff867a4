// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/preview_blend.h"

#include "core/resample/deformation_method.h"
#include "editor/context/resampling_settings.h"

namespace limber::editor {

// If the selected method does not blend bone transforms (finite elements), returns the blend of the first method that
// the program lists.
Blend preview_blend(const ResamplingSettings& resampling) {
  return find_method(resampling.method)->blend.value_or(*deformation_methods().front().blend);
}

}  // namespace limber::editor
