// SPDX-License-Identifier: AGPL-3.0-or-later
// The files of a command line. An option that names what is written says so where it is added; every other word that
// names a file is one that is read. From that, one check for all commands refuses an output that is also an input, or
// two outputs that are one file, before anything is read.
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

// Of an option's value. Called when all options are parsed.
using FilesOfValue = std::function<OptionFiles(const std::string& value)>;

// Marks an option whose value names what the command writes: the file of that name and what a volume of that name puts
// beside it, or the `files` that it tells of.
CLI::Option* writes(CLI::Option* option, FilesOfValue files = {});

// Throws UsageError for a command whose options are parsed, also where an option is given "nan" or "inf" as a number.
// `job`: a file that is read besides, "" for none.
void check_files(CLI::App& command, const Path& job = {});

// Every command of the program has its files checked before it runs.
void check_files_of_all(CLI::App& app);

}  // namespace limber::cmd
