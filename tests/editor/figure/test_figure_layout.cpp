// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/figure/figure_layout.h"

#include <doctest/doctest.h>

#include "core/base/error.h"

using namespace limber;
using namespace limber::editor;

namespace {

// Returns a picture in which one pixel is half a millimetre of the body.
FigureSource source_with(const std::vector<std::string>& names) {
  FigureSource source;
  source.legend = [names](const glm::ivec2&) {
    std::vector<LegendEntry> legend;
    for (const std::string& name : names) legend.push_back({name, glm::vec3(0.5f)});
    return legend;
  };
  source.millimetres_per_pixel = [](const glm::ivec2&) { return 0.5; };
  return source;
}

std::vector<std::string> many(int count, const std::string& name) {
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) names.push_back(name + " " + std::to_string(i));
  return names;
}

struct Box {
  glm::dvec2 low, high;
};

// Returns the boxes of all parts in mm. The box of a text reaches from its accents to its descenders.
std::vector<Box> parts_of(const FigureLayout& layout) {
  const double pixel = 25.4 / layout.options.dots_per_inch;
  std::vector<Box> parts = {
      {glm::dvec2(layout.picture_low) * pixel, glm::dvec2(layout.picture_low + layout.picture_pixels) * pixel}};
  for (const FigureText& text : layout.texts)
    parts.push_back(
        {text.left_base - glm::dvec2(0, 0.75 * text.size), text.left_base + glm::dvec2(text.width, 0.25 * text.size)});
  if (layout.bar_millimetres > 0) parts.push_back({layout.bar.low, layout.bar.high});
  return parts;
}

// Checks that every part lies in the figure, and that no two overlap.
void check_room(const FigureLayout& layout) {
  const std::vector<Box> parts = parts_of(layout);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    INFO("part ", i, " of ", parts.size());
    CHECK(glm::all(glm::greaterThanEqual(parts[i].low, glm::dvec2(0))));
    CHECK(glm::all(glm::lessThanEqual(parts[i].high, layout.options.size)));
    for (std::size_t j = 0; j < i; ++j) {
      const glm::dvec2 both =
          glm::min(parts[i].high, parts[j].high) - glm::max(parts[i].low, parts[j].low) - glm::dvec2(1e-6);
      INFO("over part ", j);
      CHECK_FALSE(glm::all(glm::greaterThan(both, glm::dvec2(0))));
    }
  }
}

}  // namespace

TEST_CASE("figure layout: titles, legends and scale bars of any length have room, and nothing lies over another") {
  const Lettering lettering;
  const std::string wide = "musculus sternocleidomastoideus, venter sinister et dexter";
  for (const glm::dvec2 size : {glm::dvec2(120, 90), glm::dvec2(85, 85), glm::dvec2(180, 60), glm::dvec2(60, 110)})
    for (const int tissues : {0, 1, 5, 12})
      for (const std::string& name : {std::string("skin"), wide}) {
        if (name == wide && tissues == 12 && std::min(size.x, size.y) < 80) continue;
        FigureOptions options{.size = size, .letter = "a", .title = "Nothing of " + wide + " may be cut off"};
        INFO(size.x, " x ", size.y, ", ", tissues, " tissues");
        check_room(figure_layout(options, source_with(many(tissues, name)), lettering));
        options.letter = options.title = "";
        check_room(figure_layout(options, source_with(many(tissues, name)), lettering));
      }
}

TEST_CASE("figure layout: the legend has as many columns as its names allow, filled downwards") {
  const Lettering lettering;
  const FigureLayout layout = figure_layout({.scale_bar = false}, source_with(many(12, "muscle")), lettering);
  REQUIRE(layout.texts.size() == 12);
  std::set<double> lefts;
  for (const FigureText& text : layout.texts) lefts.insert(text.left_base.x);
  CHECK(lefts.size() >= 4);
  CHECK(layout.texts[0].left_base.x == layout.texts[1].left_base.x);
  CHECK(layout.texts[0].left_base.y < layout.texts[1].left_base.y);
}

TEST_CASE("figure layout: a name wider than the figure is broken into lines, within a word where it must be") {
  const Lettering lettering;
  const std::string name(300, 'm');
  const FigureLayout layout =
      figure_layout({.size = {60, 90}, .scale_bar = false}, source_with({name, "short"}), lettering);
  check_room(layout);
  std::string again;
  for (std::size_t i = 0; i + 1 < layout.texts.size(); ++i) again += layout.texts[i].text;
  CHECK(again == name);
  CHECK(layout.texts.back().text == "short");
  CHECK(lettering.lines("one\n two\tthree  four", false, 100) == std::vector<std::string>{"one two three four"});
  CHECK(lettering.lines("", false, 100).empty());
  CHECK(lettering.lines("f\u00fcr \u00e4u\u00dferst enge Spalten", false, 1.2).size() > 5);  // every character fits
}

TEST_CASE("figure layout: the scale bar stands for a round length, and says where it holds") {
  const Lettering lettering;
  FigureSource source = source_with({});
  for (const double scale : {0.013, 0.5, 3.7, 120.0}) {
    source.millimetres_per_pixel = [scale](const glm::ivec2&) { return scale; };
    for (const bool at_focus : {false, true}) {
      source.at_focus = at_focus;
      const FigureLayout layout = figure_layout({}, source, lettering);
      check_room(layout);
      const double pixels = (layout.bar.high.x - layout.bar.low.x) * layout.options.dots_per_inch / 25.4;
      CHECK(pixels * scale == doctest::Approx(layout.bar_millimetres));
      CHECK(pixels > 0.1 * layout.picture_pixels.x);
      CHECK(pixels < 0.35 * layout.picture_pixels.x);
      const double digit = layout.bar_millimetres / std::pow(10, std::floor(std::log10(layout.bar_millimetres) + 1e-9));
      CHECK((std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 5) < 1e-6));
      CHECK((layout.texts.back().text.find("at the focus") != std::string::npos) == at_focus);
    }
  }
}

TEST_CASE("figure layout: what has no room or no sense is refused in one line") {
  const Lettering lettering;
  CHECK_THROWS_AS(figure_layout({.size = {60, 40}}, source_with(many(60, "muscle")), lettering), Error);
  CHECK_NOTHROW(figure_layout({.size = {60, 40}, .legend = false}, source_with(many(60, "muscle")), lettering));
  CHECK_THROWS_AS(figure_pixels({.size = {10, 90}}), Error);
  CHECK_THROWS_AS(figure_pixels({.size = {120, NAN}}), Error);
  CHECK_THROWS_AS(figure_pixels({.dots_per_inch = 0}), Error);
  CHECK_THROWS_AS(figure_pixels({.size = {900, 900}, .dots_per_inch = 600}), Error);
  CHECK(figure_pixels({.size = {25.4, 50.8}, .dots_per_inch = 300}) == glm::ivec2(300, 600));
}
