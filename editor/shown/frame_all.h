// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace limber::editor {

struct Context;

// Moves the cameras of all views so that each shows all visible tissue.
//   animated  true: the 3D camera moves smoothly; false: it jumps, and the crosshair moves to the body's middle
void frame_all(Context& context, bool animated);

}  // namespace limber::editor
