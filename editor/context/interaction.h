// SPDX-License-Identifier: AGPL-3.0-or-later
// What the user is doing with the pointer: the selected tool, a press that may still become a drag, a drag, or a modal
// tool.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "editor/context/cursor_wrap.h"
#include "editor/context/tool.h"
#include "editor/input/events.h"
#include "editor/input/keys.h"

namespace limber::editor {

class Modal;
struct Context;

// A drag with a mouse button. `moved` is called for every move of the pointer until the button is released (then
// `ended` is called) or Escape cancels the drag (then `cancelled` is called).
struct Drag {
  MouseButton button = MouseButton::Left;
  std::function<void(Context&, const glm::vec2& pixels)> moved;  // `pixels`: pointer motion since the last call
  std::function<void(Context&)> ended, cancelled;
  PointerWrap wrap = {};  // moves the pointer back into the view in which the drag began
};

// A press of a mouse button that may still become a click or a drag.
struct PendingPress {
  Chord press, drag;
  glm::vec2 from;
  double since;
};

struct Interaction {
  Tool tool = Tool::Select;
  std::optional<PendingPress> pending_press;
  std::optional<Drag> drag;
  std::shared_ptr<Modal> modal;  // the modal tool that gets all input; null: no modal tool is active
  PointerWrap modal_wrap;
  float wheel_rest = 0;  // fraction of a wheel step that has not moved a slice yet; touch pads send fractions
};

}  // namespace limber::editor
