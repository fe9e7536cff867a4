// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/gltf_rig.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
const std::string kTwoJoints = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
  "nodes": [{"name": "up", "translation": [0, 1, 0], "children": [1]}, {"children": [2],
    "rotation": [0, 0, 0.70710678, 0.70710678]},
            {"name": "tip", "translation": [0.5, 0, 0]}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
  "accessors": [{"componentType": 5126, "count": 8, "type": "VEC3"}, {"componentType": 5123, "count": 36,
    "type": "SCALAR"}],
  "skins": [{"joints": [2, 0]}]})";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}
}  // namespace

TEST_CASE("gltf: joints are placed by their nodes, in LPS mm, past nodes that are no joints") {
  const GltfSummary gltf = parse_gltf(kTwoJoints, false, "test");
  CHECK(gltf.meshes == 1);
  CHECK(gltf.vertices == 8);
  CHECK(gltf.triangles == 12);
  REQUIRE(gltf.armature.bones.size() == 2);
  CHECK(gltf.armature.bones[0].name == "up");
  CHECK(gltf.armature.bones[0].head == glm::dvec3(0, 0, 1000));
  CHECK(gltf.armature.bones[1].parent == 0);
  CHECK(glm::length(gltf.armature.bones[1].head - glm::dvec3(0, 0, 1500)) < 1e-4);
}

TEST_CASE("gltf: wrong types, references to nothing and circles are refused") {
  auto refused = [](const std::string& text) { CHECK_THROWS_AS(parse_gltf(text, false, "test"), Error); };
  refused("");
  refused("[]");
  refused("{}");
  refused(replaced(kTwoJoints, "\"2.0\"", "\"1.0\""));
  refused(replaced(kTwoJoints, "\"2.0\"", "2"));
  refused(replaced(kTwoJoints, "\"scene\": 0", "\"scene\": 1"));
  refused(replaced(kTwoJoints, "\"scene\": 0", "\"scene\": -1"));
  refused(replaced(kTwoJoints, "[2, 0]", "[2, 3]"));
  refused(replaced(kTwoJoints, "[2, 0]", "[2, 2]"));
  refused(replaced(kTwoJoints, "[0, 1, 0]", "[0, 1]"));
  refused(replaced(kTwoJoints, "[0, 1, 0]", "[0, \"1\", 0]"));
  refused(replaced(kTwoJoints, "\"children\": [2]", "\"children\": [0]"));
  refused(replaced(kTwoJoints, "\"children\": [2]", "\"children\": [1, 2]"));
  refused(replaced(kTwoJoints, "\"indices\": 1", "\"indices\": 2"));
  refused(replaced(kTwoJoints, "\"meshes\"",
                   "\"buffers\": [{\"byteLength\": 9, \"uri\": \"data:a/b;base64,AAAA\"}], \"meshes\""));
}

TEST_CASE("gltf: a .glb that is cut is refused") {
  NEEDS_SHARED("data/gltf/blender_humerus.glb");
  const std::string bytes = read_file(test::shared_path("data/gltf/blender_humerus.glb"));
  const GltfSummary gltf = parse_gltf(bytes, true, "test");
  CHECK(gltf.meshes == 1);
  CHECK(gltf.armature.bones.empty());
  for (size_t size : {size_t(0), size_t(4), size_t(19), size_t(100), bytes.size() / 2, bytes.size() - 1})
    CHECK_THROWS_AS(parse_gltf(bytes.substr(0, size), true, "test"), Error);
}
