// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads unstructured grids back with a simple reader: points, cells and labels are those of the body.
#include <cstring>
#include <filesystem>
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/export/exporter.h"

using namespace limber;

namespace {

struct Grid3 {
  std::vector<double> points;
  std::vector<std::int64_t> corners, ends;
  std::vector<std::uint8_t> types;
  std::vector<std::int32_t> labels;
};

template <class T>
std::vector<T> array(const std::string& file, const std::string& name) {
  const std::size_t at = file.find("Name=\"" + name + "\""), offset = file.find("offset=\"", at) + 8;
  const std::size_t data = file.find("<AppendedData");
  std::size_t place = file.find('_', data) + 1 + std::stoull(file.substr(offset));
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, &file[place], 8);
  std::vector<T> values(bytes / sizeof(T));
  std::memcpy(values.data(), &file[place + 8], bytes);
  return values;
}

Grid3 exported(const LabelVolume& volume, const TissueTable& tissues, const TetMesh* mesh) {
  const Path path = std::filesystem::temp_directory_path() / "limber-cells.vtu";
  std::vector<std::string> warnings;
  write_export(*exporter_for(path), {volume, tissues, {}, 0, mesh, no_progress(), warnings}, path);
  CHECK(warnings.empty());
  std::ifstream in(path, std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  return {array<double>(file, "Points"), array<std::int64_t>(file, "connectivity"),
          array<std::int64_t>(file, "offsets"), array<std::uint8_t>(file, "types"), array<std::int32_t>(file, "Label")};
}

glm::dvec3 point(const Grid3& grid, std::int64_t index) {
  const auto at = static_cast<std::size_t>(3 * index);
  return {grid.points[at], grid.points[at + 1], grid.points[at + 2]};
}

}  // namespace

TEST_CASE("vtu: each tissue voxel is a cell between its faces, with its label in files, and neighbours share corners") {
  LabelVolume volume;
  volume.grid = {glm::ivec3(3, 1, 1), glm::dvec3(2, 3, 4), glm::dvec3(10, 20, 30), glm::dmat3(1)};
  volume.voxels = {1, 2, 0};
  TissueTable tissues;
  Tissue tissue;
  tissue.label = 2;
  tissue.file_value = 700;
  tissues.tissues = {tissue};
  const Grid3 grid = exported(volume, tissues, nullptr);
  CHECK(grid.labels == std::vector<std::int32_t>{1, 700});
  CHECK(grid.types == std::vector<std::uint8_t>{11, 11});
  CHECK(grid.ends == std::vector<std::int64_t>{8, 16});
  CHECK(grid.points.size() == 3 * 12);
  CHECK(point(grid, grid.corners[0]) == glm::dvec3(9, 18.5, 28));
  CHECK(point(grid, grid.corners[7]) == glm::dvec3(11, 21.5, 32));
  CHECK(point(grid, grid.corners[15]) == glm::dvec3(13, 21.5, 32));
  tissues.tissues[0].file_value = 3e9;  // too large for the file's type: must be refused
  CHECK_THROWS_AS(exported(volume, tissues, nullptr), Error);
}

TEST_CASE("vtu: a mesh goes in place of the voxels") {
  TetMesh mesh;
  mesh.V.resize(4, 3);
  mesh.V << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  mesh.T.resize(1, 4);
  mesh.T << 0, 1, 2, 3;
  mesh.region = {33};
  LabelVolume volume;
  const Grid3 grid = exported(volume, {}, &mesh);
  CHECK(grid.labels == std::vector<std::int32_t>{33});
  CHECK(grid.types == std::vector<std::uint8_t>{10});
  CHECK(grid.corners == std::vector<std::int64_t>{0, 1, 2, 3});
  CHECK(point(grid, 3) == glm::dvec3(0, 0, 1));
}
