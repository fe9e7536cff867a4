// SPDX-License-Identifier: AGPL-3.0-or-later
// The container of glTF 2.0 in one file (.glb): a description in JSON, and numbers that it points to by accessors.
//
// glTF is right-handed, in metres, with Y up and the front towards +Z: the world's (x, y, z) in LPS mm becomes (x, z,
// -y) / 1000.
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
    int component;  // [glTF 2.0, 3.6.2.2]
    std::string type;
    Use use;
    bool normalized = false;         // integers stand for 0 .. 1
    std::vector<float> least, most;  // where the format wants them
  };

  // Each returns the accessor's index.
  int add(const std::vector<float>& values, Use use = Use::Any);
  int add(const std::vector<glm::vec3>& values, Use use = Use::Any);
  int add(const std::vector<glm::vec4>& values, Use use = Use::Any);
  int add(const std::vector<glm::mat4>& values, Use use = Use::Any);
  int add(const std::vector<std::array<std::uint16_t, 4>>& values, Use use = Use::Any);
  int add(const std::vector<std::uint32_t>& values, Use use = Use::Any);
  int add_places(const std::vector<glm::vec3>& places);  // of vertices: with their bounds
  Accessor& accessor(int index) { return accessors_[static_cast<std::size_t>(index)]; }

  // The bytes of the file.
  //   json    an object: all of the description but what this class knows
  //   throws Error for more than 4 GB
  std::string file(std::string_view json) const;

 private:
  int put(const void* values, std::size_t count, std::size_t size, int component, const char* type, Use use);

  std::string data_;
  std::vector<Accessor> accessors_;
};

// sRGB to what glTF's factors are.
glm::dvec3 linear_colour(const glm::vec3& colour);

}  // namespace limber
