// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which files a command line reads and writes. Options that name outputs are marked as such by writes(). Every
// other value that names an existing file is an input. Before a command reads anything, check_files() refuses an output
// that is also an input, and two outputs that are one file.
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

// Marks an option whose value names an output, and returns the option. The function `files` returns the files that are
// read and written for a value. Without `files`, these are the file with this name and, for a volume, the files that
// its format writes beside it.
CLI::Option* writes(CLI::Option* option, FilesOfValue files = {});

// Returns whether the option was marked by writes().
bool names_outputs(CLI::Option& option);

// Checks the files of a command whose options have been parsed. Throws UsageError for an output that is also an input
// or another output, and for an option whose number is "nan" or "inf".
//   job  the job file (job.cpp) that contains the command, which also counts as an input; "": none
void check_files(CLI::App& command, const Path& job = {});

// Makes every command of the app check its files before it runs.
void check_files_of_all(CLI::App& app);

}  // namespace limber::cmd
