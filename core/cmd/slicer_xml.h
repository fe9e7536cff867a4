// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes a command in the XML of the Slicer Execution Model, made from the same options as --help. 3D Slicer, MITK
// and other programs show a form for such a description and run the command.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace limber::cmd {

// Returns the XML description of a command: "<?xml ...><executable> ...".
//   name  the words of the command, such as "resample"
std::string slicer_xml(CLI::App& command, const std::string& name);

// Returns the XML description that the command line "limber COMMAND --xml" requests. Empty if it does not request one.
std::string requested_slicer_xml(CLI::App& app, const std::vector<std::string>& words);

}  // namespace limber::cmd
