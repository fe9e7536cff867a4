// SPDX-License-Identifier: AGPL-3.0-or-later
// Knows which files a command line reads and writes. An option that names an output is marked where it is added. Every
// other value that names a file is an input. Before a command reads anything, one check refuses an output that is also
// an input, and two outputs that are one file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/file.h"

namespace limber::cmd {

struct OptionFiles {
  std::vector<Path> read, written;
};

// Returns the files that an option's value names. It is called after all options have been parsed.
using FilesOfValue = std::function<OptionFiles(const std::string& value)>;

// Marks an option whose value names an output. The output's files are those that `files` returns for this value.
// Without `files` they are the file of that name and those that a volume's format writes beside it.
CLI::Option* writes(CLI::Option* option, FilesOfValue files = {});

// Checks the files of a command whose options have been parsed. Throws UsageError for an output that is also an input
// or another output, and for an option whose number is "nan" or "inf".
//   job  another file that the command reads; "": none
void check_files(CLI::App& command, const Path& job = {});

// Makes every command of the app check its files before it runs.
void check_files_of_all(CLI::App& app);

}  // namespace limber::cmd
