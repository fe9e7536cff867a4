// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/layout.h"

#include <doctest/doctest.h>

using namespace limber::editor;

namespace {

std::vector<Rect> regions(const Layout& layout) {
  std::vector<Rect> all{layout.top_bar, layout.tool_header, layout.tool_strip, layout.bottom, layout.status};
  if (!layout.sidebar_over_views) all.push_back(layout.sidebar);
  for (const ViewPlace& place : layout.view_places) all.push_back(place.rect);
  std::erase_if(all, [](const Rect& rect) { return rect.empty(); });
  return all;
}

}  // namespace

TEST_CASE("layout: regions lie in the window and never overlap, at any size, scale and arrangement") {
  for (const glm::ivec2 size : {glm::ivec2(1600, 900), {1280, 720}, {1024, 640}, {800, 520}, {3840, 2160}})
    for (const float scale : {0.75f, 1.0f, 1.5f, 2.0f, 3.0f})
      for (int bits = 0; bits < 24; ++bits) {
        Arrangement arrangement;
        arrangement.views = static_cast<ViewLayout>(bits % 3);
        arrangement.console = bits / 3 % 2;
        arrangement.tool_strip = bits / 6 % 2;
        if (bits / 12) arrangement.sidebar = true;
        const Layout layout = arrange(size, scale, arrangement);
        const auto all = regions(layout);
        for (std::size_t i = 0; i < all.size(); ++i) {
          INFO(size.x, "x", size.y, " scale ", scale, " bits ", bits, " region ", i);
          CHECK(layout.window.contains(all[i]));
          for (std::size_t k = 0; k < i; ++k) CHECK_FALSE(all[i].overlaps(all[k]));
        }
      }
}

TEST_CASE("layout: in sides each view stands twice, side A at the left, and nothing overlaps") {
  for (const float scale : {0.75f, 1.0f, 2.0f})
    for (const ViewLayout views : {ViewLayout::One, ViewLayout::Split, ViewLayout::Four})
      for (const float share : {0.2f, 0.5f, 0.8f}) {
        Arrangement arrangement;
        arrangement.views = views;
        const Layout one = arrange({1600, 900}, scale, arrangement), two = in_sides(one, share, scale);
        REQUIRE(two.view_places.size() == 2 * one.view_places.size());
        CHECK(two.several() == one.several());
        for (std::size_t i = 0; i < one.view_places.size(); ++i) {
          const ViewPlace &b = two.view_places[2 * i], &a = two.view_places[2 * i + 1];
          CHECK(a.side_a);
          CHECK_FALSE(b.side_a);
          CHECK(a.id == one.view_places[i].id);
          CHECK(b.id == a.id);
          CHECK(a.rect.low == one.view_places[i].rect.low);
          CHECK(b.rect.high == one.view_places[i].rect.high);
          CHECK(a.rect.high.x < b.rect.low.x);
          CHECK_FALSE(a.rect.empty());
          CHECK_FALSE(b.rect.empty());
          CHECK(two.place_of(b.id)->low == b.rect.low);
        }
      }
}

TEST_CASE("layout: at 1600x900 the regions have the sizes of the drawing") {
  Arrangement arrangement;
  arrangement.views = ViewLayout::Four;
  const Layout layout = arrange({1600, 900}, 1, arrangement);
  CHECK(layout.top_bar == Rect{{0, 0}, {1600, 36}});
  CHECK(layout.tool_header == Rect{{0, 36}, {1280, 72}});
  CHECK(layout.sidebar == Rect{{1280, 36}, {1600, 874}});
  CHECK(layout.tool_strip == Rect{{0, 72}, {44, 874}});
  CHECK(layout.view_places.size() == 4);
  CHECK(layout.place_of(ViewId::Body)->high == glm::vec2(1280, layout.place_of(ViewId::Axial)->high.y));
}

TEST_CASE("layout: the body is the interface: views get half of the window or more") {
  for (const glm::ivec2 size : {glm::ivec2(1600, 900), {1280, 720}, {1024, 640}}) {
    const Layout layout = arrange(size, 1, {});
    CHECK(layout.views.width() * layout.views.height() > 0.5f * size.x * size.y);
  }
}

TEST_CASE("layout: below 1100 the sidebar is closed, and opened lies over the views") {
  CHECK(arrange({1024, 640}, 1, {}).sidebar.empty());
  CHECK_FALSE(arrange({1024, 640}, 1, {}).sidebar_handle.empty());
  Arrangement open;
  open.sidebar = true;
  const Layout layout = arrange({1024, 640}, 1, open);
  CHECK(layout.views.high.x == 1024);
  CHECK(layout.sidebar.width() == 280);
  CHECK(layout.view_at({1000, 300}) == nullptr);
  CHECK(arrange({2048, 1280}, 2, {}).sidebar.empty());  // the same window at twice the resolution
}

TEST_CASE("layout: below 1100 an open sidebar covers no slice, and no side of a comparison") {
  Arrangement open;
  open.sidebar = true;
  for (const float scale : {1.0f, 2.0f}) {
    const glm::ivec2 window(glm::vec2(1024, 640) * scale);
    const Layout one = arrange(window, scale, open);
    CHECK(one.uncovered(one.views).high.x == one.sidebar.low.x);
    std::vector<Layout> several{in_sides(one, 0.5f, scale)};
    for (const ViewLayout views : {ViewLayout::Split, ViewLayout::Four}) {
      open.views = views;
      several.push_back(arrange(window, scale, open));
      CHECK(several.back().views.high.x == several.back().sidebar.low.x);
      open.views = ViewLayout::One;
    }
    for (const Layout& layout : several)
      for (const ViewPlace& place : layout.view_places) {
        CHECK_FALSE(place.rect.overlaps(layout.sidebar));
        CHECK(place.rect.width() > 150 * scale);
      }
  }
  const Layout wide = arrange({1280, 720}, 1, open);
  CHECK(wide.uncovered(wide.views) == wide.views);
}

TEST_CASE("layout: a splitter goes where it is dragged, within its limits, and back by a double click") {
  const Arrangement start;
  const Layout layout = arrange({1600, 900}, 1, start);
  CHECK(dragged(start, SplitterId::Sidebar, {1200, 0}, layout, 1).sidebar_width == 400);
  CHECK(dragged(start, SplitterId::Sidebar, {1500, 0}, layout, 1).sidebar_width == 260);
  CHECK(dragged(start, SplitterId::Sidebar, {100, 0}, layout, 1).sidebar_width == 520);
  CHECK(dragged(start, SplitterId::FourX, {0, 0}, layout, 1).four_x == doctest::Approx(0.2));
  CHECK(dragged(start, SplitterId::FourX, {9999, 0}, layout, 1).four_x == doctest::Approx(0.8));
  for (const SplitterId id : {SplitterId::Sidebar, SplitterId::Bottom, SplitterId::SplitX, SplitterId::SplitY,
                              SplitterId::FourX, SplitterId::FourY})
    CHECK(restored(dragged(start, id, {700, 300}, layout, 1), id, Workspace::Rig) == start);
}

TEST_CASE("layout: a maximized view fills all between header and status bar") {
  Arrangement arrangement;
  arrangement.views = ViewLayout::Four;
  arrangement.maximized = ViewId::Coronal;
  const Layout layout = arrange({1600, 900}, 1, arrangement);
  REQUIRE(layout.view_places.size() == 1);
  CHECK(layout.view_places[0].id == ViewId::Coronal);
  CHECK(layout.view_places[0].rect == Rect{{0, 72}, {1600, 874}});
}
