// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a figure as PNG or TIFF, or as SVG. The SVG embeds the picture as an image and has shapes and text for
// everything else. All formats store the figure's size on the page.
#pragma once

#include "core/base/file.h"
#include "editor/figure/figure_layout.h"

namespace limber::editor {

inline constexpr const char* kFigureEndings[] = {".png", ".tif", ".tiff", ".svg"};
// Throws Error if a figure cannot be written in the format that the path's extension names.
void check_figure_path(const Path& path);

// Returns the whole figure as an image.
//   picture  the figure's picture, layout.picture_pixels large, with a transparent background
render::Image figure_image(const FigureLayout& layout, const render::Image& picture, const Lettering& lettering);
std::string figure_svg(const FigureLayout& layout, const render::Image& picture);
// Writes the figure in the format that the path's extension names. Throws Error if writing fails.
void write_figure(const FigureLayout& layout, const render::Image& picture, const Lettering& lettering,
                  const Path& path);

}  // namespace limber::editor
