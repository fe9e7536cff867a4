// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/surface_files.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/output_files.h"
#include "core/base/text_parse.h"
#include "core/export/exporter.h"
#include "core/export/glb_writer.h"

namespace limber {

namespace {
static_assert(std::endian::native == std::endian::little,
              "files are written in native byte order and say little endian");

std::string extension_of(const Path& path) { return lower_case(path.extension().string()); }

std::string title_of(const LabelSurface& surface, const TissueTable& tissues) {
  const Tissue* tissue = tissues.find(surface.label);
  return tissue && !tissue->name.empty() ? tissue->name
                                         : "label " + text_of(tissue ? tissue->file_value : surface.label);
}

// Returns a unique name for each surface, of letters, digits and underscores, so that it can be part of a file name and
// the name of a group in an OBJ file.
std::vector<std::string> words_for(const LabelSurfaces& all, const TissueTable& tissues) {
  std::vector<std::string> words;
  std::set<std::string> used;
  for (const LabelSurface& surface : all.surfaces) {
    std::string word;
    for (const char c : title_of(surface, tissues).substr(0, 100))
      word += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
    if (!used.insert(lower_case(word)).second) used.insert(lower_case(word += "_" + std::to_string(surface.label)));
    words.push_back(std::move(word));
  }
  return words;
}

template <class Value>
void put(std::string& bytes, const Value& value) {
  char raw[sizeof(Value)];
  std::memcpy(raw, &value, sizeof(Value));
  bytes.append(raw, sizeof(Value));
}
void put(std::string& bytes, const glm::vec3& v) {
  for (int i = 0; i < 3; ++i) put(bytes, v[i]);
}

std::string stl(const LabelSurfaces& all, const LabelSurface& surface, const std::string& title) {
  std::string bytes = ("Limber, mm, LPS: " + title).substr(0, 80);
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(surface.F.size()));
  for (const glm::ivec3& f : surface.F) {
    const glm::dvec3 a = all.V[surface.vertex[f.x]], b = all.V[surface.vertex[f.y]], c = all.V[surface.vertex[f.z]],
                     area = glm::cross(b - a, c - a);
    const double length = glm::length(area);
    put(bytes, length > 0 ? glm::vec3(area / length) : glm::vec3(0));
    for (const glm::dvec3& corner : {a, b, c}) put(bytes, glm::vec3(corner));
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ply(const LabelSurfaces& all, const LabelSurface& surface, const std::string& title,
                const glm::vec3& colour) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment " + title + ", mm, LPS\nelement vertex " +
                      std::to_string(surface.vertex.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar "
                      "green\nproperty uchar blue\nelement face " +
                      std::to_string(surface.F.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const int vertex : surface.vertex) {
    for (int i = 0; i < 3; ++i) put(bytes, all.V[vertex][i]);
    for (int i = 0; i < 3; ++i) put(bytes, static_cast<std::uint8_t>(std::lround(255 * colour[i])));
  }
  for (const glm::ivec3& f : surface.F) {
    put(bytes, std::uint8_t{3});
    for (int i = 0; i < 3; ++i) put(bytes, std::int32_t{f[i]});
  }
  return bytes;
}

// Returns the text of an OBJ file. A vertex that several surfaces share is written once. If two vertices of one surface
// are at the same position, both are written, so that the surface's parts stay separate there.
std::string obj(const LabelSurfaces& all, const std::vector<std::string>& names) {
  std::string text = "# surfaces of tissues, mm, LPS; neighbours share their vertices\n", faces;
  const auto line = [&](const glm::dvec3& v) {
    text += "v " + text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z) + "\n";
  };
  std::vector<int> number_of(all.V.size(), 0);
  int count = 0;
  for (std::size_t s = 0; s < all.surfaces.size(); ++s) {
    const LabelSurface& surface = all.surfaces[s];
    std::vector<bool> met(all.V.size());
    std::vector<int> number(surface.vertex.size());
    for (std::size_t i = 0; i < surface.vertex.size(); ++i) {
      const int vertex = surface.vertex[i];
      const bool again = met[vertex];
      met[vertex] = true;
      if (again || number_of[vertex] == 0) {
        line(all.V[vertex]);
        number[i] = ++count;
        if (!again) number_of[vertex] = count;
      } else {
        number[i] = number_of[vertex];
      }
    }
    faces += "g " + names[s] + "\n";
    for (const glm::ivec3& f : surface.F)
      faces += "f " + std::to_string(number[f.x]) + " " + std::to_string(number[f.y]) + " " +
               std::to_string(number[f.z]) + "\n";
  }
  return text + faces;
}
std::vector<glm::vec3> places_of(const LabelSurfaces& all, const LabelSurface& surface) {
  std::vector<glm::vec3> places;
  for (const int vertex : surface.vertex) places.emplace_back(gltf_from_lps(all.V[vertex]));
  return places;
}

// Returns the unit normal of each vertex: the mean of the normals of its triangles, weighted by area.
std::vector<glm::vec3> normals_of(const std::vector<glm::vec3>& places, const LabelSurface& surface) {
  std::vector<glm::vec3> normals(places.size(), glm::vec3(0));
  for (const glm::ivec3& f : surface.F) {
    const glm::vec3 area = glm::cross(places[f.y] - places[f.x], places[f.z] - places[f.x]);
    for (int i = 0; i < 3; ++i) normals[f[i]] += area;
  }
  for (glm::vec3& normal : normals) {
    const float length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
  }
  return normals;
}

// Returns the bytes of a .glb file (glTF) with a node, a mesh and a material per surface. The `extras` of a node
// contain the label's value in the user's files.
std::string glb(const LabelSurfaces& all, const TissueTable& tissues) {
  using Json = nlohmann::ordered_json;
  GlbData data;
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "Limber"}}},
               {"scene", 0},
               {"scenes", Json::array({{{"nodes", Json::array()}}})}};
  for (const LabelSurface& surface : all.surfaces) {
    const Tissue* tissue = tissues.find(surface.label);
    const std::string name = title_of(surface, tissues);
    const std::vector<glm::vec3> places = places_of(all, surface);
    std::vector<std::uint32_t> corners;
    for (const glm::ivec3& f : surface.F)
      for (int i = 0; i < 3; ++i) corners.push_back(static_cast<std::uint32_t>(f[i]));
    const glm::dvec3 colour = linear_colour(tissue ? tissue->colour : glm::vec3(0.7f));
    const Json attributes = {{"POSITION", data.add_places(places)},
                             {"NORMAL", data.add(normals_of(places, surface), GlbData::Use::Vertices)}};
    const std::size_t number = json["scenes"][0]["nodes"].size();
    json["meshes"].push_back({{"name", name},
                              {"primitives", Json::array({{{"attributes", attributes},
                                                           {"indices", data.add(corners, GlbData::Use::Indices)},
                                                           {"material", number}}})}});
    json["materials"].push_back({{"name", name},
                                 {"pbrMetallicRoughness",
                                  {{"baseColorFactor", {colour.r, colour.g, colour.b, 1.0}},
                                   {"metallicFactor", 0.0},
                                   {"roughnessFactor", 0.8}}}});
    json["nodes"].push_back(
        {{"name", name}, {"mesh", number}, {"extras", {{"label", tissue ? tissue->file_value : surface.label}}}});
    json["scenes"][0]["nodes"].push_back(number);
  }
  return data.file(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

bool is_one_file(const Path& path) { return extension_of(path) == ".obj" || extension_of(path) == ".glb"; }
}  // namespace

