// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a tet mesh as an Abaqus input file (.inp) that MCNP6 reads as an unstructured mesh [MCNP Code Version 6.3
// Theory and User Manual, section 8.7]: one part with nodes, elements of type C3D4 and, for each organ, a material set
// and a statistic set whose names end in the organ's number; then one instance of the part, and a material with its
// density, g/cm3, for each organ. Abaqus, Gmsh and meshio read the same file. Coordinates are in the unit of the mesh;
// MCNP takes them as cm.
#include <charconv>

#include "core/base/file.h"
#include "core/base/text_parse.h"
#include "core/export/exporter.h"
#include "core/export/tet_phantom.h"

namespace limber {

namespace {

constexpr int kPerLine = 16;  // numbers in a line of a set, the most that Abaqus allows

std::string set_name(const std::string& name, std::uint16_t organ) {
  std::string word;
  for (const char c : name)
    word += (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ? c : '_';
  if (word.size() > 40) word.resize(40);
  return (word.empty() ? "organ" : word) + "_" + std::to_string(organ);
}

void append(std::string& text, const std::vector<Eigen::Index>& elements) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    text += std::to_string(elements[i]);
    text += i + 1 == elements.size() || (i + 1) % kPerLine == 0 ? "\n" : ", ";
  }
}

std::string abaqus_text(const TetMesh& mesh, const TissueTable& tissues) {
  std::string text = "*Heading\n body of Limber\n*Part, name=body\n*Node\n";
  char digits[40];
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    text += std::to_string(v + 1);
    for (int axis = 0; axis < 3; ++axis) {
      text += ", ";
      text.append(digits, std::to_chars(digits, digits + sizeof digits, mesh.V(v, axis)).ptr);
    }
    text += "\n";
  }
  text += "*Element, type=C3D4\n";
  std::vector<std::vector<Eigen::Index>> elements(65536);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    text += std::to_string(t + 1);
    for (const int node : mesh.T.row(t)) text += ", " + std::to_string(node + 1);
    text += "\n";
    elements[mesh.region[t]].push_back(t + 1);
  }
  std::string materials;
  for (const Tissue& tissue : tissues.tissues) {
    std::vector<Eigen::Index>& own = elements[organ_number(tissue)];
    if (own.empty()) continue;
    const std::string name = set_name(tissue.name, organ_number(tissue));
    text += "*Elset, elset=Set-material_" + name + "\n";
    append(text, own);
    text += "*Elset, elset=Set-statistic_" + name + "\n";
    append(text, own);
    materials += "*Material, name=" + name + "\n*Density\n" + text_of(tissue.density) + ",\n";
    own.clear();
  }
  return text +
         "*End Part\n*Assembly, name=Assembly\n*Instance, name=body-1, part=body\n*End Instance\n*End Assembly\n" +
         materials;
}

}  // namespace

Exporter abaqus_exporter() {
  return {.name = "Abaqus input for MCNP",
          .endings = {".inp"},
          .takes_voxels = false,
          .takes_mesh = true,
          .write = [](const ExportInput& input, const Path& path) {
            write_file_atomically(path, abaqus_text(*input.mesh, input.tissues));
          }};
}

}  // namespace limber
