// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/figure/figure_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/base/error.h"

namespace limber::editor {

namespace {

constexpr double kPoint = 25.4 / 72;  // one typographic point, mm
constexpr double kLetterSize = 10 * kPoint, kTitleSize = 8 * kPoint, kTextSize = 7 * kPoint;
constexpr double kLine = 1.3;   // distance between the baselines of two lines, in units of the font size
constexpr double kRise = 0.75;  // height of capitals above the baseline plus a small margin, in units of the font size
constexpr double kMargin = 1.5, kGap = 1.5, kColumnGap = 3;
constexpr double kSwatch = 0.8 * kTextSize, kSwatchGap = 1;
constexpr double kBarHeight = 0.5, kTickHeight = 1.4;
constexpr double kLongestBar = 0.3;  // the scale bar is at most this long, as a fraction of the picture's width
// A figure is an error if its picture would be lower than this fraction of the figure's height.
constexpr double kSmallestPicture = 0.35;
// A figure is laid out at most this many times, even if each new legend changes which tissues the picture shows.
constexpr int kMostRounds = 4;

// Returns the largest number that is 1, 2 or 5 times a power of ten and not larger than `most`.
double round_length(double most) {
  const double ten = std::pow(10, std::floor(std::log10(most)));
  return most >= 5 * ten ? 5 * ten : most >= 2 * ten ? 2 * ten : ten;
}

std::string text_of_length(double millimetres) {
  char text[48];
  if (millimetres >= 10000) std::snprintf(text, sizeof text, "%g m", millimetres / 1000);
  else if (millimetres < 0.1) std::snprintf(text, sizeof text, "%g \u00b5m", millimetres * 1000);
  else std::snprintf(text, sizeof text, "%g mm", millimetres);
  return text;
}

class Composer {
 public:
  Composer(const FigureOptions& options, const Lettering& lettering)
      : lettering_(lettering),
        ink_(options.paper == FigureOptions::Paper::Black ? 1.0f : 0.0f) {
    result_.options = options;
    result_.pixels = figure_pixels(options);
    top_ = kMargin;
    bottom_ = options.size.y - kMargin;
    if (options.letter.empty() && options.title.empty()) return;
    add_heading();
  }

  // Returns the layout with the legend. Room for the scale bar is reserved, but its length is not set yet.
  FigureLayout with_legend(const std::vector<LegendEntry>& legend) {
    if (!legend.empty()) add_legend(legend);
    if (result_.options.scale_bar) {
      bottom_ -= kTickHeight + 0.4;
      bar_base_ = bottom_ + 0.4 + kTickHeight;
      bottom_ -= kGap;
    }
    const double per_mm = result_.options.dots_per_inch / 25.4;
    const glm::dvec2 low(kMargin, top_), high(result_.options.size.x - kMargin, bottom_);
    if (high.y - low.y < kSmallestPicture * result_.options.size.y)
      throw Error("the figure has no room for its picture beside the title and " + std::to_string(legend.size()) +
                      " tissues in the legend",
                  "figure", "make the figure larger, hide tissues, or leave out the legend");
    result_.picture_low = glm::ivec2(glm::ceil(low * per_mm));
    result_.picture_pixels = glm::ivec2(glm::floor(high * per_mm)) - result_.picture_low;
    return result_;
  }

  // Returns `figure` with a scale bar for a picture in which a pixel shows `millimetres_per_pixel` of the body.
  //   at_focus  true: the bar's text says that the scale is that at the camera's focus
  FigureLayout with_bar(FigureLayout figure, double millimetres_per_pixel, bool at_focus) const {
    if (!figure.options.scale_bar) return figure;
    const double pixel = 25.4 / figure.options.dots_per_inch;
    figure.bar_millimetres = round_length(kLongestBar * figure.picture_pixels.x * millimetres_per_pixel);
    // The bar ends at a pixel's edge, so rounding changes its drawn length by half a pixel at most.
    const double right = (figure.picture_low.x + figure.picture_pixels.x) * pixel,
                 left = right - figure.bar_millimetres / millimetres_per_pixel * pixel,
                 middle = bar_base_ - kTickHeight / 2;
    figure.bar = {{left, middle - kBarHeight / 2}, {right, middle + kBarHeight / 2}, glm::vec3(ink_)};
    for (const double x : {left, right - kBarHeight})
      figure.boxes.push_back({{x, bar_base_ - kTickHeight}, {x + kBarHeight, bar_base_}, glm::vec3(ink_)});
    const std::string text = text_of_length(figure.bar_millimetres) + (at_focus ? " at the focus" : "");
    const double width = lettering_.width(text, false) * kTextSize;
    // The bar's text is to the left of the bar. Its baseline is chosen so that digits are vertically centred on the
    // bar.
    figure.texts.push_back({{left - kSwatchGap - width, middle + 0.36 * kTextSize}, kTextSize, false, text, width});
    if (left - kSwatchGap - width < 0)
      throw Error("the figure is too narrow for its scale bar", "figure",
                  "make the figure wider, or leave out the scale bar");
    return figure;
  }

 private:
  void add_text(const glm::dvec2& left_base, double size, bool bold, const std::string& text) {
    result_.texts.push_back({left_base, size, bold, text, lettering_.width(text, bold) * size});
  }

