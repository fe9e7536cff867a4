// SPDX-License-Identifier: AGPL-3.0-or-later
// The bytes of a file with a tetrahedron in each surface format that the program reads, and functions that write other
// test files.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include "core/base/text_parse.h"
#include "core/mesh/surface.h"

namespace limber::test {

template <class Value>
void put(std::string& bytes, Value value, bool is_big_endian = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (is_big_endian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

inline std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    for (int k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

// Returns a .glb file of a description and its binary data.
inline std::string glb_file(std::string json, std::string data) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(28 + json.size() + data.size()));
  put(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  put(bytes, static_cast<std::uint32_t>(data.size()));
  return bytes.append("BIN\0", 4) + data;
}

// Returns a tetrahedron: a corner cut off a cube, with edges of 10 mm along the axes.
inline TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {0, 10, 0}, {10, 0, 0}, {0, 0, 10}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}}};
}

// Returns the tetrahedron's glTF buffer: positions in glTF's axes and metres as floats, and indices as one byte each.
inline std::string tetrahedron_data() {
  std::string data;
  for (const glm::dvec3& v : tetrahedron().V)
    for (const double x : {v.x, v.z, -v.y}) put(data, static_cast<float>(x / 1000));
  for (const glm::ivec3& f : tetrahedron().F)
    for (int i = 0; i < 3; ++i) put(data, static_cast<std::uint8_t>(f[i]));
  return data;
}

// Returns the description of a glTF tetrahedron.
//   uri  names the buffer, as "uri": "a.bin", with a comma at the end; empty in a .glb
inline std::string tetrahedron_gltf(const std::string& uri) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
    "buffers": [{)" +
         uri + R"("byteLength": 60}]})";
}

inline std::string tetrahedron_stl(bool is_ascii) {
  std::string text = "solid a b c\n", bytes = "from a test";
  bytes.resize(80, ' ');
  put(bytes, std::uint32_t{4});
  for (const glm::ivec3& f : tetrahedron().F) {
    text += " facet normal 0 0 0\nouter loop\n";
    bytes.append(12, '\0');
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 v = tetrahedron().V[f[i]];
      text += "vertex " + text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z) + "\n";
      for (int axis = 0; axis < 3; ++axis) put(bytes, static_cast<float>(v[axis]));
    }
    text += "endloop\nENDFACET\n";
    put(bytes, std::uint16_t{0});
  }
  return is_ascii ? text + "endsolid a b c\n" : bytes;
}

inline std::string tetrahedron_ply(const std::string& format) {
  std::string bytes = "ply\nformat " + format + " 1.0\nelement vertex 4\nproperty double x\nproperty double y\n" +
                      "property double z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
  const bool is_big = format == "binary_big_endian";
  for (const glm::dvec3& v : tetrahedron().V) {
    if (format == "ascii") bytes += text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z) + "\n";
    else
      for (int axis = 0; axis < 3; ++axis) put(bytes, v[axis], is_big);
  }
  for (const glm::ivec3& f : tetrahedron().F) {
    if (format == "ascii") {
      bytes += "3 " + std::to_string(f.x) + " " + std::to_string(f.y) + " " + std::to_string(f.z) + "\n";
      continue;
    }
    put(bytes, std::uint8_t{3});
    for (int i = 0; i < 3; ++i) put(bytes, std::int32_t{f[i]}, is_big);
  }
  return bytes;
}

// Returns the tetrahedron in each format, as file name and bytes.
inline std::map<std::string, std::string> tetrahedron_files() {
  std::string obj;
  for (const glm::dvec3& v : tetrahedron().V)
    obj += "v " + text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z) + "\n";
  for (const glm::ivec3& f : tetrahedron().F)
    obj += "f " + std::to_string(f.x + 1) + " " + std::to_string(f.y + 1) + " " + std::to_string(f.z + 1) + "\n";
  const std::string data = "\"uri\": \"data:a/b;base64," + base64(tetrahedron_data()) + "\", ";
  return {{"binary.stl", tetrahedron_stl(false)},
          {"ascii.stl", tetrahedron_stl(true)},
          {"a.obj", obj},
          {"ascii.ply", tetrahedron_ply("ascii")},
          {"little.ply", tetrahedron_ply("binary_little_endian")},
          {"big.ply", tetrahedron_ply("binary_big_endian")},
          {"a.gltf", tetrahedron_gltf(data)},
          {"a.glb", glb_file(tetrahedron_gltf(""), tetrahedron_data())}};
}

}  // namespace limber::test
