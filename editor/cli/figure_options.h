// SPDX-License-Identifier: AGPL-3.0-or-later
// The options of `limber render` that turn its picture into a figure for a page.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "editor/figure/figure_layout.h"

namespace limber::editor {

struct FigureFlags {
  std::string size;  // WIDTHxHEIGHT, mm; empty: no figure
  FigureOptions options;
  bool no_legend = false, no_scale_bar = false;
};

void add_figure_options(CLI::App& command, FigureFlags& flags);
// Returns the figure options that the command line gives; nothing if it asks for no figure. Throws Error for wrong
// values.
std::optional<FigureOptions> figure_of(const FigureFlags& flags);

}  // namespace limber::editor
