// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deck/decks.h"

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "core/base/outputs.h"
#include "core/deck/greedy_boxes.h"
#include "core/deck/hdf5_file.h"
#include "core/volume/header_text.h"
#include "core/volume/prepare.h"

namespace limber {

namespace {

Path beside(const Path& path, const std::string& end) {
  std::string stem = path.string();
  for (const char* extension : {".gprmax.h5", ".dat"})
    if (lower_case(stem).ends_with(extension)) stem.resize(stem.size() - std::string_view(extension).size());
  return stem + end;
}

// Names that every program takes: letters, digits and underscores, each once.
std::vector<std::string> plain_names(const std::vector<TissueMaterial>& materials) {
  std::vector<std::string> names;
  std::set<std::string> used;
  for (const TissueMaterial& m : materials) {
    std::string name;
    for (const char c : m.name) name += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    if (!used.insert(name).second) used.insert(name += "_" + text_of(m.file_value));
    names.push_back(std::move(name));
  }
  return names;
}

// Place of each label in the materials; -1 of air.
std::vector<int> material_of_label(const Deck& deck) {
  std::vector<int> of(65536, -1);
  for (std::size_t i = 0; i < deck.materials.size(); ++i) of[deck.materials[i].label] = static_cast<int>(i);
  return of;
}

// Voxel faces along an axis, mm.
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
  return std::string("<") + name + " X=\"" + text_of(lines[0][corner.x]) + "\" Y=\"" + text_of(lines[1][corner.y]) + "\" Z=\"" + text_of(lines[2][corner.z]) + "\"/>";
}

}  // namespace

DeckFormat deck_format(const Path& path) {
  const std::string name = lower_case(path.filename().string());
  const auto ends = [&](std::string_view end) { return name.ends_with(end) && name.size() > end.size(); };
  if (ends(".xml")) return DeckFormat::OpenEms;
  if (ends(".csxcad.h5")) return DeckFormat::DiscMaterial;
  if (ends(".gprmax.h5")) return DeckFormat::GprMax;
  if (ends(".dat")) return DeckFormat::IcrpSlices;
  if (ends(".h5") || ends(".hdf5")) throw Error("the name does not say whose HDF5 this is", path.string(), "end it in .csxcad.h5 or .gprmax.h5");
  return DeckFormat::None;
}

bool needs_frequency(DeckFormat format) { return format != DeckFormat::None && format != DeckFormat::IcrpSlices; }

std::vector<Path> companions(DeckFormat format, const Path& path) {
  if (format == DeckFormat::GprMax) return {beside(path, "_materials.txt")};
  if (format == DeckFormat::IcrpSlices) return {beside(path, "_organs.dat"), beside(path, "_media.dat")};
  return {};
}

LabelVolume deck_volume(const LabelVolume& volume, std::vector<std::string>& warnings) {
  LabelVolume turned = reorient(volume, "LPS");
  double off = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) off = std::max(off, std::abs(turned.grid.direction[axis][i] - (i == axis)));
  if (off > 1e-6) warnings.push_back("the grid is oblique: coordinates run along the voxel axes, not along L, P, S");
  return turned;
}

std::string openems_xml(const Deck& deck) {
  const std::vector<int> material_of = material_of_label(deck);
  const std::array<std::vector<double>, 3> lines = {faces(deck.volume.grid, 0), faces(deck.volume.grid, 1), faces(deck.volume.grid, 2)};
  std::vector<std::string> boxes(deck.materials.size());
  for (const LabelBox& box : greedy_boxes(deck.volume))
    boxes[material_of[box.label]] += "          <Box Priority=\"1\">" + point("P1", lines, box.low) + point("P2", lines, box.high) + "</Box>\n";

  const std::vector<std::string> names = plain_names(deck.materials);
  const std::string frequency = text_of(deck.frequency);
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<openEMS>\n  <FDTD NumberOfTimesteps=\"100000\" endCriteria=\"1e-5\" f_max=\"" + text_of(1.5 * deck.frequency) +
                     "\">\n    <Excitation Type=\"0\" f0=\"" + frequency + "\" fc=\"" + text_of(deck.frequency / 2) +
                     "\"/>\n    <BoundaryCond xmin=\"2\" xmax=\"2\" ymin=\"2\" ymax=\"2\" zmin=\"2\" zmax=\"2\"/>\n  </FDTD>\n"
                     "  <ContinuousStructure CoordSystem=\"0\">\n    <RectilinearGrid DeltaUnit=\"0.001\" CoordSystem=\"0\">\n";
  for (int axis = 0; axis < 3; ++axis) {
    const std::string tag = std::string(1, "XYZ"[axis]) + "Lines";
    text += "      <" + tag + ">" + comma_separated(lines[axis]) + "</" + tag + ">\n";
  }
  text += "    </RectilinearGrid>\n    <Properties>\n";
  for (std::size_t i = 0; i < deck.materials.size(); ++i) {
    const TissueMaterial& m = deck.materials[i];
    text += "      <Material Name=\"" + names[i] + "\" Isotropy=\"1\">\n        <Property Epsilon=\"" + text_of(m.dielectric.permittivity) + "\" Kappa=\"" +
            text_of(m.dielectric.conductivity) + "\" Density=\"" + text_of(m.density) + "\"/>\n        <Primitives>\n" + boxes[i] + "        </Primitives>\n      </Material>\n";
  }
  return text + "    </Properties>\n  </ContinuousStructure>\n</openEMS>\n";
}

