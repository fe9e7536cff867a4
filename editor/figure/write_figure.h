// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a figure as PNG or TIFF, in whole pixels, or as SVG with the picture inside and everything else as shapes and
// text. All name their size on the page.
#pragma once

#include "core/base/file.h"
#include "editor/figure/figure_layout.h"

namespace limber::editor {

inline constexpr const char* kFigureEndings[] = {".png", ".tif", ".tiff", ".svg"};
// Throws Error when a figure cannot be written in the format of the path's ending.
void check_figure_path(const Path& path);

// Returns the whole figure in pixels.
//   picture  what the figure shows, with layout.picture_pixels pixels, on a transparent background
render::Image figure_image(const FigureLayout& layout, const render::Image& picture, const Lettering& lettering);
std::string figure_svg(const FigureLayout& layout, const render::Image& picture);
// Writes the format of the path's ending. Throws Error when writing fails.
void write_figure(const FigureLayout& layout, const render::Image& picture, const Lettering& lettering,
                  const Path& path);

}  // namespace limber::editor
