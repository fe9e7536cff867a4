// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/cli/figure_options.h"

#include <cstdio>
#include <map>

#include "core/base/error.h"

namespace limber::editor {

void add_figure_options(CLI::App& command, FigureFlags& flags) {
  using Paper = FigureOptions::Paper;
  CLI::Option* figure = command
                            .add_option("--figure", flags.size,
                                        "writes a figure of this size, mm, with scale bar and legend, instead of a "
                                        "plain picture; -o may end in .png, .tif or .svg")
                            ->type_name("WxH");
  const auto option = [&](CLI::Option* added) { return added->needs(figure); };
  option(command.add_option("--dpi", flags.options.dots_per_inch, "resolution of the figure, pixels per inch"))
      ->capture_default_str();
  option(command.add_option("--letter", flags.options.letter, "letter in the figure's corner, such as a"));
  option(command.add_option("--title", flags.options.title, "title of the figure"));
  option(command.add_option("--paper", flags.options.paper, "background of the figure: white, black or transparent"))
      ->transform(CLI::CheckedTransformer(std::map<std::string, Paper>{
          {"white", Paper::White}, {"black", Paper::Black}, {"transparent", Paper::Transparent}}));
  option(command.add_flag("--no-legend", flags.no_legend, "leave out the legend of tissues"));
  option(command.add_flag("--no-scale-bar", flags.no_scale_bar, "leave out the scale bar"));
}

std::optional<FigureOptions> figure_of(const FigureFlags& flags) {
  if (flags.size.empty()) return std::nullopt;
  FigureOptions options = flags.options;
  int end = 0;
  if (std::sscanf(flags.size.c_str(), "%lfx%lf%n", &options.size.x, &options.size.y, &end) != 2 ||
      end != static_cast<int>(flags.size.size()))
    throw Error("this is not a figure size", "--figure " + flags.size, "write WIDTHxHEIGHT in mm, as in 120x90");
  options.legend = !flags.no_legend;
  options.scale_bar = !flags.no_scale_bar;
  figure_pixels(options);
  return options;
}

}  // namespace limber::editor