void write_openems(const Deck& deck, const Path& path) { write_file_atomically(path, openems_xml(deck)); }

void write_disc_material(const Deck& deck, const Path& path) {
  if (deck.materials.size() > 254) throw Error("DiscMaterial holds 254 materials, this volume has " + std::to_string(deck.materials.size()), path.string(), "merge labels with `limber prepare --merge`");
  // Material 0 is the background, vacuum.
  std::vector<float> permittivity = {1}, conductivity = {0}, density = {0};
  std::string names = "background";
  for (const TissueMaterial& m : deck.materials) {
    permittivity.push_back(static_cast<float>(m.dielectric.permittivity));
    conductivity.push_back(static_cast<float>(m.dielectric.conductivity));
    density.push_back(static_cast<float>(m.density));
  }
  for (const std::string& name : plain_names(deck.materials)) names += "," + name;
  const std::vector<int> material_of = material_of_label(deck);
  std::vector<std::uint8_t> index(deck.volume.voxels.size());
  for (std::size_t i = 0; i < index.size(); ++i) index[i] = static_cast<std::uint8_t>(material_of[deck.volume.voxels[i]] + 1);

  const Grid& grid = deck.volume.grid;
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
    file.data(std::string("/mesh/") + "xyz"[axis], metres, {std::ssize(metres)});
  }
  file.attribute("/", "Version", 2.0);
  file.write(path);
}

void write_gprmax(const Deck& deck, const Path& path) {
  const Grid& grid = deck.volume.grid;
  const std::vector<std::string> names = plain_names(deck.materials);
  std::string text = "## relative permittivity, conductivity (S/m), relative permeability, magnetic loss, name; at " + text_of(deck.frequency) + " Hz\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const TissueMaterial& m = deck.materials[i];
    text += "## " + names[i] + ": " + m.row + " (" + m.found + "), density " + text_of(m.density) +
            " kg/m3; properties of " + m.properties + "; " + m.source + "\n#material: " + text_of(m.dielectric.permittivity) + " " +
            text_of(m.dielectric.conductivity) + " 1 0 " + names[i] + "\n";
  }
  // z fastest; -1 leaves what is there.
  const std::vector<int> material_of = material_of_label(deck);
  std::vector<std::int16_t> index;
  index.reserve(deck.volume.voxels.size());
  for (int x = 0; x < grid.size.x; ++x)
    for (int y = 0; y < grid.size.y; ++y)
      for (int z = 0; z < grid.size.z; ++z) index.push_back(static_cast<std::int16_t>(material_of[deck.volume.voxels[grid.index({x, y, z})]]));

  Hdf5File file;
  file.data("/data", index, {grid.size.x, grid.size.y, grid.size.z});
  file.attribute("/", "dx_dy_dz", std::vector<double>{grid.spacing.x / 1000, grid.spacing.y / 1000, grid.spacing.z / 1000});
  file.attribute("/", "title", "Limber: " + path.filename().string());
  file.write(path);
  write_file_atomically(companions(DeckFormat::GprMax, path).front(), text);
}

void write_deck(const LabelVolume& volume, const TissueTable& tissues, std::vector<TissueMaterial> materials, double frequency, const Path& path, std::vector<std::string>& warnings) {
  const DeckFormat format = deck_format(path);
  const Deck deck{deck_volume(volume, warnings), std::move(materials), frequency};
  Outputs outputs;
  outputs.expect({path});
  outputs.expect(companions(format, path));
  if (format == DeckFormat::OpenEms) write_openems(deck, path);
  if (format == DeckFormat::DiscMaterial) write_disc_material(deck, path);
  if (format == DeckFormat::GprMax) write_gprmax(deck, path);
  if (format == DeckFormat::IcrpSlices) write_icrp_slices(deck.volume, tissues, read_composition_table(), path);
  outputs.complete();
}

}  // namespace limber
