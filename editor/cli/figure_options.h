// SPDX-License-Identifier: AGPL-3.0-or-later
// The options of `limber render` that turn its picture into a figure for a page.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "editor/figure/figure_layout.h"

namespace limber::editor {

struct FigureFlags {
  std::string size;  // size of the figure, WIDTHxHEIGHT in mm; empty: the picture does not become a figure
  FigureOptions options;
  bool no_legend = false, no_scale_bar = false;
};

void add_figure_options(CLI::App& command, FigureFlags& flags);
// Returns the figure options that the command line gives. Returns no value if the command line asks for no figure.
// Throws Error for wrong values.
std::optional<FigureOptions> figure_of(const FigureFlags& flags);

}  // namespace limber::editor
