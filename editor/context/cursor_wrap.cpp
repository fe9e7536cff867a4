// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/cursor_wrap.h"

namespace limber::editor {

glm::vec2 PointerWrap::moved(const glm::vec2& from, const glm::vec2& to) {
  if (awaited_ == glm::vec2(0) || glm::distance(to, from) <= glm::distance(to, from + awaited_)) return to - from;
  const glm::vec2 by = to - from - awaited_;
  awaited_ = {};
  return by;
}

glm::vec2 PointerWrap::leap(const glm::vec2& pointer) {
  if (!inside_ || awaited_ != glm::vec2(0)) return {};
  const Rect inside = inside_->grown(-margin_);
  for (int axis = 0; axis < 2; ++axis) {
    // Moves the pointer by 2 pixels less than the rectangle's size, so that it ends just inside the opposite edge.
    // Otherwise it would be moved back at once.
    const float way = inside.size()[axis] - 2;
    if (way < 16 * margin_) continue;
    if (pointer[axis] < inside.low[axis]) awaited_[axis] = way;
    if (pointer[axis] > inside.high[axis]) awaited_[axis] = -way;
  }
  return awaited_;
}

}  // namespace limber::editor
