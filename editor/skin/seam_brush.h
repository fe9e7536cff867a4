// SPDX-License-Identifier: AGPL-3.0-or-later
// Strokes of the seam brush, which cuts or erases seams instead of painting weights. A seam is a sheet of voxel faces
// at which two body parts touch at rest without being joined.
#pragma once

#include "editor/seams/seam_view.h"

namespace limber::editor {

struct Context;

std::string why_not_cut(const Context& context);  // returns why the seam brush cannot be used; "" when it can
// Begins a stroke of the seam brush at the pointer. The stroke ends when the button is released.
void begin_seam_stroke(Context& context, SeamStroke stroke);

}  // namespace limber::editor
