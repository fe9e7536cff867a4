// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps a long drag from ending at the edge of a view: when the pointer leaves a rectangle, it is moved ("leaps") to
// the rectangle's opposite side. The leap does not count as a move of the user's hand. The leap is recognized by the
// pointer's position, because events of moves before the leap may arrive after the request for it. If the desktop
// refuses to move the pointer, the drag goes on without leaps.
#pragma once

#include <optional>

#include "editor/ui/rect.h"

namespace limber::editor {

class PointerWrap {
 public:
  // Creates a wrap that moves the pointer away from an edge of `inside` when it comes nearer than `margin` pixels to
  // that edge. A wrap without a rectangle never moves the pointer.
  PointerWrap() = default;
  PointerWrap(const Rect& inside, float margin) : inside_(inside), margin_(margin) {}

  // Returns how far the user's hand moved, pixels: `to` - `from`, minus the leap if one happened between the two
  // positions.
  glm::vec2 moved(const glm::vec2& from, const glm::vec2& to);
  // Returns the distance by which the caller must move the pointer now, pixels. It is zero unless the pointer has
  // reached an edge.
  glm::vec2 leap(const glm::vec2& pointer);

 private:
  std::optional<Rect> inside_;
  float margin_ = 0;
  // A leap that was requested and that the pointer's position does not show yet, pixels; zero: there is no such leap.
  glm::vec2 awaited_{0};
};

}  // namespace limber::editor
