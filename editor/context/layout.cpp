// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/layout.h"

#include <cmath>

namespace limber::editor {

namespace {

constexpr float kBar = 36, kStrip = 44, kStatus = 26, kGap = 2;
constexpr float kSidebarLow = 260, kSidebarHigh = 520, kSidebarInSmall = 280, kBottomLow = 120, kBottomInSmall = 120;
// Views narrower than this are not moved from under a sidebar that covers them, px at scale 1.
constexpr float kLeastBeside = 200;

class Pixels {
 public:
  explicit Pixels(float scale) : scale_(scale) {}
  float operator()(float px) const { return std::round(px * scale_); }

 private:
  float scale_;
};

// Returns the part of a rectangle that the sidebar leaves free, or the whole rectangle if that part is too narrow.
Rect beside_sidebar(const Layout& layout, const Rect& rect, float scale) {
  const Rect beside = layout.uncovered(rect);
  return beside.width() >= kLeastBeside * scale ? beside : rect;
}

void place_one(Layout& layout, ViewId id) { layout.view_places = {{id, layout.views}}; }

// Splits the region of the views: the 3D view at the left, and two slices, one above the other, at the right.
void place_split(Layout& layout, const Arrangement& arrangement, float gap) {
  const Rect& all = layout.views;
  const float x = std::round(all.low.x + (all.width() - gap) * arrangement.split_x),
              y = std::round(all.low.y + (all.height() - gap) * arrangement.split_y);
  layout.view_places = {{ViewId::Body, {all.low, {x, all.high.y}}},
                        {ViewId::Sagittal, {{x + gap, all.low.y}, {all.high.x, y}}},
                        {ViewId::Axial, {{x + gap, y + gap}, all.high}}};
  layout.splitters.push_back({SplitterId::SplitX, {{x, all.low.y}, {x + gap, all.high.y}}, true});
  layout.splitters.push_back({SplitterId::SplitY, {{x + gap, y}, {all.high.x, y + gap}}, false});
}

void place_four(Layout& layout, const Arrangement& arrangement, float gap) {
  const Rect& all = layout.views;
  const float x = std::round(all.low.x + (all.width() - gap) * arrangement.four_x),
              y = std::round(all.low.y + (all.height() - gap) * arrangement.four_y);
  layout.view_places = {{ViewId::Axial, {all.low, {x, y}}},
                        {ViewId::Body, {{x + gap, all.low.y}, {all.high.x, y}}},
                        {ViewId::Coronal, {{all.low.x, y + gap}, {x, all.high.y}}},
                        {ViewId::Sagittal, {{x + gap, y + gap}, all.high}}};
  layout.splitters.push_back({SplitterId::FourX, {{x, all.low.y}, {x + gap, all.high.y}}, true});
  layout.splitters.push_back({SplitterId::FourY, {{all.low.x, y}, {all.high.x, y + gap}}, false});
}

void place_views(Layout& layout, const Arrangement& arrangement, float gap) {
  if (arrangement.maximized) return place_one(layout, *arrangement.maximized);
  switch (arrangement.views) {
    case ViewLayout::One: return place_one(layout, ViewId::Body);
    case ViewLayout::Split: return place_split(layout, arrangement, gap);
    case ViewLayout::Four: return place_four(layout, arrangement, gap);
  }
}

}  // namespace

Arrangement default_arrangement(Workspace workspace) {
  Arrangement arrangement;
  if (workspace == Workspace::Resample) {
    arrangement.results = true;
    arrangement.bottom_height = 228;
  }
  if (workspace == Workspace::Pose) arrangement.timeline = true;
  if (workspace == Workspace::Skin) arrangement.views = ViewLayout::Split;
  return arrangement;
}

Arrangements default_arrangements() {
  Arrangements all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = default_arrangement(static_cast<Workspace>(i));
  return all;
}

Rect Layout::uncovered(Rect rect) const {
  if (sidebar_over_views && !sidebar.empty()) rect.high.x = std::max(rect.low.x, std::min(rect.high.x, sidebar.low.x));
  return rect;
}

const ViewPlace* Layout::view_at(const glm::vec2& point) const {
  if (sidebar_over_views && sidebar.contains(point)) return nullptr;
  for (const ViewPlace& place : view_places)
    if (place.rect.contains(point)) return &place;
  return nullptr;
}

const Rect* Layout::place_of(ViewId id) const {
  for (const ViewPlace& place : view_places)
    if (place.id == id) return &place.rect;
  return nullptr;
}

Layout arrange(const glm::ivec2& window, float scale, const Arrangement& arrangement) {
  const Pixels px(scale);
  const glm::vec2 size(window), unscaled = size / scale;
  Layout layout;
  layout.window = {{0, 0}, size};
  layout.search_as_icon = layout.few_hints = unscaled.x < 1360;
  layout.short_labels = unscaled.x < 1180;
  const bool alone = arrangement.maximized.has_value();

  layout.top_bar = {{0, 0}, {size.x, px(kBar)}};
  layout.status = {{0, size.y - px(kStatus)}, size};
  const float top = layout.top_bar.high.y, bottom = layout.status.low.y;

  // Region of the sidebar
  layout.sidebar_over_views = unscaled.x < 1100;
  const bool sidebar_open = !alone && arrangement.sidebar.value_or(!layout.sidebar_over_views);
  float width = std::clamp(arrangement.sidebar_width, kSidebarLow, kSidebarHigh);
  if (unscaled.x < 1360 && width == 320) width = kSidebarInSmall;
  const float right = sidebar_open && !layout.sidebar_over_views ? size.x - px(width) : size.x;
  const float header_bottom = top + px(kBar);
  if (sidebar_open)
    layout.sidebar = {{size.x - px(width), layout.sidebar_over_views ? header_bottom : top}, {size.x, bottom}};
  layout.tool_header = {{0, top}, {right, header_bottom}};

  // Region of the bottom area: console, results or timeline
  float views_bottom = bottom;
  if ((arrangement.console || arrangement.results || arrangement.timeline) && !alone) {
    const float most = std::max(kBottomLow, unscaled.y / 2);
    const float height = unscaled.y < 720 ? kBottomInSmall : std::clamp(arrangement.bottom_height, kBottomLow, most);
    // The bottom area takes at most half of the height, so that the views keep the other half.
    views_bottom = std::max(bottom - px(height), std::round((header_bottom + bottom) / 2));
    layout.bottom = {{0, views_bottom}, {right, bottom}};
  }

  const float strip = arrangement.tool_strip && !alone ? px(kStrip) : 0;
  if (strip > 0) layout.tool_strip = {{0, header_bottom}, {strip, views_bottom}};
  layout.views = {{strip, header_bottom}, {right, views_bottom}};
  if (!sidebar_open && !alone) {
    const float middle = std::round((layout.views.low.y + layout.views.high.y) / 2), half = px(38);
    layout.sidebar_handle = {{right - px(28), middle - half}, {right, middle + half}};
  }
  if (arrangement.views != ViewLayout::One) layout.views = beside_sidebar(layout, layout.views, scale);
  place_views(layout, arrangement, px(kGap));

  const float line = std::max(1.0f, std::floor(scale));
  if (sidebar_open)
    layout.splitters.push_back({SplitterId::Sidebar,
                                {{layout.sidebar.low.x, layout.sidebar.low.y}, {layout.sidebar.low.x + line, bottom}},
                                true});
  if (!layout.bottom.empty())
    layout.splitters.push_back({SplitterId::Bottom, {layout.bottom.low, {right, layout.bottom.low.y + line}}, false});
  return layout;
}

Layout in_sides(Layout layout, float share, float scale) {
  const float half = std::max(1.0f, std::round(kGap * scale / 2));
  std::vector<ViewPlace> sides;
  for (ViewPlace place : layout.view_places) {
    place.rect = beside_sidebar(layout, place.rect, scale);
    const float x = std::round(place.rect.low.x + place.rect.width() * share);
    sides.push_back({place.id, {{x + half, place.rect.low.y}, place.rect.high}});
    sides.push_back({place.id, {place.rect.low, {x - half, place.rect.high.y}}, true});
  }
  layout.view_places = std::move(sides);
  layout.by_sides = true;
  return layout;
}

Arrangement dragged(Arrangement arrangement, SplitterId id, const glm::vec2& to, const Layout& layout, float scale) {
  const glm::vec2 share = glm::clamp((to - layout.views.low) / glm::max(layout.views.size(), glm::vec2(1)), 0.2f, 0.8f);
  switch (id) {
    case SplitterId::Sidebar:
      arrangement.sidebar_width =
          std::clamp(std::round((layout.window.high.x - to.x) / scale), kSidebarLow, kSidebarHigh);
      break;
    case SplitterId::Bottom: {
      const float most = std::max(kBottomLow, layout.window.height() / scale / 2);
      arrangement.bottom_height = std::clamp(std::round((layout.status.low.y - to.y) / scale), kBottomLow, most);
      break;
    }
    case SplitterId::SplitX: arrangement.split_x = share.x; break;
    case SplitterId::SplitY: arrangement.split_y = share.y; break;
    case SplitterId::FourX: arrangement.four_x = share.x; break;
    case SplitterId::FourY: arrangement.four_y = share.y; break;
  }
  return arrangement;
}

Arrangement restored(Arrangement arrangement, SplitterId id, Workspace workspace) {
  const Arrangement fresh = default_arrangement(workspace);
  switch (id) {
    case SplitterId::Sidebar: arrangement.sidebar_width = fresh.sidebar_width; break;
    case SplitterId::Bottom: arrangement.bottom_height = fresh.bottom_height; break;
    case SplitterId::SplitX: arrangement.split_x = fresh.split_x; break;
    case SplitterId::SplitY: arrangement.split_y = fresh.split_y; break;
    case SplitterId::FourX: arrangement.four_x = fresh.four_x; break;
    case SplitterId::FourY: arrangement.four_y = fresh.four_y; break;
  }
  return arrangement;
}

}  // namespace limber::editor
