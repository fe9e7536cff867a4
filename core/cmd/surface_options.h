// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the surfaces of the tissues that the options of a command select.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/progress.h"
#include "core/mesh/label_surfaces.h"
#include "core/tissue/tissue_table.h"

namespace limber::cmd {

void add_surfaces(CLI::App& app);

struct SurfaceChoice {
  std::vector<std::string> tissues;  // names or labels in the volume's tissue table; empty: all tissues
  LabelSurfaceSettings settings;
};

// Writes the surfaces and prints one line for each tissue: triangles, vertices, Euler number, volume of the mesh and
// volume of the voxels. Throws Error for an unknown tissue or if a file cannot be written, and then leaves no file.
void write_surfaces_of(const LabelVolume& volume, const TissueTable& tissues, const SurfaceChoice& choice,
                       const std::string& output, Progress& progress);

}  // namespace limber::cmd
