// SPDX-License-Identifier: AGPL-3.0-or-later
// The program: the editor, or with a subcommand the command line.
#include "core/cmd/command.h"
#include "editor/commands/command.h"

int main(int argc, char** argv) {
  CLI::App app("Limber changes the pose of labelled voxel anatomy.", "limber");
  app.require_subcommand(1);
  limber::cmd::add_commands(app);
  limber::editor::add_render(app);
  return limber::cmd::run(app, argc, argv);
}
