// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the part of core/mesh/surface_file.h that reads glTF.
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/mesh/surface_file.h"
#include "tests/support/closed_surface.h"
#include "tests/support/program.h"
#include "tests/support/surface_bytes.h"

using namespace limber;
using namespace limber::test;

namespace {

const std::string kGltf = tetrahedron_gltf("\"uri\": \"data:;base64," + base64(tetrahedron_data()) + "\", ");

TriangleMesh mesh_of(const std::string& gltf) { return parse_surface(gltf, "a.gltf"); }

// Checks the positions of the tetrahedron's right-angled corner and of its corner on the x axis.
void check_corners(const TriangleMesh& mesh, const glm::dvec3& corner, const glm::dvec3& on_x) {
  REQUIRE(mesh.V.size() == 4);
  CHECK(glm::length(mesh.V[0] - corner) < 1e-4);
  const bool is_there = glm::length(mesh.V[1] - on_x) < 1e-4 || glm::length(mesh.V[2] - on_x) < 1e-4;
  CHECK(is_there);
  CHECK(open_edges(mesh) == 0);
  CHECK(volume_inside(mesh) > 0);
}

void check_refused(const std::string& gltf, const std::string& part) {
  std::string message = "(no error)";
  try {
    mesh_of(gltf);
  } catch (const Error& error) {
    message = error.what();
  }
  INFO(message, " should say ", part);
  CHECK(message.find(part) != std::string::npos);
}

// Returns a file with the positions of a square's four corners and the given indices.
//   mode       glTF's number for the kind of primitive, 4 to 6: triangles, strip, fan
//   component  glTF's number for the type of the indices: 5121, 5123 or 5125 for 8, 16 or 32 bits
//   stride     bytes from one position to the next
std::string square(int mode, const std::vector<std::uint32_t>& indices, int component, int stride) {
  std::string data;
  for (const glm::vec3& p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(1, 1, 0)}) {
    for (int axis = 0; axis < 3; ++axis) put(data, p[axis]);
    data.append(stride - 12, 'x');
  }
  const std::size_t start = data.size();
  for (const std::uint32_t index : indices) {
    if (component == 5121) put(data, static_cast<std::uint8_t>(index));
    if (component == 5123) put(data, static_cast<std::uint16_t>(index));
    if (component == 5125) put(data, index);
  }
  const auto number = [](auto value) { return std::to_string(value); };
  const std::string json =
      R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"mode": )" + number(mode) +
      R"(, "attributes": {"POSITION": 0})" + (indices.empty() ? "" : R"(, "indices": 1)") +
      R"(}, {"mode": 1, "attributes": {"POSITION": 0}}]}], "accessors": [{"bufferView": 0, "componentType": 5126, )" +
      R"("count": 4, "type": "VEC3"}, {"bufferView": 1, "componentType": )" + number(component) + R"(, "count": )" +
      number(indices.size()) + R"(, "type": "SCALAR"}], "bufferViews": [{"buffer": 0, "byteLength": )" + number(start) +
      R"(, "byteStride": )" + number(stride) + R"(}, {"buffer": 0, "byteOffset": )" + number(start) +
      R"(, "byteLength": )" + number(data.size() - start) + R"(}], "buffers": [{"byteLength": )" + number(data.size()) +
      "}]}";
  return glb_file(json, data);
}

}  // namespace

TEST_CASE("gltf surface: nodes move, turn, scale and mirror their meshes, which keep their outside") {
  const std::string nodes = R"("nodes": [{"mesh": 0}])";
  const auto with = [&](const std::string& by) { return mesh_of(replaced(kGltf, nodes, "\"nodes\": [" + by + "]")); };
  // glTF's x, y and z in metres are the body's x, z and -y in millimetres.
  check_corners(with(R"({"mesh": 0, "translation": [1, 2, 3]})"), {1000, -3000, 2000}, {1010, -3000, 2000});
  check_corners(with(R"({"mesh": 0, "scale": [2, 2, 2]})"), {0, 0, 0}, {20, 0, 0});
  check_corners(with(R"({"mesh": 0, "scale": [-1, 1, 1]})"), {0, 0, 0}, {-10, 0, 0});
  check_corners(with(R"({"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]})"), {0, 0, 0}, {0, 0, 10});
  check_corners(with(R"({"mesh": 0, "matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 0.5,0,0,1]})"), {500, 0, 0}, {500, 0, 10});
  check_corners(with(R"({"children": [1], "translation": [1, 0, 0], "scale": [3, 3, 3]},
                        {"mesh": 0, "translation": [0, 1, 0]})"),
                {1000, 0, 3000}, {1030, 0, 3000});
}

TEST_CASE("gltf surface: all nodes of the default scene are read, and no others") {
  const std::string nodes = R"("nodes": [{"mesh": 0}])", scenes = R"("scenes": [{"nodes": [0]}])";
  const std::string three = replaced(kGltf, nodes, R"("nodes": [{"children": [1]}, {"mesh": 0}, {"mesh": 0,
    "translation": [1, 0, 0]}])");
  CHECK(mesh_of(three).F.size() == 4);
  CHECK(mesh_of(replaced(three, scenes, R"("scenes": [{"nodes": [0, 2]}])")).F.size() == 8);
  const std::string second = replaced(three, scenes, R"("scenes": [{"nodes": [0]}, {"nodes": [2]}])");
  CHECK(mesh_of(second).V[0].x < 1);
  CHECK(mesh_of(replaced(second, "\"scene\": 0", "\"scene\": 1")).V[0].x == doctest::Approx(1000));
  CHECK(mesh_of(replaced(replaced(three, scenes + ",", ""), "\"scene\": 0,", "")).F.size() == 8);
  check_refused(replaced(three, scenes, R"("scenes": [{}])"), "no triangle");
}

