// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/tetgen_files.h"

#include <charconv>

#include "core/base/error.h"
#include "core/export/exporter.h"
#include "core/export/tet_phantom.h"

namespace limber {

namespace {

class Text {
 public:
  template <class Value>
  Text& operator<<(Value value) {
    char digits[40];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    return *this;
  }
  Text& operator<<(const char* words) {
    text_ += words;
    return *this;
  }
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

void write_tetgen_files(const Path& name, const TetMesh& mesh) {
  Path stem = name;
  if (stem.extension() == ".node" || stem.extension() == ".ele") stem.replace_extension();
  Text nodes, tets;
  nodes << mesh.V.rows() << " 3 0 0\n";
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    nodes << i << " " << mesh.V(i, 0) << " " << mesh.V(i, 1) << " " << mesh.V(i, 2) << "\n";
  tets << mesh.T.rows() << " 4 1\n";
  for (Eigen::Index i = 0; i < mesh.T.rows(); ++i) {
    tets << i;
    for (const int corner : mesh.T.row(i)) tets << " " << corner;
    tets << " " << int(mesh.region[i]) << "\n";
  }
  write_file_atomically(stem.string() + ".node", nodes.str());
  write_file_atomically(stem.string() + ".ele", tets.str());
}

Exporter tetgen_exporter() {
  return {.name = "TetGen mesh",
          .endings = {".node"},
          .takes_voxels = false,
          .takes_mesh = true,
          .beside =
              [](const Path& path) {
                return std::vector<Path>{Path(path).replace_extension(".ele"),
                                         Path(path).replace_extension(".material"),
                                         Path(path).replace_filename("colour.dat")};
              },
          .write =
              [](const ExportInput& input, const Path& path) {
                write_tetgen_files(path, *input.mesh);
                write_file_atomically(Path(path).replace_filename("colour.dat"),
                                      colour_list(input.tissues, input.mesh->region));
                const Path materials = Path(path).replace_extension(".material");
                std::string list;
                try {
                  list = material_list(input.tissues, input.mesh->region, read_composition_table(), materials.string());
                } catch (const Error& error) {
                  input.warnings.push_back(std::string("There is no list of materials: ") + error.what());
                  return;
                }
                write_file_atomically(materials, list);
              }};
}

}  // namespace limber
