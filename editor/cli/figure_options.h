// SPDX-License-Identifier: AGPL-3.0-or-later
// The options of `limber render` that make a figure of its picture.
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
// Returns the figure that the options ask for; nothing if they ask for none. Throws Error when they are wrong.
std::optional<FigureOptions> figure_of(const FigureFlags& flags);

}  // namespace limber::editor
