// SPDX-License-Identifier: AGPL-3.0-or-later
// The program without the editor: it has subcommands only.
#include "core/cmd/command.h"
#include "core/cmd/experiment.h"
#include "core/cmd/program_commit.h"

int main(int argc, char** argv) {
  CLI::App app("Limber changes the pose of labelled voxel anatomy.", "limber");
  app.require_subcommand(1);
  limber::cmd::add_commands(app, limber::cmd::kProgramCommit);
  limber::cmd::add_experiment(app, limber::cmd::kProgramCommit);
  return limber::cmd::run(app, argc, argv);
}