TEST_CASE("gltf surface: lists, strips and fans, with and without indices of each size, and with gaps") {
  const auto mesh = [](int mode, const std::vector<std::uint32_t>& indices, int component, int stride) {
    return parse_surface(square(mode, indices, component, stride), "a.glb");
  };
  for (const int component : {5121, 5123, 5125})
    for (const int stride : {12, 20}) {
      CHECK(mesh(4, {0, 1, 2, 2, 1, 3}, component, stride).F == std::vector<glm::ivec3>{{0, 1, 2}, {2, 1, 3}});
      // The reader numbers vertices in the order in which triangles name them.
      CHECK(mesh(5, {0, 1, 2, 3}, component, stride).F == std::vector<glm::ivec3>{{0, 1, 2}, {1, 3, 2}});
      CHECK(mesh(6, {0, 1, 3, 2}, component, stride).F == std::vector<glm::ivec3>{{0, 1, 2}, {0, 2, 3}});
    }
  CHECK(mesh(4, {}, 5121, 12).F.size() == 1);
  CHECK(mesh(5, {}, 5121, 12).F.size() == 2);
  CHECK(mesh(5, {}, 5121, 12).V[3] == glm::dvec3(1000, 0, 1000));
}

TEST_CASE("gltf surface: a buffer is read from the file's folder and the folders below, and from nowhere else") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "in");
  std::filesystem::create_directory(folder / "in/a b");
  std::ofstream(folder / "in/a b/c.bin", std::ios::binary) << tetrahedron_data();
  std::ofstream(folder / "out.bin", std::ios::binary) << tetrahedron_data();
  const Path path = folder / "in/a.gltf";
  const auto read = [&](const std::string& uri) {
    return parse_surface(tetrahedron_gltf("\"uri\": \"" + uri + "\", "), path);
  };
  CHECK(read("a%20b/c.bin").F.size() == 4);
  for (const std::string& uri : {std::string("../out.bin"), std::string("a%20b/%2e%2e/../out.bin"),
                                 (folder / "out.bin").string(), "file://" + (folder / "out.bin").string(),
                                 std::string("missing.bin"), std::string("a%20b"), std::string("a%00b")})
    CHECK_THROWS_AS(read(uri), Error);
}

TEST_CASE("gltf surface: what is damaged, compressed or too large is refused") {
  check_refused("{}", "\"asset\" is missing");
  check_refused(replaced(kGltf, "\"count\": 12", "\"count\": 13"), "outside its data");
  check_refused(replaced(kGltf, "\"count\": 12", "\"count\": 9007199254740992"), "outside its data");
  check_refused(replaced(kGltf, "\"byteLength\": 48", "\"byteLength\": 61"), "outside its data");
  check_refused(replaced(kGltf, "\"byteLength\": 48", "\"byteStride\": 4, \"byteLength\": 48"), "outside its data");
  check_refused(replaced(kGltf, "\"byteLength\": 48", "\"byteStride\": 9007199254740992, \"byteLength\": 48"),
                "outside its data");
  check_refused(replaced(kGltf, "\"byteOffset\": 48", "\"byteOffset\": 9007199254740992"), "outside its data");
  check_refused(replaced(kGltf, "\"count\": 4", "\"count\": 3"), "vertex 3, which is not one of the 3 vertices");
  check_refused(replaced(kGltf, "\"componentType\": 5126", "\"componentType\": 5122"), "three floats");
  check_refused(replaced(kGltf, "\"componentType\": 5121", "\"componentType\": 5120"), "unsigned whole numbers");
  check_refused(replaced(kGltf, "\"bufferView\": 0, ", ""), "without compression");
  check_refused(replaced(kGltf, "\"bufferView\": 0", "\"sparse\": {}, \"bufferView\": 0"), "sparse");
  check_refused(replaced(kGltf, "\"bufferView\": 0", "\"bufferView\": 2"),
                "number 2, but there are only 2 bufferViews");
  check_refused(replaced(kGltf, "[{\"buffer\": 0", "[{\"buffer\": 1"), "number 1, but there are only 1 buffers");
  check_refused(replaced(kGltf, "{\"mesh\": 0}", "{\"mesh\": 1}"), "number 1, but there are only 1 meshes");
  check_refused(replaced(kGltf, "[{\"nodes\": [0]}]", "[{\"nodes\": [1]}]"), "number 1, but there are only 1 nodes");
  check_refused(replaced(kGltf, "{\"mesh\": 0}", "{\"mesh\": 0, \"scale\": [1e300, 1e300, 1e300]}"), "kilometre");
  check_refused(replaced(kGltf, "base64,AA", "base64,!!"), "a buffer has only 0 of its 60 bytes");
  // Tries half a million nodes that show one mesh of four triangles, and a list of two million indices of one vertex.
  std::string nodes = "{\"mesh\": 0}", roots = "0";
  for (int i = 1; i < 500'001; ++i) nodes += ",{\"mesh\":0}", roots += "," + std::to_string(i);
  check_refused(replaced(replaced(kGltf, "{\"mesh\": 0}", nodes), "\"nodes\": [0]", "\"nodes\": [" + roots + "]"),
                "more than 2000000 triangles");
  CHECK_THROWS_AS(parse_surface(square(5, std::vector<std::uint32_t>(2'000'003), 5121, 12), "a.glb"), Error);
}
