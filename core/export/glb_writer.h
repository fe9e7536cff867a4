// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes glTF 2.0 as one file (.glb), which consists of a JSON description and binary data. The binary data is a list
// of arrays; each is described by a JSON object, its accessor, and the description refers to an array by its accessor.
//
// glTF's coordinates are right-handed, in metres, with Y up, and a model faces +Z. So the world position (x, y, z) in
// mm (LPS: x to the left, y to the back, z up) becomes (x, z, -y) / 1000.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber {

inline glm::dvec3 gltf_from_lps(const glm::dvec3& p) { return glm::dvec3(p.x, p.z, -p.y) / 1000.0; }
inline glm::dquat gltf_from_lps(const glm::dquat& q) { return {q.w, q.x, q.z, -q.y}; }

class GlbData {
 public:
  enum class Use { Any, Vertices, Indices };
  struct Accessor {
    std::size_t offset, bytes, count;
    int component;  // glTF's number for the type of a component [glTF 2.0, 3.6.2.2]
    std::string type;
    Use use;
    bool normalized = false;         // true: the integers stand for numbers in [0, 1]
    std::vector<float> least, most;  // least and largest value per component, if glTF requires them; empty: not written
  };

  // Appends an array to the binary data and returns the index of its accessor.
  int add(const std::vector<float>& values, Use use = Use::Any);
  int add(const std::vector<glm::vec3>& values, Use use = Use::Any);
  int add(const std::vector<glm::vec4>& values, Use use = Use::Any);
  int add(const std::vector<glm::mat4>& values, Use use = Use::Any);
  int add(const std::vector<std::array<std::uint16_t, 4>>& values, Use use = Use::Any);
  int add(const std::vector<std::uint32_t>& values, Use use = Use::Any);
  // Appends vertex positions with their least and largest values, which glTF requires. Returns the index of their
  // accessor.
  int add_places(const std::vector<glm::vec3>& places);
  Accessor& accessor(int index) { return accessors_[static_cast<std::size_t>(index)]; }

  // Returns the bytes of the .glb file. Throws Error for more than 4 GB.
  //   json  the description as a JSON object without buffers, buffer views and accessors, which this function adds
  std::string file(std::string_view json) const;

 private:
  int put(const void* values, std::size_t count, std::size_t size, int component, const char* type, Use use);

  std::string data_;
  std::vector<Accessor> accessors_;
};

// Converts a colour from sRGB to linear RGB, which glTF uses for the colours of materials.
glm::dvec3 linear_colour(const glm::vec3& colour);

}  // namespace limber
