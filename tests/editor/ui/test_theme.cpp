// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/theme.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "editor/ui/asset_path.h"
#include "editor/viewport/gizmo_draw.h"
#include "tests/support/program.h"

using namespace limber::editor;

TEST_CASE("theme: contrast is that of WCAG 2") {
  CHECK(contrast(0xFF000000, 0xFFFFFFFF) == doctest::Approx(21));
  CHECK(contrast(0xFF777777, 0xFFFFFFFF) == doctest::Approx(4.48).epsilon(0.005));
}

TEST_CASE("theme: every text can be read on what it stands on, in both themes") {
  for (const char* name : {"dark", "light"}) {
    const Theme theme = read_theme(asset(std::string("themes/") + name + ".json"));
    INFO(theme.name);
    for (const Colour background : {theme.panel, theme.head, theme.accent_soft, theme.row_alt})
      for (const Colour text : {theme.text, theme.text2, theme.accent_text, theme.ok, theme.warn, theme.error})
        CHECK(contrast(text, background) >= 4.5);
    for (const Colour background : {theme.panel, theme.head, theme.row_alt})
      CHECK(contrast(theme.text3, background) >= 4.5);
    for (const Colour background : {theme.raised, theme.hover, theme.field})
      CHECK(contrast(theme.text, background) >= 4.5);
    CHECK(contrast(theme.text2, theme.raised) >= 4.5);
    CHECK(contrast(theme.text2, theme.hover) >= 4.5);
    CHECK(contrast(theme.on_accent, theme.accent) >= 4.5);
    CHECK(contrast(theme.on_select, theme.select) >= 4.5);
    CHECK(contrast(theme.view_text, theme.view_top) >= 4.5);
    CHECK(contrast(theme.view_text2, theme.view_top) >= 4.5);
    CHECK(contrast(theme.view_text2, theme.view_plate) >= 4.5);
    for (const Colour mark : {kViewOk, kViewWarn, kViewError, kViewAccent}) {
      CHECK(contrast(mark, theme.view_plate) >= 4.5);  // least contrast for text
      CHECK(contrast(mark, theme.view_top) >= 3);      // least contrast for lines
    }
  }
}

TEST_CASE("theme: the colours of scroll bars and of rims of swatches stand out from panels, in both themes") {
  for (const char* name : {"dark", "light"}) {
    const Theme theme = read_theme(asset(std::string("themes/") + name + ".json"));
    INFO(theme.name);
    CHECK(contrast(theme.line2, theme.panel) >= 1.5);
    CHECK(contrast(theme.line2, theme.row_alt) >= 1.4);
    CHECK(contrast(theme.text3, theme.line2) >= 1.5);
  }
}

TEST_CASE("theme: a file that lacks a colour is refused with the colour's name") {
  limber::test::TemporaryFolder folder;
  limber::write_atomically(folder / "theme.json", [](const limber::Path& path) {
    FILE* file = std::fopen(path.c_str(), "w");
    std::fputs(R"({"schema": "limber-theme/1", "colours": {"void": "101114"}})", file);
    std::fclose(file);
  });
  CHECK_THROWS_WITH_AS(read_theme(folder / "theme.json"), doctest::Contains("'panel'"), limber::Error);
}
