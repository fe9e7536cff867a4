// SPDX-License-Identifier: AGPL-3.0-or-later
// What the pointer does in the graph editor: it selects and drags keys and handles, draws selection rectangles, pans
// and zooms. While keys are dragged, the views show the pose that they give at the shown frame.
#pragma once

#include "editor/motion/graph.h"

namespace limber::editor {

struct GraphHandle {
  GraphKey key;
  KeySide side = KeySide::Out;
  glm::vec2 key_point{0}, point{0};  // pixels: the key, and the end of the handle
};
glm::vec2 graph_point(const Editor& editor, const GraphKey& key);
// Returns the handles of the selected keys in sight, without those that are too short to be drawn.
std::vector<GraphHandle> graph_handles(const Editor& editor);

// Handles a press of the left button in the graph. On a handle, drags it. On a key, selects it (Shift: adds it to the
// selection or removes it) and drags the selected keys. Elsewhere, begins a rectangle that selects the keys inside.
void press_graph(Editor& editor);
// Begins a modal tool that moves the selected keys or copies of them, or scales the keys about the play head and the
// middle of their values, by the pointer or a typed number.
enum class GraphChange { Move, Scale, Duplicate };
void begin_changing_graph_keys(Editor& editor, GraphChange change);
void pan_graph(Editor& editor);
// Zooms about the pointer by the motion of the mouse wheel.
enum class ZoomAxes { Both, Time, Value };
void zoom_graph(Editor& editor, ZoomAxes axes);

}  // namespace limber::editor
