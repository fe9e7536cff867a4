// SPDX-License-Identifier: AGPL-3.0-or-later
// A rectangle of the window in pixels, y down. It contains its top left corner `low` and excludes its bottom right
// corner `high`.
#pragma once

#include <algorithm>

#include <glm/glm.hpp>

namespace limber::editor {

struct Rect {
  glm::vec2 low{0}, high{0};

  bool operator==(const Rect&) const = default;

  glm::vec2 size() const { return high - low; }
  float width() const { return high.x - low.x; }
  float height() const { return high.y - low.y; }
  glm::vec2 centre() const { return (low + high) * 0.5f; }
  bool empty() const { return high.x <= low.x || high.y <= low.y; }
  bool contains(const glm::vec2& p) const { return p.x >= low.x && p.y >= low.y && p.x < high.x && p.y < high.y; }
  bool contains(const Rect& r) const {
    return r.low.x >= low.x && r.low.y >= low.y && r.high.x <= high.x && r.high.y <= high.y;
  }
  bool overlaps(const Rect& r) const {
    return r.low.x < high.x && r.low.y < high.y && low.x < r.high.x && low.y < r.high.y;
  }
  Rect grown(float by) const { return {low - by, high + by}; }
};

inline Rect intersection(const Rect& a, const Rect& b) {
  const Rect both{glm::max(a.low, b.low), glm::min(a.high, b.high)};
  return both.empty() ? Rect{both.low, both.low} : both;
}

}  // namespace limber::editor
