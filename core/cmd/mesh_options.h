// SPDX-License-Identifier: AGPL-3.0-or-later
// Tet meshes as outputs: the options of commands that mesh a body, the files they write, and the parts of a body that a
// solver's mesh contains.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/cmd/command_files.h"
#include "core/export/exporter.h"
#include "core/mesh/body_mesh.h"
#include "core/resample/fem_shape.h"

namespace limber::cmd {

struct MeshOptions {
  std::optional<double> spacing;  // distance between the nodes of a surface, mm; none: the voxel size
  int relaxations = BodyMeshSettings{}.relaxations;
  std::string unit = "mm";  // unit of the mesh's file: "mm" or "cm"
};

// Adds the options of a body's mesh: its spacing, its smoothing and its unit.
//   start  what the names of the options begin with, such as "--" or "--mesh-"
void add_mesh_options(CLI::App& command, MeshOptions& options, const std::string& start);

// Meshes the body. With a spacing, the body is sampled anew first, and its tissues keep their volumes. Warns of tissues
// that the mesh lacks or whose volume is off by more than 1 %.
//   tissue   the tissue voxels of the volume, with their seams
BodyMesh mesh_of(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                 const MeshOptions& options, Progress& progress);

// Writes a mesh whose regions are labels, in the format of the name's extension. The file gets organ numbers instead of
// labels (export/tet_phantom.h).
void write_mesh(TetMesh mesh, const LabelVolume& volume, const TissueTable& tissues, const std::string& unit,
                const std::string& name, Progress& progress);

// Returns the solver's posed mesh. The region of a tet is the label that fills most of it.
TetMesh solver_mesh(const FemShape& shape);
// Returns a sentence that says which percentage of the body's rest volume, and how many of its tissues, the tets of the
// solver's mesh contain.
std::string share_of_body(const TissueModel& model, const LabelVolume& body);

// Returns a warning that tets of a posed mesh are inside out.
std::string inside_out_warning(std::int64_t tets, const std::string& name);

// Returns the path of the mesh file: `name` itself if its extension is that of a mesh format, otherwise NAME.node
// (TetGen format).
Path mesh_path(const Path& name);
const Exporter& mesh_exporter(const Path& name);
// Returns all files that are written for a mesh of this name.
std::vector<Path> mesh_files(const Path& name);

}  // namespace limber::cmd
