// SPDX-License-Identifier: AGPL-3.0-or-later
// The surfaces of tissues on the command line: chooses the tissues and writes the files.
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
// volume of the voxels. Throws Error for an unknown tissue, or when a file cannot be written; then no file is left.
void write_surfaces_of(const LabelVolume& volume, const TissueTable& tissues, const SurfaceChoice& choice,
                       const std::string& output, Progress& progress);

}  // namespace limber::cmd
