// SPDX-License-Identifier: AGPL-3.0-or-later
// The base class of modal tools, such as walking. A modal tool gets all input until the user confirms or cancels it.
// Each function that handles input returns true while the tool continues.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "editor/input/events.h"

namespace limber::editor {

struct Context;
struct ViewPlace;

// A hint in the status bar: the names of keys, and what these keys do.
struct KeyHint {
  std::vector<std::string> caps;
  std::string words;
};

class Modal {
 public:
  virtual ~Modal() = default;
  virtual bool moved(Context&, const glm::vec2& /*pixels*/) { return true; }
  virtual bool wheel(Context&, float /*steps*/) { return true; }
  virtual bool button(Context&, const ButtonChanged&) { return true; }
  virtual bool key(Context&, const KeyChanged&) { return true; }
  // Called once in every frame, after the functions that handle input.
  virtual bool frame(Context&, double /*seconds*/) { return true; }
  // Draws the tool's graphics over a view. The view's picture has been drawn before.
  virtual void draw(Context&, const ViewPlace&) {}
  virtual bool moving() const { return false; }  // true: frames must be drawn even without input
  virtual void cancel(Context&) {}               // undoes what the tool did
  virtual std::vector<KeyHint> hints(const Context&) const { return {}; }
  virtual bool hides_pointer() const { return false; }
  virtual std::string title() const { return {}; }  // shown under the view's name; "" for none
};

}  // namespace limber::editor
