// SPDX-License-Identifier: AGPL-3.0-or-later
// A long drag never ends at an edge: the pointer that leaves the rectangle comes in again at the other side. Moves that
// the window reported before it leapt are told from those after it by their place, so none counts as a leap; where the
// desktop moves no pointers the drag goes on without it.
#pragma once

#include <optional>

#include "editor/ui/rect.h"

namespace limber::editor {

class PointerWrap {
 public:
  // `margin`: pixels from the edge at which it leaps
  PointerWrap() = default;
  PointerWrap(const Rect& inside, float margin) : inside_(inside), margin_(margin) {}

  // By how much the hand moved.
  glm::vec2 moved(const glm::vec2& from, const glm::vec2& to);
  // What to move the pointer by now; zero mostly.
  glm::vec2 leap(const glm::vec2& pointer);

 private:
  std::optional<Rect> inside_;
  float margin_ = 0;
  glm::vec2 awaited_{0};  // a leap whose first move has not come yet
};

}  // namespace limber::editor
