// SPDX-License-Identifier: AGPL-3.0-or-later
// Bodies as other programs take them, as one table: `limber convert`, the editor's export and its file dialogs read it.
// A new target is one source that makes its row, and that row's line in exporter.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/mesh/tet_mesh.h"
#include "core/tissue/dielectric.h"
#include "core/volume/label_volume.h"

namespace limber {

struct ExportInput {
  const LabelVolume& volume;
  const TissueTable& tissues;
  std::vector<TissueMaterial> materials;  // of every tissue, where the exporter needs a frequency
  double frequency = 0;                   // Hz
  const TetMesh* mesh = nullptr;          // regions are organ numbers (tet_phantom.h); null where there is none
  Progress& progress;
  std::vector<std::string>& warnings;  // what the user should know of what was written
};

struct Exporter {
  std::string name;                  // "openEMS boxes"
  std::vector<std::string> endings;  // ".xml"
  bool needs_frequency = false;
  bool takes_voxels = true;
  bool takes_mesh = false;  // in place of the voxels, where there is a mesh

  // What is written beside `path`. Null: nothing.
  std::vector<Path> (*beside)(const Path& path) = nullptr;
  // Throws Error when a file cannot be written, or cannot hold the body.
  void (*write)(const ExportInput& input, const Path& path) = nullptr;
};

std::span<const Exporter> exporters();
// By the name, null for none. Throws Error where a name does not say enough.
const Exporter* exporter_for(const Path& path);
// The file and all that comes with it; after a failure none of it is left.
std::vector<Path> files_exported_as(const Exporter& exporter, const Path& path);
void write_export(const Exporter& exporter, const ExportInput& input, const Path& path);
// ".xml (openEMS boxes), ...": of all that take voxels.
std::string exporter_endings();

}  // namespace limber
