// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_file.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/export/surface_files.h"
#include "tests/support/closed_surface.h"
#include "tests/support/program.h"
#include "tests/support/surface_bytes.h"

using namespace limber;
using namespace limber::test;

namespace {

using Corners = std::vector<glm::dvec3>;  // three for each triangle

Corners corners_of(const TriangleMesh& mesh) {
  Corners corners;
  for (const glm::ivec3& f : mesh.F)
    for (int i = 0; i < 3; ++i) corners.push_back(mesh.V[f[i]]);
  return corners;
}

double largest_difference(const Corners& a, const Corners& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, glm::length(a[i] - b[i]));
  return largest;
}

// Returns the largest distance from a triangle of `triangles` to the nearest one of `others`. The distance of two
// triangles is that of their corners; their lists of corners may start at different corners.
double farthest_triangle(const Corners& triangles, const Corners& others) {
  double farthest = 0;
  for (std::size_t a = 0; a < triangles.size(); a += 3) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < others.size(); b += 3)
      for (std::size_t turn = 0; turn < 3; ++turn) {
        double distance = 0;
        for (std::size_t i = 0; i < 3; ++i)
          distance = std::max(distance, glm::length(triangles[a + i] - others[b + (i + turn) % 3]));
        nearest = std::min(nearest, distance);
      }
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

// Two tissues side by side, whose corners are no round numbers.
LabelSurfaces two_surfaces() {
  LabelVolume volume;
  volume.grid.size = {12, 10, 9};
  volume.grid.spacing = {1.1, 0.9, 1.3};
  volume.grid.origin = {-123.4, 56.7, 1601.3};
  for (int z = 0; z < 9; ++z)
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 12; ++x) {
        const bool inside = glm::length(glm::dvec3(x - 5.5, y - 4.5, z - 4.0)) < 3.8;
        volume.voxels.push_back(static_cast<Label>(inside ? (x < 6 ? 1 : 2) : 0));
      }
  return label_surfaces(volume);
}

Corners corners_of(const LabelSurfaces& all, const LabelSurface& surface) {
  Corners corners;
  for (const glm::ivec3& f : surface.F)
    for (int i = 0; i < 3; ++i) corners.push_back(all.V[surface.vertex[f[i]]]);
  return corners;
}

const Corners kTetrahedronCorners = corners_of(tetrahedron());

std::string message_of(const std::string& bytes, const Path& name) {
  try {
    parse_surface(bytes, name);
  } catch (const Error& error) {
    return error.what();
  }
  return "(no error)";
}

void check_refused(const std::string& bytes, const Path& name, const std::string& part) {
  const std::string message = message_of(bytes, name);
  INFO(message, " should say ", part);
  CHECK(message.find(part) != std::string::npos);
  CHECK(message.find(name.string()) != std::string::npos);
}

}  // namespace

TEST_CASE("surface file: what the exporter writes is read back, triangle by triangle") {
  const LabelSurfaces all = two_surfaces();
  REQUIRE(all.surfaces.size() == 2);
  Corners together = corners_of(all, all.surfaces[0]);
  const Corners second = corners_of(all, all.surfaces[1]);
  together.insert(together.end(), second.begin(), second.end());
  const TemporaryFolder folder;
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.glb"}) {
    CAPTURE(name);
    const Path path = folder / name;
    write_surfaces(all, {}, path);
    const bool is_exact = path.extension() == ".ply" || path.extension() == ".obj";
    // Coordinates go up to 1601 mm as floats. glTF also rounds them in metres.
    const double precision = is_exact ? 0 : 2e-4;
    const std::vector<Path> paths = surface_paths(all, {}, path);
    if (paths.size() == 1) {
      CHECK(largest_difference(corners_of(read_surface(path)), together) <= precision);
      continue;
    }
    for (std::size_t s = 0; s < paths.size(); ++s) {
      const TriangleMesh mesh = read_surface(paths[s]);
      CHECK(largest_difference(corners_of(mesh), corners_of(all, all.surfaces[s])) <= precision);
      CHECK(mesh.V.size() == all.surfaces[s].vertex.size());
      CHECK(open_edges(mesh) == 0);
      CHECK(volume_inside(mesh) == doctest::Approx(enclosed_volume(all, all.surfaces[s])).epsilon(1e-5));
    }
  }
}

