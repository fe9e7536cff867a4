// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/tetgen_files.h"

#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"

using namespace limber;

namespace {

// Reads the files as TetGen's manual describes them (sections 5.2.1 and 5.2.4).
TetMesh read_tetgen_files(const Path& stem) {
  TetMesh mesh;
  std::ifstream nodes(stem.string() + ".node"), tets(stem.string() + ".ele");
  int count = 0, dimension = 0, attributes = 0, markers = 0, corners = 0, number = 0, region = 0;
  nodes >> count >> dimension >> attributes >> markers;
  REQUIRE(dimension == 3);
  REQUIRE(attributes + markers == 0);
  mesh.V.resize(count, 3);
  for (int i = 0; i < count; ++i) {
    nodes >> number >> mesh.V(i, 0) >> mesh.V(i, 1) >> mesh.V(i, 2);
    REQUIRE(number == i);
  }
  tets >> count >> corners >> attributes;
  REQUIRE(corners == 4);
  REQUIRE(attributes == 1);
  mesh.T.resize(count, 4);
  for (int i = 0; i < count; ++i) {
    tets >> number >> mesh.T(i, 0) >> mesh.T(i, 1) >> mesh.T(i, 2) >> mesh.T(i, 3) >> region;
    REQUIRE(number == i);
    mesh.region.push_back(static_cast<std::uint16_t>(region));
  }
  CHECK(bool(nodes));
  CHECK(bool(tets));
  return mesh;
}

}  // namespace

TEST_CASE("tetgen files: what is written is read back bit for bit, whichever of the two names is given") {
  TetMesh mesh;
  mesh.V.resize(5, 3);
  mesh.V << 0, 0, 0, 1.0 / 3, 0, -0.0, 1e-17, 123456.789, 0, 0, 0, 3e8, -7, 2, 1;
  mesh.T.resize(2, 4);
  mesh.T << 0, 1, 2, 3, 1, 2, 3, 4;
  mesh.region = {0, 21};
  const Path folder = std::filesystem::temp_directory_path() / "limber_tetgen_files";
  std::filesystem::create_directories(folder);
  for (const char* name : {"arm", "arm.node", "arm.ele"}) {
    std::filesystem::remove(folder / "arm.node");
    std::filesystem::remove(folder / "arm.ele");
    write_tetgen_files(folder / name, mesh);
    const TetMesh back = read_tetgen_files(folder / "arm");
    CHECK(back.V == mesh.V);
    CHECK(back.T == mesh.T);
    CHECK(back.region == mesh.region);
  }
  CHECK_THROWS_AS(write_tetgen_files(folder / "nowhere" / "arm", mesh), Error);
}
