// SPDX-License-Identifier: AGPL-3.0-or-later
// The layout of a figure for a page: a picture with a letter and a title above, a scale bar below, and a legend of the
// tissues in columns. All lengths are millimetres on the page, measured from the figure's upper left corner, y down.
// Nothing is cut off: a text that is too wide is broken into lines, and a figure without room for its picture is an
// Error.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "editor/figure/lettering.h"

namespace limber::editor {

struct FigureOptions {
  glm::dvec2 size{120, 90};  // size of the whole figure, mm, each in [kSmallestFigure, kLargestFigure]
  double dots_per_inch = 300;
  // The figure's letter in a row of figures, such as "a", and its title; an empty text is not drawn.
  std::string letter, title;
  enum class Paper { White, Black, Transparent } paper = Paper::White;
  bool scale_bar = true, legend = true;
};
// The sides of a figure must have lengths between these, mm; otherwise the figure is an error.
inline constexpr double kSmallestFigure = 20, kLargestFigure = 1000;
inline constexpr double kLowestResolution = 30, kHighestResolution = 2400;
inline constexpr int kMostFigurePixels = 8192;  // a figure with more pixels along a side is an error
// A figure with more pixels in total is an error, because drawing its 3D picture would need gigabytes of memory.
inline constexpr double kLargestFigureArea = 32e6;

// Returns the figure's size in pixels. Throws Error when the figure is too large or too small.
glm::ivec2 figure_pixels(const FigureOptions& options);

struct LegendEntry {
  std::string name;
  glm::vec3 colour{0};  // colour of the tissue, sRGB

  bool operator==(const LegendEntry&) const = default;
};

struct FigureText {
  glm::dvec2 left_base{0};  // start of the text on its baseline, mm
  double size = 0;          // font size, mm
  bool bold = false;
  std::string text;
  double width = 0;
};
struct FigureBox {
  glm::dvec2 low{0}, high{0};
  glm::vec3 colour{0};  // colour that fills the box, sRGB
};

struct FigureLayout {
  FigureOptions options;
  glm::ivec2 pixels{0};                          // size of the whole figure, pixels
  glm::ivec2 picture_low{0}, picture_pixels{0};  // upper left corner and size of the picture, pixels
  // Length in the body that the scale bar represents, mm; 0: no scale bar.
  double bar_millimetres = 0;
  FigureBox bar;                 // the scale bar
  std::vector<FigureBox> boxes;  // ticks of the scale bar, and colour swatches of the legend
  std::vector<FigureText> texts;
};

// The content of a figure, as functions of the picture's size in pixels, which the layout decides.
struct FigureSource {
  std::function<std::vector<LegendEntry>(const glm::ivec2&)> legend;  // the tissues that the picture shows
  std::function<double(const glm::ivec2&)> millimetres_per_pixel;     // scale of the picture, mm in the body per pixel
  bool at_focus = false;  // true: the picture has perspective, so the scale is exact only at the camera's focus
};

// Returns the layout of a figure. Throws Error if there is no room for the picture, or if no font is installed.
FigureLayout figure_layout(const FigureOptions& options, const FigureSource& source, const Lettering& lettering);

}  // namespace limber::editor
