// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/simulation_export.h"

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/export/exporter.h"
#include "core/export/greedy_boxes.h"
#include "core/export/hdf5_file.h"
#include "core/prepare/prepare.h"

namespace limber {

namespace {

// Returns a unique name for each material, of letters, digits and underscores, which every program accepts.
std::vector<std::string> plain_names(const std::vector<TissueMaterial>& materials) {
  std::vector<std::string> names;
  std::set<std::string> used;
  for (const TissueMaterial& m : materials) {
    std::string name;
    for (const char c : m.name)
      name += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    if (!used.insert(name).second) used.insert(name += "_" + text_of(m.file_value));
    names.push_back(std::move(name));
  }
  return names;
}

// Returns, for each label 0 .. 65535, the index of its material in SimulationBody::materials; -1: air.
std::vector<int> material_of_label(const SimulationBody& body) {
  std::vector<int> of(65536, -1);
  for (std::size_t i = 0; i < body.materials.size(); ++i) of[body.materials[i].label] = static_cast<int>(i);
  return of;
}

// Returns the coordinates of the grid's voxel faces along an axis, ascending, mm.
std::vector<double> faces(const Grid& grid, int axis) {
  const double first = glm::dot(grid.direction[axis], grid.origin) - grid.spacing[axis] / 2;
  std::vector<double> lines;
  for (int i = 0; i <= grid.size[axis]; ++i) lines.push_back(first + i * grid.spacing[axis]);
  return lines;
}

std::string comma_separated(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ",") + text_of(number);
  return text;
}

std::string point(const char* name, const std::array<std::vector<double>, 3>& lines, const glm::ivec3& corner) {
  return std::string("<") + name + " X=\"" + text_of(lines[0][corner.x]) + "\" Y=\"" + text_of(lines[1][corner.y]) +
         "\" Z=\"" + text_of(lines[2][corner.z]) + "\"/>";
}

}  // namespace

Path beside(const Path& path, const std::string& end) {
  std::string stem = path.string();
  for (const char* extension : {".gprmax.h5", ".dat"})
    if (lower_case(stem).ends_with(extension)) stem.resize(stem.size() - std::string_view(extension).size());
  return stem + end;
}

LabelVolume turned_to_lps(const LabelVolume& volume, std::vector<std::string>& warnings) {
  LabelVolume turned = reorient(volume, "LPS");
  double off = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) off = std::max(off, std::abs(turned.grid.direction[axis][i] - (i == axis)));
  if (off > 1e-6)
    warnings.push_back("the grid is oblique: the coordinates run along the voxel axes, not along the axes L, P and S");
  return turned;
}

std::string openems_xml(const SimulationBody& body) {
  const std::vector<int> material_of = material_of_label(body);
  const std::array<std::vector<double>, 3> lines = {faces(body.volume.grid, 0), faces(body.volume.grid, 1),
                                                    faces(body.volume.grid, 2)};
  std::vector<std::string> boxes(body.materials.size());
  for (const LabelBox& box : greedy_boxes(body.volume))
    boxes[material_of[box.label]] +=
        "          <Box Priority=\"1\">" + point("P1", lines, box.low) + point("P2", lines, box.high) + "</Box>\n";

  const std::vector<std::string> names = plain_names(body.materials);
  const std::string frequency = text_of(body.frequency);
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<openEMS>\n  <FDTD NumberOfTimesteps=\"100000\" "
      "endCriteria=\"1e-5\" f_max=\"" +
      text_of(1.5 * body.frequency) + "\">\n    <Excitation Type=\"0\" f0=\"" + frequency + "\" fc=\"" +
      text_of(body.frequency / 2) +
      "\"/>\n    <BoundaryCond xmin=\"2\" xmax=\"2\" ymin=\"2\" ymax=\"2\" zmin=\"2\" zmax=\"2\"/>\n  </FDTD>\n"
      "  <ContinuousStructure CoordSystem=\"0\">\n    <RectilinearGrid DeltaUnit=\"0.001\" CoordSystem=\"0\">\n";
  for (int axis = 0; axis < 3; ++axis) {
    const std::string tag = std::string(1, "XYZ"[axis]) + "Lines";
    text += "      <" + tag + ">" + comma_separated(lines[axis]) + "</" + tag + ">\n";
  }
  text += "    </RectilinearGrid>\n    <Properties>\n";
  for (std::size_t i = 0; i < body.materials.size(); ++i) {
    const TissueMaterial& m = body.materials[i];
    text += "      <Material Name=\"" + names[i] + "\" Isotropy=\"1\">\n        <Property Epsilon=\"" +
            text_of(m.dielectric.permittivity) + "\" Kappa=\"" + text_of(m.dielectric.conductivity) + "\" Density=\"" +
            text_of(m.density) + "\"/>\n        <Primitives>\n" + boxes[i] +
            "        </Primitives>\n      </Material>\n";
  }
  return text + "    </Properties>\n  </ContinuousStructure>\n</openEMS>\n";
}

