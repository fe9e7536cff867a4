// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines the command `limber editor`. It opens the editor, as `limber [FILE...]` does, and has options for the
// window's size and scale. It can also play a script without a display.
#include <memory>

#include "core/base/error.h"
#include "editor/app/main_loop.h"
#include "editor/cli/command.h"

namespace limber::editor {

namespace {

glm::ivec2 size_of(const std::string& text) {
  glm::ivec2 size{0};
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.x, &size.y, &rest) != 2 || size.x < 320 || size.y < 240 ||
      size.x > 16384 || size.y > 16384)
    throw Error("this is not a window size", text, "write WIDTHxHEIGHT, such as 1600x900");
  return size;
}

}  // namespace

void add_editor(CLI::App& app) {
  struct Options {
    StartOptions start;
    std::string size = "1600x900", script;
    std::vector<std::string> files;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("editor", "Opens the editor, like limber without a command, or plays a script in it");
  command->add_option("FILE", options->files, "volumes or a project to open");
  command->add_option("--size", options->size, "size of the window, WIDTHxHEIGHT in pixels")->capture_default_str();
  command->add_option("--scale", options->start.scale,
                      "size of texts and buttons, as a factor from 0.75 to 3 (default: the user's preference)");
  command->add_option("--theme", options->start.theme, "colour theme: dark or light (default: the user's preference)")
      ->check(CLI::IsMember({"dark", "light"}));
  command->add_option("--play", options->script, "script file of clicks and keys to play; no display is needed");
  command->callback([options] {
    options->start.size = size_of(options->size);
    options->start.script = options->script;
    options->start.files.assign(options->files.begin(), options->files.end());
    run_editor(options->start);
  });
}

}  // namespace limber::editor
