// SPDX-License-Identifier: AGPL-3.0-or-later
// The regions of the window: the workspace that is shown, the user's arrangement of each workspace, and the layout that
// follows from it.
#pragma once

#include <cstddef>

#include "editor/context/layout.h"

namespace limber::editor {

struct Screen {
  Arrangement& arrangement() { return arrangements[static_cast<std::size_t>(workspace)]; }
  const Arrangement& arrangement() const { return arrangements[static_cast<std::size_t>(workspace)]; }

  Workspace workspace = Workspace::Rig;
  Arrangements arrangements;
  Layout layout;
  Rect timeline_area;  // area of the timeline's rows in the last frame; empty while the timeline is not shown
  Rect graph_area;     // the part of timeline_area in which the graph editor draws curves; empty: not shown
};

}  // namespace limber::editor