// Blender writes the files independently. Blender's axes are the body's world axes.
TEST_CASE("surface file: what Blender writes is read, in every format, as the triangles that it has") {
  NEEDS_PROGRAM("blender");
  const TemporaryFolder folder;
  const ProgramRun run =
      run_program("blender", {"-b", "--factory-startup", "--python-exit-code", "1", "--python",
                              LIMBER_SOURCE_DIR "/tests/core/mesh/blender_surfaces.py", "--", folder.path().string()});
  INFO(run.out, run.err);
  REQUIRE(run.exit_code == 0);
  Corners truth;
  std::ifstream in(folder / "triangles.txt");
  for (glm::dvec3 p; in >> p.x >> p.y >> p.z;) truth.push_back(p);
  REQUIRE(truth.size() == 3 * 80);
  for (const char* name :
       {"binary.stl", "ascii.stl", "binary.ply", "ascii.ply", "a.obj", "a.glb", "inside.gltf", "beside.gltf"}) {
    CAPTURE(name);
    const TriangleMesh mesh = read_surface(folder / name);
    CHECK(mesh.V.size() == 42);
    CHECK(open_edges(mesh) == 0);
    CHECK(farthest_triangle(truth, corners_of(mesh)) < 1e-3);
  }
}

TEST_CASE("surface file: every variant of a tetrahedron gives its four vertices and four triangles") {
  for (const auto& [name, bytes] : tetrahedron_files()) {
    CAPTURE(name);
    const TriangleMesh mesh = parse_surface(bytes, name);
    CHECK(mesh.V.size() == 4);
    CHECK(largest_difference(corners_of(mesh), kTetrahedronCorners) < 1e-5);
    CHECK(open_edges(mesh) == 0);
    CHECK(volume_inside(mesh) == doctest::Approx(1000.0 / 6));
  }
}

TEST_CASE("surface file: polygons become fans, negative numbers count backwards, other statements are skipped") {
  const TriangleMesh mesh = parse_surface(
      "# a square and a triangle\nmtllib a.mtl\no a\nv 0 0 0 1\r\nv +1 0 0\nv 1 1 0 0.5 0.5 0.5\nv 0 1e0 0\nvt 0 0\n"
      "vn 0 0 1\ng b\nusemtl c\ns off\nf 1/1/1 2//1 \\\n 3/1 4 # all\nv 0 0 5\nf -1 -5 -4\nl 1 2\n",
      "a.OBJ");
  CHECK(mesh.F == std::vector<glm::ivec3>{{0, 1, 2}, {0, 2, 3}, {4, 0, 1}});
  CHECK(mesh.V == Corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 5}});
}

TEST_CASE("surface file: equal positions are merged, triangles without area and unused vertices are left out") {
  const TriangleMesh mesh = parse_surface(
      "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv -0 0 0\nv 2 0 0\nv 1 1 0\nf 2 3 4\nf 5 3 7\nf 2 5 3\nf 2 3 6\nf 4 4 7\n",
      "a.obj");
  CHECK(mesh.F == std::vector<glm::ivec3>{{0, 1, 2}, {0, 1, 3}});
  check_refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "a.obj", "no triangle with an area");
}