bool is_surface_path(const Path& path) {
  const std::string extension = extension_of(path);
  return is_one_file(path) || extension == ".stl" || extension == ".ply";
}

std::vector<Path> surface_paths(const LabelSurfaces& all, const TissueTable& tissues, const Path& path) {
  if (is_one_file(path)) return {path};
  std::vector<Path> paths;
  for (const std::string& word : words_for(all, tissues))
    paths.push_back(path.parent_path() / (path.stem().string() + "-" + word + path.extension().string()));
  return paths;
}

void write_surfaces(const LabelSurfaces& all, const TissueTable& tissues, const Path& path) {
  if (!is_surface_path(path))
    throw Error("surfaces cannot be written with this extension", path.string(), std::string("use ") + kSurfaceEndings);
  if (extension_of(path) == ".obj") return write_file_atomically(path, obj(all, words_for(all, tissues)));
  if (extension_of(path) == ".glb") return write_file_atomically(path, glb(all, tissues));
  const std::vector<Path> paths = surface_paths(all, tissues, path);
  for (std::size_t s = 0; s < paths.size(); ++s) {
    const LabelSurface& surface = all.surfaces[s];
    const Tissue* tissue = tissues.find(surface.label);
    const std::string title = title_of(surface, tissues);
    std::string plain;
    for (const char c : title) plain += c >= ' ' && c <= '~' ? c : '?';
    write_file_atomically(paths[s], extension_of(path) == ".stl"
                                        ? stl(all, surface, plain)
                                        : ply(all, surface, plain, tissue ? tissue->colour : glm::vec3(0.7f)));
  }
}

Exporter surface_exporter() {
  return {.name = "Surfaces",
          .endings = {".obj", ".stl", ".ply", ".glb"},
          .write = [](const ExportInput& input, const Path& path) {
            const LabelSurfaces all = label_surfaces(input.volume, {}, input.progress);
            if (all.surfaces.empty())
              throw Error("the volume has no tissue", path.string(), "export a volume with labels other than 0");
            Outputs outputs;
            outputs.expect(surface_paths(all, input.tissues, path));
            write_surfaces(all, input.tissues, path);
            outputs.complete();
          }};
}

}  // namespace limber
