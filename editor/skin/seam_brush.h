// SPDX-License-Identifier: AGPL-3.0-or-later
// Strokes of the brush that change seams in place of weights.
#pragma once

#include "editor/seams/seam_view.h"

namespace limber::editor {

std::string why_not_cut(const Editor& editor);  // why the brush cannot be used; "" when it can
// Until the button is let go.
void begin_seam_stroke(Editor& editor, SeamStroke stroke);

}  // namespace limber::editor
