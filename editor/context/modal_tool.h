// SPDX-License-Identifier: AGPL-3.0-or-later
// A tool that takes all input until it is confirmed or dropped, as walking does. Each of its functions returns whether
// it goes on.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "editor/input/events.h"

namespace limber::editor {

struct Editor;
struct ViewPlace;

// Of the status bar.
struct KeyHint {
  std::vector<std::string> caps;
  std::string words;
};

class Modal {
 public:
  virtual ~Modal() = default;
  virtual bool moved(Editor&, const glm::vec2& /*pixels*/) { return true; }
  virtual bool wheel(Editor&, float /*steps*/) { return true; }
  virtual bool button(Editor&, const ButtonChanged&) { return true; }
  virtual bool key(Editor&, const KeyChanged&) { return true; }
  // Once a frame, after the input.
  virtual bool frame(Editor&, double /*seconds*/) { return true; }
  // Over a view, after its picture.
  virtual void draw(Editor&, const ViewPlace&) {}
  virtual bool moving() const { return false; }  // draws on without input
  virtual void cancel(Editor&) {}                // what it did is undone
  virtual std::vector<KeyHint> hints(const Editor&) const { return {}; }
  virtual bool hides_pointer() const { return false; }
  virtual std::string title() const { return {}; }  // under the view's name; "" for none
};

}  // namespace limber::editor
