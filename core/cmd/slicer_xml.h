// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes a command in the XML of the Slicer Execution Model, from the same options as --help. 3D Slicer, MITK and
// other programs that know it make a form of the description and run the command.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace limber::cmd {

// Returns the description of a command: "<?xml ...><executable> ...".
//   name  the words of the command, as in "resample"
std::string slicer_xml(CLI::App& command, const std::string& name);

// Returns the description that a command line "limber COMMAND --xml" asks for. Empty if it asks for none.
std::string requested_slicer_xml(CLI::App& app, const std::vector<std::string>& words);

}  // namespace limber::cmd
