// SPDX-License-Identifier: AGPL-3.0-or-later
// The layout of a figure for a page: a picture with a letter and a title above, a scale bar below, and a legend of the
// tissues in columns. All lengths are millimetres on the page, from the figure's upper left corner, y down. Nothing is
// cut off: what is too wide is broken into lines, and a figure that has no room for its picture is refused.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "editor/figure/lettering.h"

namespace limber::editor {

struct FigureOptions {
  glm::dvec2 size{120, 90};  // of the whole figure, mm, each [kSmallestFigure, kLargestFigure]
  double dots_per_inch = 300;
  std::string letter, title;  // of the figure among others, as in "a"; empty: none
  enum class Paper { White, Black, Transparent } paper = Paper::White;
  bool scale_bar = true, legend = true;
};
inline constexpr double kSmallestFigure = 20, kLargestFigure = 1000;  // mm
inline constexpr double kLowestResolution = 30, kHighestResolution = 2400;
inline constexpr int kMostFigurePixels = 8192;  // largest side of a figure
inline constexpr double kLargestFigureArea =
    32e6;  // pixels; a 3D picture of this size takes gigabytes while it is drawn

// Returns the figure's size in pixels. Throws Error when it is too large or too small.
glm::ivec2 figure_pixels(const FigureOptions& options);

struct LegendEntry {
  std::string name;
  glm::vec3 colour{0};  // sRGB

  bool operator==(const LegendEntry&) const = default;
};

struct FigureText {
  glm::dvec2 left_base{0};  // where it begins, on its base line
  double size = 0;          // of the font
  bool bold = false;
  std::string text;
  double width = 0;
};
struct FigureBox {
  glm::dvec2 low{0}, high{0};
  glm::vec3 colour{0};  // sRGB
};

struct FigureLayout {
  FigureOptions options;
  glm::ivec2 pixels{0};                          // of the whole figure
  glm::ivec2 picture_low{0}, picture_pixels{0};  // the picture's place, pixels
  double bar_millimetres = 0;                    // length in the body that the scale bar stands for; 0: no scale bar
  FigureBox bar;                                 // the scale bar
  std::vector<FigureBox> boxes;                  // ticks of the scale bar, and colours of the legend
  std::vector<FigureText> texts;
};

// What a figure shows, as functions of its picture's size in pixels, which the layout decides.
struct FigureSource {
  std::function<std::vector<LegendEntry>(const glm::ivec2&)> legend;  // the tissues that the picture shows
  std::function<double(const glm::ivec2&)> millimetres_per_pixel;     // in the body
  bool at_focus = false;  // true: the picture has perspective, so the scale holds at its focus only
};

// Throws Error when there is no room for the picture, or when no font is installed.
FigureLayout figure_layout(const FigureOptions& options, const FigureSource& source, const Lettering& lettering);

}  // namespace limber::editor
