// SPDX-License-Identifier: AGPL-3.0-or-later
// Every view has a scale bar at any zoom, as long as the length that it names.
#include "editor/screen/scale_bar.h"

#include <cmath>

#include <doctest/doctest.h>

#include "editor/context/screen.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("scale bar: between a micrometre and 500 m a round length fits any zoom, and its text says it") {
  for (double least = 0.001; least < 250'000; least *= 1.013) {
    const ScaleLength length = scale_length(least);
    INFO(least << " mm: " << length.text);
    CHECK(length.millimetres >= least);
    CHECK(length.millimetres <= 2 * least * (1 + 1e-12));
    const std::size_t gap = length.text.find(' ');
    REQUIRE(gap != std::string::npos);
    const std::string unit = length.text.substr(gap + 1);
    const double factor = unit == "m" ? 1000 : unit == "cm" ? 10 : unit == "mm" ? 1 : 0.001;
    CHECK(std::stod(length.text) * factor == doctest::Approx(length.millimetres));
  }
  CHECK(scale_length(1e-9).text == "1 \u00b5m");
  CHECK(scale_length(1e9).text == "500 m");
}

TEST_CASE("scale bar: it never vanishes while the 3D view is zoomed, and stays 60 to 120 px long") {
  SmallEditor test;
  const double near = test.editor->views->body.camera.distance;
  for (double factor = 0.02; factor < 100; factor *= 1.17) {
    test.editor->views->body.camera.distance = near * factor;
    test.editor->ui->touch();
    test.player.settle();
    INFO(factor << " times the distance");
    const Widget* bar = test.editor->ui->widgets.find("3D view/scale bar");
    REQUIRE(bar);
    CHECK(bar->rect.width() >= 60 + 12 - 1);   // the bar's plate is 6 px wider at either side
    CHECK(bar->rect.width() <= 120 + 12 + 1);  // the length is rounded to a pixel
  }
}

TEST_CASE("scale bar: narrow slices have scale bars, too, right of the letter at their lower edge") {
  SmallEditor test({800, 520});
  test.play("key Ctrl+Alt+Q\nwait-idle");
  for (const float left : {0.2f, 0.8f}) {
    test.editor->screen->arrangement().four_x = left;
    test.player.settle();
    for (const auto& [id, name] :
         {std::pair(ViewId::Axial, "Axial"), {ViewId::Coronal, "Coronal"}, {ViewId::Sagittal, "Sagittal"}}) {
      const Rect* view = test.editor->screen->layout.place_of(id);
      const Widget* bar = test.editor->ui->widgets.find(std::string(name) + "/scale bar");
      REQUIRE(view);
      INFO(name << ", " << view->width() << " px wide");
      REQUIRE(bar);
      CHECK(view->contains(bar->rect));
      CHECK(bar->rect.low.x >= view->centre().x);
    }
  }
}

TEST_CASE("scale bar: in a narrow window an open sidebar covers neither the scale bar nor the axes") {
  SmallEditor test({1024, 640});
  for (const char* keys : {"move \"3D view/view\"\n key N\n wait-idle", "key Ctrl+Alt+Q\n wait-idle"}) {
    test.play(keys);
    const Rect& sidebar = test.editor->screen->layout.sidebar;
    REQUIRE_FALSE(sidebar.empty());
    int seen = 0;
    for (const Widget& widget : test.editor->ui->widgets.widgets())
      if (widget.name.ends_with("scale bar") || widget.name.ends_with("axis L")) {
        CHECK(widget.rect.high.x <= sidebar.low.x);
        ++seen;
      }
    CHECK(seen >= 2);
  }
}