void write_openems(const SimulationBody& body, const Path& path) { write_file_atomically(path, openems_xml(body)); }

void write_disc_material(const SimulationBody& body, const Path& path) {
  if (body.materials.size() > 254)
    throw Error(
        "a DiscMaterial file holds at most 254 materials, this volume has " + std::to_string(body.materials.size()),
        path.string(), "merge labels with `limber prepare --merge`");
  // Material 0 is the background: vacuum.
  std::vector<float> permittivity = {1}, conductivity = {0}, density = {0};
  std::string names = "background";
  for (const TissueMaterial& m : body.materials) {
    permittivity.push_back(static_cast<float>(m.dielectric.permittivity));
    conductivity.push_back(static_cast<float>(m.dielectric.conductivity));
    density.push_back(static_cast<float>(m.density));
  }
  for (const std::string& name : plain_names(body.materials)) names += "," + name;
  const std::vector<int> material_of = material_of_label(body);
  std::vector<std::uint8_t> index(body.volume.voxels.size());
  for (std::size_t i = 0; i < index.size(); ++i)
    index[i] = static_cast<std::uint8_t>(material_of[body.volume.voxels[i]] + 1);

  const Grid& grid = body.volume.grid;
  Hdf5File file;
  file.data("/DiscData", index, {grid.size.z, grid.size.y, grid.size.x});
  file.attribute("/DiscData", "DB_Size", std::int32_t(permittivity.size()));
  file.attribute("/DiscData", "epsR", permittivity);
  file.attribute("/DiscData", "kappa", conductivity);
  file.attribute("/DiscData", "density", density);
  file.attribute("/DiscData", "Name", names);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> metres;
    for (const double mm : faces(grid, axis)) metres.push_back(static_cast<float>(mm / 1000));
    file.data(std::string("/mesh/") + "xyz" [axis], metres, { std::ssize(metres) });
  }
  file.attribute("/", "Version", 2.0);
  file.write(path);
}

void write_gprmax(const SimulationBody& body, const Path& path) {
  const Grid& grid = body.volume.grid;
  const std::vector<std::string> names = plain_names(body.materials);
  std::string text = "## relative permittivity, conductivity (S/m), relative permeability, magnetic loss, name; at " +
                     text_of(body.frequency) + " Hz\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const TissueMaterial& m = body.materials[i];
    text += "## " + names[i] + ": " + m.row + " (" + m.found + "), density " + text_of(m.density) +
            " kg/m3; properties of " + m.properties + "; " + m.source +
            "\n#material: " + text_of(m.dielectric.permittivity) + " " + text_of(m.dielectric.conductivity) + " 1 0 " +
            names[i] + "\n";
  }
  // In gprMax's files z varies fastest. At a voxel with index -1 (air), gprMax leaves the material of the user's model
  // unchanged.
  const std::vector<int> material_of = material_of_label(body);
  std::vector<std::int16_t> index;
  index.reserve(body.volume.voxels.size());
  for (int x = 0; x < grid.size.x; ++x)
    for (int y = 0; y < grid.size.y; ++y)
      for (int z = 0; z < grid.size.z; ++z)
        index.push_back(static_cast<std::int16_t>(material_of[body.volume.voxels[grid.index({x, y, z})]]));

  Hdf5File file;
  file.data("/data", index, {grid.size.x, grid.size.y, grid.size.z});
  file.attribute("/", "dx_dy_dz",
                 std::vector<double>{grid.spacing.x / 1000, grid.spacing.y / 1000, grid.spacing.z / 1000});
  file.attribute("/", "title", "Limber: " + path.filename().string());
  file.write(path);
  write_file_atomically(beside(path, "_materials.txt"), text);
}

namespace {

SimulationBody body_of(const ExportInput& input) {
  return {turned_to_lps(input.volume, input.warnings), input.materials, input.frequency};
}

}  // namespace

Exporter openems_exporter() {
  return {.name = "openEMS boxes",
          .endings = {".xml"},
          .needs_frequency = true,
          .write = [](const ExportInput& input, const Path& path) { write_openems(body_of(input), path); }};
}

Exporter disc_material_exporter() {
  return {.name = "CSXCAD DiscMaterial",
          .endings = {".csxcad.h5"},
          .needs_frequency = true,
          .write = [](const ExportInput& input, const Path& path) { write_disc_material(body_of(input), path); }};
}

Exporter gprmax_exporter() {
  return {.name = "gprMax geometry",
          .endings = {".gprmax.h5"},
          .needs_frequency = true,
          .beside = [](const Path& path) { return std::vector<Path>{beside(path, "_materials.txt")}; },
          .write = [](const ExportInput& input, const Path& path) { write_gprmax(body_of(input), path); }};
}

}  // namespace limber
