// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of export targets: file formats of other programs in which a body can be written. `limber convert`, the
// editor's export and its file dialogs use the table. A new target needs one source file, which defines its row, and a
// line in exporter.cpp.
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
  std::vector<TissueMaterial> materials;  // one per tissue; filled only when Exporter::needs_frequency
  double frequency = 0;                   // Hz
  const TetMesh* mesh = nullptr;          // tet mesh whose regions are organ numbers (tet_phantom.h); null: none
  Progress& progress;
  std::vector<std::string>& warnings;  // the exporter appends messages to the user about what it wrote
};

struct Exporter {
  std::string name;                  // "openEMS boxes"
  std::vector<std::string> endings;  // ".xml"
  bool needs_frequency = false;
  bool takes_voxels = true;
  bool takes_mesh = false;  // writes ExportInput::mesh instead of the voxels when there is one

  // Returns the files that are written in addition to `path`; null: none.
  std::vector<Path> (*beside)(const Path& path) = nullptr;
  // Writes the body. Throws Error when a file cannot be written or the format cannot represent the body.
  void (*write)(const ExportInput& input, const Path& path) = nullptr;
};

std::span<const Exporter> exporters();
// Returns the exporter that has the file name's ending; null when none has it. Throws Error for .h5 and .hdf5 names
// that do not tell which program the file is for.
const Exporter* exporter_for(const Path& path);
// Returns `path` and all files that are written beside it. When write_export() fails, those of them that did not exist
// before are removed.
std::vector<Path> files_exported_as(const Exporter& exporter, const Path& path);
void write_export(const Exporter& exporter, const ExportInput& input, const Path& path);
// Returns the endings of all exporters that write voxels, as text: ".xml (openEMS boxes), ...".
std::string exporter_endings();

}  // namespace limber