TEST_CASE("surface file: PLY's other elements and properties are skipped, in any format and order") {
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\r\ncomment x\r\nelement camera 2\r\nproperty list uchar double k\r\nproperty short"
                        " s\r\nelement empty 18446744073709551615\r\nelement vertex 4\r\nproperty uchar red\r\nproperty"
                        " float z\r\nproperty list ushort int16 more\r\nproperty double x\r\nproperty int y\r\nelement "
                        "face 2\r\nproperty int flag\r\nproperty list int8 uint16 vertex_index\r\nelement edge 1\r\n"
                        "property int v\r\nend_header\r\n";
    for (int camera = 0; camera < 2; ++camera) {
      put(bytes, std::uint8_t{1}, big);
      put(bytes, 0.5, big);
      put(bytes, std::int16_t{-3}, big);
    }
    for (const glm::ivec3& v : {glm::ivec3(0, 0, 0), glm::ivec3(2, 0, 0), glm::ivec3(2, 3, 0), glm::ivec3(0, 3, 0)}) {
      put(bytes, std::uint8_t{255}, big);
      put(bytes, float(v.z), big);
      put(bytes, std::uint16_t(v.x), big);
      for (int i = 0; i < v.x; ++i) put(bytes, std::int16_t{7}, big);
      put(bytes, double(v.x), big);
      put(bytes, std::int32_t(v.y), big);
    }
    for (const std::vector<std::uint16_t>& f : {std::vector<std::uint16_t>{0, 1, 2, 3}, {0, 3, 2}}) {
      put(bytes, std::int32_t{0}, big);
      put(bytes, std::int8_t(f.size()), big);
      for (const std::uint16_t i : f) put(bytes, i, big);
    }
    put(bytes, std::int32_t{0}, big);
    const TriangleMesh mesh = parse_surface(bytes, "a.ply");
    CHECK(mesh.F == std::vector<glm::ivec3>{{0, 1, 2}, {0, 2, 3}, {0, 3, 2}});
    CHECK(mesh.V == Corners{{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}});
  }
}

TEST_CASE("surface file: an STL whose header starts with solid is binary if its size says so") {
  std::string bytes = tetrahedron_files().at("binary.stl");
  bytes.replace(0, 11, "solid facet");
  CHECK(corners_of(parse_surface(bytes, "a.stl")) == kTetrahedronCorners);
}

TEST_CASE("surface file: damaged STL is refused with its place") {
  const auto files = tetrahedron_files();
  const std::string& binary = files.at("binary.stl");
  const std::string& ascii = files.at("ascii.stl");
  check_refused("", "a.stl", "too short");
  check_refused(binary.substr(0, 200), "a.stl", "states 4 triangles, but the file has only 2");
  check_refused(binary.substr(0, 80) + "\xff\xff\xff\xff" + binary.substr(84), "a.stl", "states 4294967295 triangles");
  check_refused(ascii.substr(0, ascii.find("vertex")), "a.stl", "ends before");
  check_refused(replaced(ascii, "vertex 10 0 0", "vertex 10 0"), "a.stl", "does not have three numbers");
  check_refused(replaced(ascii, "vertex 10 0 0", "vertex 10 O 0"), "a.stl", "\"O\" was found where a vertex needs");
  check_refused(replaced(ascii, "vertex 10 0 0", "vertex 10 nan 0"), "a.stl", "not finite");
  check_refused(replaced(ascii, "vertex 10 0 0\n", "vertex 10 0 0\nvertex 1 1 1\n"), "a.stl", "more than three");
  check_refused(replaced(ascii, "vertex 10 0 0\n", ""), "a.stl", "line 6: ");
  check_refused(replaced(ascii, "outer loop\n", ""), "a.stl", "no meaning");
  check_refused("solid a\nendsolid a\n", "a.stl", "no triangle");
  std::string huge = binary;
  huge.replace(84 + 12, 4, std::string("\x00\x00\x80\x7f", 4));
  check_refused(huge, "a.stl", "a.stl, triangle 1: ");
}

