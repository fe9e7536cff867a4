// SPDX-License-Identifier: AGPL-3.0-or-later
// What commands are told of tissues' materials: [--tissues T] [--frequency HZ] [--properties P.csv].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/tissue/dielectric.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

struct MaterialOptions {
  std::string tissues, properties;  // files
  std::optional<double> frequency;  // Hz
};

// Returns the option --frequency. `options` must live as long as the command.
CLI::Option* add_material_options(CLI::App& command, MaterialOptions& options);

// What the file says of its labels, completed by the user's table where one is given.
TissueTable tissues_of(const VolumeFile& file, const std::string& table);

// Of every tissue of the table. Throws Error without a frequency, and where one has no properties: `where` is the file.
std::vector<TissueMaterial> materials_of(const TissueTable& tissues, const MaterialOptions& options,
                                         const std::string& where);

std::string joined(const std::vector<std::string>& names);  // "a, b, c"

}  // namespace limber::cmd
