// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of export targets: file formats of other programs in which a body can be written. `limber convert` and the
// editor's export dialogs use the table. A new target needs one source file, which defines its row of the table, and a
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
  std::vector<TissueMaterial> materials;  // materials of the tissues; empty unless Exporter::needs_frequency
  double frequency = 0;                   // frequency of the field to simulate, Hz
  const TetMesh* mesh = nullptr;          // tet mesh whose regions are organ numbers (tet_phantom.h); null: none
  Progress& progress;
  std::vector<std::string>& warnings;  // the exporter appends warnings for the user
};

struct Exporter {
  std::string name;                  // for example "openEMS boxes"
  std::vector<std::string> endings;  // file endings, for example ".xml"
  bool needs_frequency = false;
  bool takes_voxels = true;
  bool takes_mesh = false;  // true: a mesh in ExportInput::mesh is written instead of the voxels

  // Returns the files that are written in addition to `path`. Null: there are no such files.
  std::vector<Path> (*beside)(const Path& path) = nullptr;
  // Writes the body. Throws Error when a file cannot be written or the format cannot represent the body.
  void (*write)(const ExportInput& input, const Path& path) = nullptr;
};

std::span<const Exporter> exporters();
// Returns the exporter for the ending of a file name; null: there is none. Throws Error for names in .h5 and .hdf5
// whose ending does not tell which program the file is for.
const Exporter* exporter_for(const Path& path);
// Returns the paths of all files that write_export() writes: `path` and the files beside it. If write_export() fails,
// it removes those files that did not exist before.
std::vector<Path> files_exported_as(const Exporter& exporter, const Path& path);
void write_export(const Exporter& exporter, const ExportInput& input, const Path& path);
// Returns text with the file endings of all exporters that write voxels: ".xml (openEMS boxes), ...".
std::string exporter_endings();

}  // namespace limber
