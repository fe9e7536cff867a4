// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/axis_fields.h"

#include <algorithm>
#include <cmath>

#include "editor/ui/draw.h"

namespace limber::editor {

std::array<Rect, 3> lay_axis_fields(const Look& look, Column& column, const std::string& title) {
  const float gap = look.px(4), mark = look.px(3);
  Rect row = column.property(title);
  row.low.x = std::round(row.high.x - std::max(row.width(), look.px(180)));
  const float width = (row.width() - 2 * gap) / 3;
  std::array<Rect, 3> fields;
  for (int axis = 0; axis < 3; ++axis) {
    const float x = std::round(row.low.x + static_cast<float>(axis) * (width + gap));
    fill({{x, row.low.y}, {x + mark, row.high.y}}, look.theme.axis[axis]);
    fields[static_cast<std::size_t>(axis)] = {{x + mark, row.low.y}, {std::round(x + width), row.high.y}};
  }
  return fields;
}

}  // namespace limber::editor
