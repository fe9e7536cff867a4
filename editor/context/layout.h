// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the rectangle of each region of the window. It depends only on the window's size, the scale and the user's
// arrangement.
//
//   top bar 36
//   tool header 36                              | sidebar 320, down to the status bar
//   tool strip 44 | views, 2 px gaps            |
//   bottom area (console, results or timeline)                       |
//   status 26
//
// Sizes are pixels at scale 1. If the window is less than 1360 wide, the sidebar is 280 wide and the search field
// shrinks to its icon. Below 1180, buttons with an icon lose their text. Below 1100, the sidebar is closed at first;
// when opened, it covers the right part of a single 3D view, and several views end at it. If the window is less than
// 720 high, the bottom area is 120 high.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "editor/context/view_place.h"
#include "editor/context/workspace.h"
#include "editor/ui/rect.h"

namespace limber::editor {

enum class ViewLayout { One, Split, Four };

// The regions of the window that the user has opened, and their sizes. Each workspace has its own arrangement.
struct Arrangement {
  ViewLayout views = ViewLayout::One;
  std::optional<bool> sidebar;  // whether the sidebar is open; no value: open if the window is at least 1100 wide
  bool tool_strip = true;
  bool console = false;
  bool results = false;
  bool timeline = false;
  float sidebar_width = 320, bottom_height = 192;
  // Fractions of the width or height that the left or upper views take, in the layouts Split and Four.
  float split_x = 0.66f, split_y = 0.5f, four_x = 0.5f, four_y = 0.5f;
  std::optional<ViewId> maximized;

  bool operator==(const Arrangement&) const = default;
};
Arrangement default_arrangement(Workspace workspace);

using Arrangements = std::array<Arrangement, 4>;  // one arrangement for each workspace
Arrangements default_arrangements();

enum class SplitterId { Sidebar, Bottom, SplitX, SplitY, FourX, FourY };
struct Splitter {
  SplitterId id;
  Rect line;      // the visible gap between two regions; the area that can be dragged is wider
  bool vertical;  // true: the line runs from top to bottom and is dragged sideways
};

struct Layout {
  // Rectangles of the window's regions, pixels; empty if not shown.
  Rect window, top_bar, tool_header, tool_strip, views, sidebar, sidebar_handle, bottom, status;
  bool sidebar_over_views = false;
  bool by_sides = false;  // true: each view appears twice, to compare two results side by side
  bool search_as_icon = false, few_hints = false, short_labels = false;
  std::vector<ViewPlace> view_places;
  std::vector<Splitter> splitters;

  bool several() const { return view_places.size() > (by_sides ? 2u : 1u); }
  Rect uncovered(Rect rect) const;  // returns the part of a rectangle at the left of a sidebar that covers the views
  const ViewPlace* view_at(const glm::vec2& point) const;  // returns nullptr if the point is outside every view
  const Rect* place_of(ViewId id) const;                   // returns nullptr if the view is not shown
};
Layout arrange(const glm::ivec2& window, float scale, const Arrangement& arrangement);
// Splits each view into two views with a gap between them, to compare two results. The left view shows result A.
//   share  fraction of the original view's width that the left view takes, [0, 1]
Layout in_sides(Layout layout, float share, float scale);

// Returns the arrangement after the pointer dragged a splitter to the point `to`. The sidebar stays 260 to 520 pixels
// wide, the bottom area 120 pixels to half of the window high. Views keep 20 to 80 percent of their region.
Arrangement dragged(Arrangement arrangement, SplitterId id, const glm::vec2& to, const Layout& layout, float scale);
// Returns the arrangement with a splitter at its default position. A double click on the splitter asks for this.
Arrangement restored(Arrangement arrangement, SplitterId id, Workspace workspace);

}  // namespace limber::editor