  void add_heading() {
    const FigureOptions& options = result_.options;
    double left = kMargin;
    const double base = top_ + kRise * (options.letter.empty() ? kTitleSize : kLetterSize);
    if (!options.letter.empty()) {
      add_text({left, base}, kLetterSize, true, options.letter);
      left += result_.texts.back().width + 2;
    }
    const double room = options.size.x - kMargin - left;
    if (room < 0.1 * options.size.x)
      throw Error("the letter is too long for the figure", options.letter, "use one or two characters");
    const auto lines = lettering_.lines(options.title, false, room / kTitleSize);
    for (std::size_t i = 0; i < lines.size(); ++i)
      add_text({left, base + kLine * kTitleSize * static_cast<double>(i)}, kTitleSize, false, lines[i]);
    top_ = base + kLine * kTitleSize * std::max(0.0, static_cast<double>(lines.size()) - 1) + 0.25 * kTitleSize + kGap;
  }

  // Adds the legend at the bottom, in as many columns as the longest name allows. Each column is filled from top to
  // bottom.
  void add_legend(const std::vector<LegendEntry>& legend) {
    const double room = result_.options.size.x - 2 * kMargin, before = kSwatch + kSwatchGap;
    double widest = 0;
    for (const LegendEntry& entry : legend) widest = std::max(widest, lettering_.width(entry.name, false) * kTextSize);
    const double column = std::min(before + widest, room);
    const auto count = static_cast<int>(legend.size());
    int columns = std::clamp(static_cast<int>((room + kColumnGap) / (column + kColumnGap)), 1, count);
    const int rows = (count + columns - 1) / columns;
    columns = (count + rows - 1) / rows;

    std::vector<std::vector<std::string>> names;
    for (const LegendEntry& entry : legend)
      names.push_back(lettering_.lines(entry.name, false, (column - before) / kTextSize + 1e-6));
    std::vector<double> row_top(static_cast<std::size_t>(rows) + 1, 0.0);
    for (int row = 0; row < rows; ++row) {
      std::size_t lines = 1;
      for (int i = row; i < count; i += rows) lines = std::max(lines, names[static_cast<std::size_t>(i)].size());
      row_top[static_cast<std::size_t>(row) + 1] =
          row_top[static_cast<std::size_t>(row)] + kLine * kTextSize * static_cast<double>(lines);
    }
    bottom_ -= row_top.back() - (kLine - 1) * kTextSize;
    for (int i = 0; i < count; ++i) {
      const glm::dvec2 at(kMargin + (column + kColumnGap) * (i / rows),
                          bottom_ + row_top[static_cast<std::size_t>(i % rows)]);
      const double base = at.y + kRise * kTextSize;
      const LegendEntry& entry = legend[static_cast<std::size_t>(i)];
      result_.boxes.push_back({{at.x, base - kSwatch}, {at.x + kSwatch, base}, entry.colour});
      for (std::size_t line = 0; line < names[static_cast<std::size_t>(i)].size(); ++line)
        add_text({at.x + before, base + kLine * kTextSize * static_cast<double>(line)}, kTextSize, false,
                 names[static_cast<std::size_t>(i)][line]);
    }
    bottom_ -= kGap;
  }

  const Lettering& lettering_;
  FigureLayout result_;
  float ink_;  // grey value of the texts and the scale bar, [0, 1]
  double top_, bottom_, bar_base_ = 0;
};

}  // namespace

glm::ivec2 figure_pixels(const FigureOptions& options) {
  char text[96];
  std::snprintf(text, sizeof text, "%g x %g mm at %g dpi", options.size.x, options.size.y, options.dots_per_inch);
  for (const double side : {options.size.x, options.size.y})
    if (!(side >= kSmallestFigure) || !(side <= kLargestFigure))
      throw Error("this is not a figure size", text, "use 20 to 1000 mm a side");
  if (!(options.dots_per_inch >= kLowestResolution) || !(options.dots_per_inch <= kHighestResolution))
    throw Error("this is not a figure resolution", text, "use 30 to 2400 dpi");
  const glm::ivec2 pixels(glm::round(options.size * options.dots_per_inch / 25.4));
  if (std::max(pixels.x, pixels.y) > kMostFigurePixels || double(pixels.x) * pixels.y > kLargestFigureArea)
    throw Error("the figure has too many pixels", text,
                "use at most 8192 pixels a side and 32 million in all: fewer dpi or mm");
  return pixels;
}

FigureLayout figure_layout(const FigureOptions& options, const FigureSource& source, const Lettering& lettering) {
  std::vector<LegendEntry> legend;
  auto composer = std::make_unique<Composer>(options, lettering);
  FigureLayout figure = composer->with_legend(legend);
  // The legend reduces the size of the picture, and a smaller picture may show fewer tissues. So legend and picture
  // are laid out again until they agree.
  for (int round = 0; options.legend && round < kMostRounds; ++round) {
    std::vector<LegendEntry> shown = source.legend(figure.picture_pixels);
    if (shown == legend) break;
    legend = std::move(shown);
    composer = std::make_unique<Composer>(options, lettering);
    figure = composer->with_legend(legend);
  }
  return composer->with_bar(std::move(figure), source.millimetres_per_pixel(figure.picture_pixels), source.at_focus);
}

}  // namespace limber::editor
