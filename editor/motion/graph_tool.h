// SPDX-License-Identifier: AGPL-3.0-or-later
// Handles the pointer in the graph editor: select and drag keys and handles, draw selection rectangles, pan and zoom.
// While keys are dragged, the views show the resulting pose at the shown frame.
#pragma once

#include "editor/motion/graph.h"

namespace limber::editor {

struct Context;

struct GraphHandle {
  GraphKey key;
  KeySide side = KeySide::Out;
  glm::vec2 key_point{0}, point{0};  // positions of the key and of the handle's end, pixels
};
glm::vec2 graph_point(const Timeline& timeline, const GraphKey& key);
// Returns the visible handles of the selected keys. Handles that are too short to be drawn are left out.
std::vector<GraphHandle> graph_handles(const Context& context);

// Handles a press of the left button in the graph. On a handle, drags it. On a key, selects it (Shift: adds it to the
// selection or removes it) and drags the selected keys. Elsewhere, begins a rectangle that selects the keys inside.
void press_graph(Context& context);
// Begins a modal tool that changes the selected keys by the pointer or a typed number: moves them, moves copies of
// them, or scales them about the play head and the middle of their values.
enum class GraphChange { Move, Scale, Duplicate };
void begin_changing_graph_keys(Context& context, GraphChange change);
void pan_graph(Context& context);
// Zooms the graph by the rotation of the mouse wheel. The point under the pointer keeps its position.
enum class ZoomAxes { Both, Time, Value };
void zoom_graph(Context& context, ZoomAxes axes);

}  // namespace limber::editor
