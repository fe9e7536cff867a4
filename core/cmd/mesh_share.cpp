// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/mesh_share.h"

#include <cstdio>
#include <set>

namespace limber::cmd {

std::string share_of_body(const TissueModel& model, const LabelVolume& body) {
  std::set<Label> in_mesh, in_body;
  double mm3 = 0, all_mm3 = 0;
  for (const auto& part : model.parts)
    if (part.label != 0) mm3 += part.mm3, in_mesh.insert(part.label);
  for (const Label label : body.voxels)
    if (label != 0) all_mm3 += body.grid.voxel_volume(), in_body.insert(label);
  char text[240];
  std::snprintf(text, sizeof text,
                "the mesh contains only the soft tissue that bends: %.1f %% of the body's volume and %zu of its %zu "
                "tissues; rigid and unbent parts are missing, and each tet has one tissue",
                100 * mm3 / all_mm3, in_mesh.size(), in_body.size());
  return text;
}

Path mesh_path(const Path& name) {
  if (name.extension() == ".ele") return Path(name).replace_extension(".node");
  const Exporter* exporter = exporter_for(name);
  return exporter && exporter->takes_mesh ? name : Path(name.string() + ".node");
}

const Exporter& mesh_exporter(const Path& name) { return *exporter_for(mesh_path(name)); }

}  // namespace limber::cmd
