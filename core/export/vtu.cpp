// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes VTK's XML unstructured grid (.vtu) [VTK File Formats], which ParaView and meshio read. If there is a tet mesh,
// the grid's cells are the tets, else the tissue voxels. Coordinates are world (LPS), mm. The cell data `Label` is the
// organ number of a tet, or the value of a voxel's label in the user's files. The arrays are appended to the XML as raw
// little-endian bytes.
#include <cmath>
#include <fstream>
#include <limits>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/export/exporter.h"

namespace limber {

namespace {

constexpr std::uint8_t kTet = 10, kVoxel = 11;  // VTK's numbers for the cell types tet and voxel

struct Cells {
  std::vector<glm::dvec3> points;
  std::vector<std::int64_t> corners;  // indices into `points` of the cells' corners, `per_cell` for each cell
  std::vector<std::int32_t> labels;
  int per_cell = 0;
  std::uint8_t type = 0;
};

Cells tets_of(const TetMesh& mesh) {
  Cells cells{{}, {}, {mesh.region.begin(), mesh.region.end()}, 4, kTet};
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) cells.points.emplace_back(mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2));
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (int corner = 0; corner < 4; ++corner) cells.corners.push_back(mesh.T(t, corner));
  return cells;
}

// Returns one cell per tissue voxel. The points are the corners of tissue voxels; neighbouring cells share points.
Cells voxels_of(const LabelVolume& volume, const TissueTable& tissues) {
  const glm::ivec3 size = volume.grid.size;
  const auto corner_index = [&](const glm::ivec3& c) {
    return c.x + std::int64_t{size.x + 1} * (c.y + std::int64_t{size.y + 1} * c.z);
  };
  std::vector<std::int32_t> file_value(65536);
  for (std::size_t label = 0; label < file_value.size(); ++label) file_value[label] = static_cast<std::int32_t>(label);
  for (const Tissue& tissue : tissues.tissues) {
    if (std::abs(tissue.file_value) > std::numeric_limits<std::int32_t>::max())
      throw Error("the label " + text_of(tissue.file_value) + " does not fit into 32 bits", "Label",
                  "give the tissue a smaller label");
    file_value[tissue.label] = static_cast<std::int32_t>(tissue.file_value);
  }
  std::vector<std::int64_t> point_of(static_cast<std::size_t>(corner_index(size) + 1), -1);
  const AffineTransform world = world_from_voxel(volume.grid);
  Cells cells{{}, {}, {}, 8, kVoxel};
  std::size_t place = 0;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const Label label = volume.voxels[place++];
        if (label == 0) continue;
        cells.labels.push_back(file_value[label]);
        for (int corner = 0; corner < 8; ++corner) {  // in VTK's order of a voxel's corners: x fastest
          const glm::ivec3 at = glm::ivec3(x, y, z) + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
          std::int64_t& point = point_of[static_cast<std::size_t>(corner_index(at))];
          if (point < 0) {
            point = std::ssize(cells.points);
            cells.points.push_back(world * (glm::dvec3(at) - 0.5));
          }
          cells.corners.push_back(point);
        }
      }
  return cells;
}

class Arrays {
 public:
  // Adds an array and returns the XML element that describes it. write() writes the bytes of all arrays in the order in
  // which they were added.
  template <class T>
  std::string array(const char* type, const std::string& name, const std::vector<T>& values, int components = 1) {
    const std::string many = components > 1 ? " NumberOfComponents=\"" + std::to_string(components) + "\"" : "";
    const std::string text = std::string("        <DataArray type=\"") + type + "\" Name=\"" + name + "\"" + many +
                             " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    parts_.push_back({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
    offset_ += 8 + values.size() * sizeof(T);
    return text;
  }
  void write(std::ofstream& out) const {
    for (const auto& [bytes, count] : parts_) {
      const std::uint64_t length = count;
      out.write(reinterpret_cast<const char*>(&length), sizeof length);
      out.write(bytes, static_cast<std::streamsize>(count));
    }
  }

 private:
  std::vector<std::pair<const char*, std::size_t>> parts_;
  std::uint64_t offset_ = 0;
};

void write_cells(const Cells& cells, const Path& path) {
  std::vector<std::int64_t> ends(cells.labels.size());
  for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = static_cast<std::int64_t>(i + 1) * cells.per_cell;
  const std::vector<std::uint8_t> types(cells.labels.size(), cells.type);
  std::vector<double> places;
  for (const glm::dvec3& point : cells.points) places.insert(places.end(), {point.x, point.y, point.z});

  Arrays arrays;
  const std::string header =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"" +
      std::to_string(cells.points.size()) + "\" NumberOfCells=\"" + std::to_string(cells.labels.size()) +
      "\">\n      <Points>\n" + arrays.array("Float64", "Points", places, 3) + "      </Points>\n      <Cells>\n" +
      arrays.array("Int64", "connectivity", cells.corners) + arrays.array("Int64", "offsets", ends) +
      arrays.array("UInt8", "types", types) + "      </Cells>\n      <CellData Scalars=\"Label\">\n" +
      arrays.array("Int32", "Label", cells.labels) +
      "      </CellData>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _";
  write_atomically(path, [&](const Path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << header;
    arrays.write(out);
    out << "\n  </AppendedData>\n</VTKFile>\n";
    out.close();
    if (!out) throw Error("the file cannot be written", path.string(), "free some space, or choose another folder");
  });
}

}  // namespace

Exporter vtu_exporter() {
  return {.name = "VTK unstructured grid",
          .endings = {".vtu"},
          .takes_mesh = true,
          .write = [](const ExportInput& input, const Path& path) {
            write_cells(input.mesh ? tets_of(*input.mesh) : voxels_of(input.volume, input.tissues), path);
          }};
}

}  // namespace limber
