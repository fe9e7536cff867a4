// SPDX-License-Identifier: AGPL-3.0-or-later
// The options for the materials of tissues: [--tissues T] [--frequency HZ] [--properties P.csv].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/tissue/dielectric.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

struct MaterialOptions {
  std::string tissues, properties;  // names of the files with the tissue table and the property table
  std::optional<double> frequency;  // frequency of the dielectric properties, Hz
};

// Adds the options for materials and returns the option --frequency. `options` must live as long as the command.
CLI::Option* add_material_options(CLI::App& command, MaterialOptions& options);

// Returns the tissue table of a volume's file. If `table` names a tissue table's file, values in that file take
// precedence.
TissueTable tissues_of(const VolumeFile& file, const std::string& table);

// Returns the material of every tissue. Throws Error without a frequency, and for a tissue without properties.
//   where  name of the volume's file, for messages
std::vector<TissueMaterial> materials_of(const TissueTable& tissues, const MaterialOptions& options,
                                         const std::string& where);

std::string joined(const std::vector<std::string>& names);  // returns the names separated by commas: "a, b, c"

}  // namespace limber::cmd
