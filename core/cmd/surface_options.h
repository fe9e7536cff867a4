// SPDX-License-Identifier: AGPL-3.0-or-later
// How tissues' surfaces are asked for on the command line, and written.
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
  std::vector<std::string> tissues;  // names or labels, as the volume's table has them; none: all
  LabelSurfaceSettings settings;
};

// Writes them and prints a line a tissue: triangles, vertices, Euler number, volume by mesh and by voxels.
//   throws Error for a tissue that is not there, or when a file cannot be written (none is left then)
void write_surfaces_of(const LabelVolume& volume, const TissueTable& tissues, const SurfaceChoice& choice,
                       const std::string& output, Progress& progress);

}  // namespace limber::cmd
