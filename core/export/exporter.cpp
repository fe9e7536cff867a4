// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/exporter.h"

#include "core/base/error.h"
#include "core/base/output_files.h"
#include "core/base/text_parse.h"

namespace limber {

// Each function returns the row of exporters() for one export target, and is defined in the target's own source file.
Exporter surface_exporter();
Exporter openems_exporter();
Exporter disc_material_exporter();
Exporter gprmax_exporter();
Exporter icrp_slices_exporter();
Exporter tetgen_exporter();
Exporter vtu_exporter();
Exporter abaqus_exporter();

std::span<const Exporter> exporters() {
  static const std::vector<Exporter> kExporters = {
      surface_exporter(),     openems_exporter(), disc_material_exporter(), gprmax_exporter(),
      icrp_slices_exporter(), tetgen_exporter(),  vtu_exporter(),           abaqus_exporter(),
  };
  return kExporters;
}

const Exporter* exporter_for(const Path& path) {
  const std::string name = lower_case(path.filename().string());
  for (const Exporter& exporter : exporters())
    for (const std::string& ending : exporter.endings)
      if (name.ends_with(ending) && name.size() > ending.size()) return &exporter;
  if (name.ends_with(".h5") || name.ends_with(".hdf5"))
    throw Error("the file name does not tell which program the HDF5 file is for", path.string(),
                "end the name in .csxcad.h5 or .gprmax.h5");
  return nullptr;
}

std::vector<Path> files_exported_as(const Exporter& exporter, const Path& path) {
  std::vector<Path> files{path};
  if (exporter.beside)
    for (Path& beside : exporter.beside(path)) files.push_back(std::move(beside));
  return files;
}

void write_export(const Exporter& exporter, const ExportInput& input, const Path& path) {
  Outputs outputs;
  outputs.expect(files_exported_as(exporter, path));
  exporter.write(input, path);
  outputs.complete();
}

std::string exporter_endings() {
  std::string all;
  for (const Exporter& exporter : exporters()) {
    if (!exporter.takes_voxels) continue;
    for (const std::string& ending : exporter.endings)
      all += (all.empty() ? "" : &ending == &exporter.endings.front() ? ", " : " ") + ending;
    all += " (" + exporter.name + ")";
  }
  return all;
}

}  // namespace limber
