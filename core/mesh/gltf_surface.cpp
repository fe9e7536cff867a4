// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the triangles of the default scene of a glTF 2.0 file: triangle lists, strips and fans. Points and lines are
// skipped.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "core/mesh/surface_file.h"
#include "core/mesh/surface_formats.h"
#include "core/rig_io/gltf_description.h"

namespace limber {

namespace {
using Triangles = std::vector<std::array<glm::vec3, 3>>;

constexpr const char* kAgain = "export the file again";

std::string bytes_of_base64(std::string_view text) {
  std::string bytes;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    int digit;
    if (c >= 'A' && c <= 'Z') digit = c - 'A';
    else if (c >= 'a' && c <= 'z') digit = c - 'a' + 26;
    else if (c >= '0' && c <= '9') digit = c - '0' + 52;
    else if (c == '+' || c == '/') digit = c == '+' ? 62 : 63;
    else break;  // "=" at the end, or not Base64; the missing bytes are reported later
    word = word << 6 | static_cast<std::uint32_t>(digit);
    if ((bits += 6) >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 255);
  }
  return bytes;
}

// Returns the text of a URI, with escapes such as %20 replaced by their characters.
std::string decoded_uri(const std::string& uri) {
  const auto hex = [&](std::size_t i) {
    const std::string_view digits = "0123456789abcdef";
    return i < uri.size() ? digits.find(lower_case(uri.substr(i, 1))) : digits.npos;
  };
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && hex(i + 1) < 16 && hex(i + 2) < 16) {
      text += static_cast<char>(hex(i + 1) * 16 + hex(i + 2));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

// The elements of an accessor: `count` of them, `stride` bytes apart, all inside `bytes`.
struct GltfElements {
  std::string_view bytes;
  std::uint64_t count = 0, stride = 0, size = 0;

  std::string_view operator[](std::uint64_t i) const { return bytes.substr(i * stride, size); }
};

class GltfSurface {
 public:
  GltfSurface(const std::string& bytes, bool is_binary, const Path& folder, SurfaceSoup& soup)
      : gltf_(parse_gltf_description(bytes, is_binary, soup.file())),
        folder_(folder),
        soup_(soup) {}

  void read() {
    std::uint64_t number = 0;
    soup_.place = [&number] { return ", mesh " + std::to_string(number); };
    for (const GltfDescription::Node& node : gltf_.nodes) {
      if (!node.is_in_scene || node.mesh < 0) continue;
      number = static_cast<std::uint64_t>(node.mesh);
      auto [mesh, is_new] = meshes_.try_emplace(node.mesh);
      if (is_new)
        for (const GltfDescription::Primitive& primitive : gltf_.meshes[number]) add_primitive(primitive, mesh->second);
      place_mesh(mesh->second, node.world_from_node);
    }
    soup_.place = [] { return std::string(); };
  }

 private:
  void place_mesh(const Triangles& triangles, const glm::dmat4& world_from_node) {
    soup_.check_triangles(soup_.triangles().size() + triangles.size());
    // A mirroring transform reverses the order of a triangle's corners, so the outside stays outside [glTF 2.0, 3.7.4].
    const bool is_mirrored = glm::determinant(glm::dmat3(world_from_node)) < 0;
    for (const auto& triangle : triangles) {
      const int first = static_cast<int>(soup_.points().size());
      for (const glm::vec3& corner : triangle)
        soup_.add_point(lps_from_gltf(glm::dvec3(world_from_node * glm::dvec4(corner, 1))));
      soup_.add_triangle(is_mirrored ? glm::ivec3(first, first + 2, first + 1)
                                     : glm::ivec3(first, first + 1, first + 2));
    }
  }

  void add_primitive(const GltfDescription::Primitive& primitive, Triangles& triangles) {
    const bool is_list = primitive.mode == 4, is_strip = primitive.mode == 5, is_fan = primitive.mode == 6;
    if (primitive.positions < 0 || !(is_list || is_strip || is_fan)) return;
    const GltfElements positions = positions_of(gltf_.accessors[primitive.positions]);
    std::optional<GltfElements> indices;
    if (primitive.indices >= 0) indices = indices_of(gltf_.accessors[primitive.indices]);

    const std::uint64_t corners = indices ? indices->count : positions.count;
    const std::uint64_t count = is_list ? corners / 3 : corners < 3 ? 0 : corners - 2;
    soup_.check_triangles(soup_.triangles().size() + triangles.size() + count);
    for (std::uint64_t t = 0; t < count; ++t) {
      std::array<std::uint64_t, 3> f = {t, t + 1, t + 2};
      if (is_list) f = {3 * t, 3 * t + 1, 3 * t + 2};
      else if (is_fan) f[0] = 0;
      else if (t % 2 == 1) std::swap(f[1], f[2]);
      auto& triangle = triangles.emplace_back();
      for (int i = 0; i < 3; ++i) triangle[i] = position(positions, indices ? index(*indices, f[i]) : f[i]);
    }
  }

  glm::vec3 position(const GltfElements& positions, std::uint64_t i) const {
    if (i >= positions.count)
      soup_.refuse("a triangle names vertex " + std::to_string(i) + ", which is not one of the " +
                       std::to_string(positions.count) + " vertices",
                   kAgain);
    glm::vec3 p;
    std::memcpy(&p, positions[i].data(), sizeof p);
    return p;
  }

  static std::uint64_t index(const GltfElements& indices, std::uint64_t i) {
    std::uint32_t value = 0;
    std::memcpy(&value, indices[i].data(), indices.size);
    return value;
  }

  GltfElements positions_of(const GltfDescription::Accessor& accessor) {
    if (accessor.type != "VEC3" || accessor.component != 5126)
      soup_.refuse("the positions are not three floats", "export the file without compression and quantization");
    return elements_of(accessor, sizeof(glm::vec3));
  }

  GltfElements indices_of(const GltfDescription::Accessor& accessor) {
    const std::uint64_t size = accessor.component == 5121   ? 1
                               : accessor.component == 5123 ? 2
                               : accessor.component == 5125 ? 4
                                                            : 0;
    if (accessor.type != "SCALAR" || size == 0) soup_.refuse("the indices are not unsigned whole numbers", kAgain);
    return elements_of(accessor, size);
  }

  GltfElements elements_of(const GltfDescription::Accessor& accessor, std::uint64_t size) {
    if (accessor.is_sparse)
      soup_.refuse("a sparse accessor cannot be read", "export the file without sparse accessors");
    if (accessor.view < 0) soup_.refuse("an accessor has no data", "export the file without compression");
    const GltfDescription::View& view = gltf_.views[accessor.view];
    const std::string_view buffer = buffer_of(view.buffer);
    GltfElements elements{{}, accessor.count, view.stride > 0 ? view.stride : size, size};
    // Each comparison limits the numbers in the next one, so that none of them overflows.
    const bool fits =
        view.bytes <= buffer.size() && view.offset <= buffer.size() - view.bytes && accessor.offset <= view.bytes &&
        elements.stride >= size && (accessor.count <= 1 || elements.stride <= view.bytes) &&
        accessor.count <= view.bytes &&
        (accessor.count == 0 || elements.stride * (accessor.count - 1) + size <= view.bytes - accessor.offset);
    if (!fits) soup_.refuse("an accessor lies outside its data", "copy the whole file again, or export it again");
    elements.bytes = buffer.substr(view.offset + accessor.offset, view.bytes - accessor.offset);
    return elements;
  }

  std::string_view buffer_of(std::int64_t number) {
    const GltfDescription::Buffer& buffer = gltf_.buffers[number];
    if (buffer.uri.empty()) {
      if (number > 0 || gltf_.binary.empty())
        soup_.refuse("a buffer has no data", "export the file without compression");
      return gltf_.binary;
    }
    auto [found, is_new] = buffers_.try_emplace(number);
    if (is_new) {
      found->second = loaded(buffer);
      loaded_bytes_ += found->second.size();
      if (found->second.size() < buffer.bytes)
        soup_.refuse("a buffer has only " + std::to_string(found->second.size()) + " of its " +
                         std::to_string(buffer.bytes) + " bytes",
                     "copy its file again, or export it again");
    }
    return found->second;
  }

  std::string loaded(const GltfDescription::Buffer& buffer) const {
    if (buffer.uri.starts_with("data:")) {
      const std::size_t data = buffer.uri.find(";base64,");
      if (data == buffer.uri.npos) soup_.refuse("a buffer's data are not in Base64", kAgain);
      return bytes_of_base64(std::string_view(buffer.uri).substr(data + 8));
    }
    const Path file = decoded_uri(buffer.uri);
    bool is_below =
        file.is_relative() && buffer.uri.find(':') == buffer.uri.npos && file.native().find('\0') == std::string::npos;
    for (const Path& part : file) is_below &= part != "..";
    if (!is_below)
      soup_.refuse("a buffer is in the file " + in_quotes(buffer.uri) + ", which cannot be read from this place",
                   "put the file beside the .gltf, or export a .glb");
    return read_file(folder_ / file, kMostSurfaceBytes - std::min(loaded_bytes_, kMostSurfaceBytes));
  }

  const GltfDescription gltf_;
  const Path folder_;
  SurfaceSoup& soup_;
  std::map<std::int64_t, Triangles> meshes_;     // meshes read so far, without their nodes' transforms
  std::map<std::int64_t, std::string> buffers_;  // buffers read so far from other files or from Base64
  std::uint64_t loaded_bytes_ = 0;
};
}  // namespace

void read_gltf(const std::string& bytes, bool is_binary, const Path& folder, SurfaceSoup& soup) {
  GltfSurface(bytes, is_binary, folder, soup).read();
}

}  // namespace limber
