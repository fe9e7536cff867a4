// SPDX-License-Identifier: AGPL-3.0-or-later
// The program's main function: opens the editor, or runs a subcommand of the command line.
#include <filesystem>

#include "core/cmd/command.h"
#include "core/cmd/experiment.h"
#include "core/cmd/program_commit.h"
#include "editor/app/main_loop.h"
#include "editor/cli/command.h"
#include "editor/files/study_pictures.h"

int main(int argc, char** argv) {
  CLI::App app("Limber changes the pose of labelled voxel anatomy. Without a command it opens the editor.", "limber");
  std::vector<std::string> files;
  app.add_option("FILE", files, "volumes or a project to open in the editor")->check([](const std::string& name) {
    // An argument without "." or "/" that names no file is most likely a misspelled command.
    const bool is_word = name.find_first_of("./") == std::string::npos;
    std::error_code unreadable;
    return is_word && !std::filesystem::exists(name, unreadable) ? "there is neither a command nor a file " + name
                                                                 : std::string();
  });
  app.require_subcommand(0, 1);
  limber::cmd::add_commands(app, limber::cmd::kProgramCommit);
  limber::cmd::add_experiment(app, limber::cmd::kProgramCommit, limber::editor::start_pictures);
  limber::editor::add_editor(app);
  limber::editor::add_guide(app);
  limber::editor::add_render(app);
  app.callback([&] {
    if (app.get_subcommands().empty()) limber::editor::run_editor({.files = {files.begin(), files.end()}});
  });
  return limber::cmd::run(app, argc, argv);
}
