// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the JSON description of a glTF 2.0 file (.gltf or .glb): its nodes, its meshes, and where their data are. The
// data themselves are not read.
//
// The description is read strictly: every property must have the type that the specification gives it, every reference
// must have a target, and the node graph must be a forest. Buffers inside the file must have all their bytes. Lengths
// and offsets of buffer views and accessors are not checked.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

// References are indices into the lists below, or -1 for none.
struct GltfDescription {
  struct Node {
    std::string name;
    int parent = -1;
    std::int64_t mesh = -1;
    glm::dmat4 world_from_node{1};  // transform from the node to glTF's world, metres, Y up
    // True: the default scene shows the node. That is the first scene if none is named; without scenes, all nodes are
    // shown.
    bool is_in_scene = false;
  };
  struct Primitive {
    std::int64_t positions = -1, indices = -1;  // accessors of the positions and of the indices; -1: none
    std::int64_t mode = 4;                      // the kind of primitive: 4 triangles, 5 strip, 6 fan [glTF 2.0, 5.24.4]
  };
  struct Accessor {
    std::int64_t view = -1;
    std::uint64_t offset = 0, count = 0;  // offset in the buffer view, bytes; number of elements
    std::int64_t component = 0;           // glTF's number for the type of a component [glTF 2.0, 3.6.2.2]
    std::string type;                     // glTF's name of the element type: SCALAR, VEC3 ...
    bool is_sparse = false;
  };
  struct View {
    std::int64_t buffer = -1;
    // Position and length in the buffer; distance between elements, bytes, 0: they follow one another without gaps.
    std::uint64_t offset = 0, bytes = 0, stride = 0;
  };
  struct Buffer {
    std::uint64_t bytes = 0;
    std::string uri;  // name of the data's file; empty: the data are in the binary chunk of a .glb
  };

  std::vector<Node> nodes;
  std::vector<std::size_t> order;  // indices of all nodes, parents before their children
  std::vector<std::vector<Primitive>> meshes;
  std::vector<Accessor> accessors;
  std::vector<View> views;
  std::vector<Buffer> buffers;
  std::vector<std::vector<std::uint64_t>> skins;  // joints of each skin; not checked to be indices of nodes
  std::size_t animations = 0;
  std::string_view binary;  // the binary chunk of a .glb, a part of the parsed bytes; empty if there is none
};

// Parses the bytes of a glTF file. Throws Error if a property is wrong or missing, and names this property.
//   is_binary  true for .glb
//   where      names the file in error messages
GltfDescription parse_gltf_description(const std::string& bytes, bool is_binary, const std::string& where);

// Throws Error if `index` is not less than `size`, the number of elements of `list`.
//   what  names the property that has the index, in the message
void check_gltf_index(std::uint64_t index, std::size_t size, const std::string& what, const char* list,
                      const std::string& where);

// Converts a position from glTF's axes (metres, Y up, a model faces +Z) to the world (LPS, mm): the inverse of
// gltf_from_lps() in core/export/glb_writer.h.
inline glm::dvec3 lps_from_gltf(const glm::dvec3& p) { return glm::dvec3(p.x, -p.z, p.y) * 1000.0; }

}  // namespace limber