TEST_CASE("surface file: damaged OBJ is refused with its line") {
  check_refused("", "a.obj", "no triangle");
  check_refused("v 0 0\n", "a.obj", "a.obj, line 1: ");
  check_refused("\nv 0 0 1e999\n", "a.obj", "line 2");
  check_refused("v 0 0 inf\n", "a.obj", "finite");
  check_refused("v 0 0 2e6\n", "a.obj", "kilometre");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a.obj", "vertex 4, which is not one of the 3 vertices");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "a.obj", "fewer than three");
  for (const char* corner : {"0", "-4", "x", "9999999999999999999", "/1"})
    check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + std::string(corner) + "\n", "a.obj", "line 4");
  std::string endless = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (int i = 0; i < 2'100'000; ++i) endless += " 1";
  check_refused(endless, "a.obj", "more than 2000000 triangles");
}

TEST_CASE("surface file: damaged PLY is refused with its place") {
  const auto files = tetrahedron_files();
  const std::string& ascii = files.at("ascii.ply");
  const std::string& little = files.at("little.ply");
  check_refused("", "a.ply", "no end");
  check_refused("obj\n", "a.ply", "not a PLY");
  check_refused("ply\n" + std::string(2 << 20, '\n'), "a.ply", "no end");
  check_refused(replaced(ascii, "ascii", "utf8"), "a.ply", "not a format of PLY");
  check_refused(replaced(ascii, "format ascii 1.0\n", ""), "a.ply", "names no format");
  check_refused(replaced(ascii, "double x", "real x"), "a.ply", "\"real\" is not a type");
  check_refused(replaced(ascii, "double x", "double u"), "a.ply", "x, y and z");
  check_refused(replaced(ascii, "list uchar", "list float"), "a.ply", "not a whole number");
  check_refused(replaced(ascii, "vertex_indices", "corners"), "a.ply", "no list vertex_indices");
  check_refused(replaced(ascii, "element vertex 4", "element vertex -4"), "a.ply", "number of rows");
  check_refused(replaced(ascii, "element face", "element vertex"), "a.ply", "occurs twice");
  check_refused(replaced(ascii, "3 0 1 2", "3 0 1 4"), "a.ply", "a.ply, face 1 (line 14): ");
  check_refused(replaced(ascii, "3 0 1 2", "2 0 1"), "a.ply", "fewer than three");
  check_refused(replaced(ascii, "3 0 1 2", "-3 0 1 2"), "a.ply", "not a whole number");
  check_refused(ascii.substr(0, ascii.size() - 8), "a.ply", "ends too early");
  check_refused(little.substr(0, little.size() - 1), "a.ply", "a.ply, face 4: ");
  check_refused(replaced(little, "vertex 4", "vertex 999999999999"), "a.ply", "a.ply, vertex ");
  check_refused(replaced(little, "face 4", "face 18446744073709551615"), "a.ply", "ends too early");
  check_refused(replaced(ascii, "element face 4", "element face 0"), "a.ply", "no faces");
}

TEST_CASE("surface file: no cut and no damaged byte of a file does more than give an Error") {
  std::mt19937 random(1);
  int refused = 0, read = 0;
  const auto attempt = [&](const std::string& bytes, const Path& name) {
    try {
      const TriangleMesh mesh = parse_surface(bytes, name);
      for (const glm::ivec3& f : mesh.F)
        for (int i = 0; i < 3; ++i) REQUIRE(f[i] < static_cast<int>(mesh.V.size()));
      ++read;
    } catch (const Error&) {
      ++refused;
    }
  };
  for (const auto& [name, bytes] : tetrahedron_files()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) attempt(bytes.substr(0, size), name);
    for (int i = 0; i < 2000; ++i) {
      std::string damaged = bytes;
      for (int k = 0; k < 2; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      attempt(damaged, name);
    }
  }
  CHECK(refused > 5000);
  CHECK(read > 1000);
}

TEST_CASE("surface file: other names, missing files and Git LFS pointers are refused") {
  check_refused("ply\n", "a.fbx", "ends in .stl, .obj, .ply, .glb or .gltf");
  check_refused("version https://git-lfs.github.com/spec/v1\n", "a.obj", "Git LFS");
  CHECK_THROWS_AS(read_surface("/nowhere/a.stl"), Error);
}
