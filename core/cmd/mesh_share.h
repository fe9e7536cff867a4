// SPDX-License-Identifier: AGPL-3.0-or-later
// FEM meshes as outputs: their files, and how much of the body a mesh contains, so that the user does not take it for
// the whole body.
#pragma once

#include <string>

#include "core/base/file.h"
#include "core/export/exporter.h"
#include "core/fem/tissue_model.h"
#include "core/volume/label_volume.h"

namespace limber::cmd {

// Returns a sentence that says which percentage of the body's rest volume, and how many of its tissues, the tets of the
// mesh contain.
std::string share_of_body(const TissueModel& model, const LabelVolume& body);

// Returns the path of the mesh file: `name` itself if its extension is that of a mesh format, otherwise NAME.node
// (TetGen format).
Path mesh_path(const Path& name);
const Exporter& mesh_exporter(const Path& name);

}  // namespace limber::cmd
