// SPDX-License-Identifier: AGPL-3.0-or-later
// Where each region of the window lies: a pure function of the window's size, the scale, and what the user arranged.
//
//   top bar 36
//   tool header 36                              | sidebar 320, down to the status bar
//   tool strip 44 | views, 2 px gaps            |
//   bottom area (console, results or timeline)                       |
//   status 26
//
// Sizes are pixels at scale 1. Small windows: under 1360 wide the sidebar takes 280 and the search field shrinks to its
// icon; under 1180 buttons with an icon lose their words; under 1100 the sidebar is closed, and opened it lies over the
// views; under 720 high the bottom area takes 120.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "editor/ui/rect.h"

namespace limber::editor {

enum class Workspace { Rig, Skin, Pose, Resample };
enum class ViewId { Body, Axial, Coronal, Sagittal };
enum class ViewLayout { One, Split, Four };

// What the user moves and opens, kept for each workspace.
struct Arrangement {
  ViewLayout views = ViewLayout::One;
  std::optional<bool> sidebar;  // open; nothing: as the window's width suggests
  bool tool_strip = true;
  bool console = false;
  bool results = false;
  bool timeline = false;
  float sidebar_width = 320, bottom_height = 192;
  float split_x = 0.66f, split_y = 0.5f, four_x = 0.5f, four_y = 0.5f;  // shares of the first view
  std::optional<ViewId> maximized;

  bool operator==(const Arrangement&) const = default;
};
Arrangement default_arrangement(Workspace workspace);

using Arrangements = std::array<Arrangement, 4>;  // by workspace
Arrangements default_arrangements();

struct ViewPlace {
  ViewId id;
  Rect rect;
  bool side_a = false;  // of two beside one another that are compared: the left one
};

enum class SplitterId { Sidebar, Bottom, SplitX, SplitY, FourX, FourY };
struct Splitter {
  SplitterId id;
  Rect line;      // the gap; what can be gripped is wider
  bool vertical;  // a line from top to bottom, dragged sideways
};

struct Layout {
  Rect window, top_bar, tool_header, tool_strip, views, sidebar, sidebar_handle, bottom, status;  // empty where absent
  bool sidebar_over_views = false;
  bool by_sides = false;  // each view stands twice
  bool search_as_icon = false, few_hints = false, short_labels = false;
  std::vector<ViewPlace> view_places;
  std::vector<Splitter> splitters;

  bool several() const { return view_places.size() > (by_sides ? 2u : 1u); }
  const ViewPlace* view_at(const glm::vec2& point) const;  // nullptr outside every view
  const Rect* place_of(ViewId id) const;                   // nullptr when not shown
};
Layout arrange(const glm::ivec2& window, float scale, const Arrangement& arrangement);
// Each view becomes two with a gap between them, the one to compare with at the left.
//   share  of its width that the left one takes
Layout in_sides(Layout layout, float share, float scale);

// The arrangement after the pointer dragged a splitter to that point; limits hold (sidebar 260-520, bottom 120 to half
// of the window, views 20-80 %).
Arrangement dragged(Arrangement arrangement, SplitterId id, const glm::vec2& to, const Layout& layout, float scale);
// What a double click on it restores.
Arrangement restored(Arrangement arrangement, SplitterId id, Workspace workspace);

}  // namespace limber::editor
