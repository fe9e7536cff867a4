// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace limber::editor {

// The tools of the tool strip. The selected tool decides what the left mouse button does in a view.
enum class Tool { Select, CrossHair, Move, Rotate, Scale, Reach, Extrude };

}  // namespace limber::editor
