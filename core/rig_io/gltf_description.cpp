// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/gltf_description.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/base/rigid_transform.h"

namespace limber {

namespace {
using Json = nlohmann::json;

// ---- The types of the properties of glTF objects [glTF 2.0, chapter 5].

enum class Kind { Text, Number, Whole, Yes, Numbers, Wholes, Object, Objects };

struct Property {
  std::string_view owner, key;
  Kind kind;
  // Type of the object, or of the objects in the list, that is this property's value. Empty: the value is no object.
  std::string_view inner = {};
  bool required = false;
};

constexpr Property kProperties[] = {
    {"gltf", "asset", Kind::Object, "asset", true},
    {"asset", "version", Kind::Text, {}, true},
    {"asset", "generator", Kind::Text},
    {"gltf", "scene", Kind::Whole},
    {"gltf", "scenes", Kind::Objects, "scene"},
    {"gltf", "nodes", Kind::Objects, "node"},
    {"gltf", "meshes", Kind::Objects, "mesh"},
    {"gltf", "accessors", Kind::Objects, "accessor"},
    {"gltf", "bufferViews", Kind::Objects, "view"},
    {"gltf", "buffers", Kind::Objects, "buffer"},
    {"gltf", "materials", Kind::Objects, "material"},
    {"gltf", "textures", Kind::Objects, "texture"},
    {"gltf", "images", Kind::Objects, "image"},
    {"gltf", "samplers", Kind::Objects, "sampler"},
    {"gltf", "skins", Kind::Objects, "skin"},
    {"gltf", "animations", Kind::Objects, "animation"},
    {"gltf", "cameras", Kind::Objects, "camera"},
    {"scene", "nodes", Kind::Wholes},
    {"scene", "name", Kind::Text},
    {"node", "children", Kind::Wholes},
    {"node", "name", Kind::Text},
    {"node", "mesh", Kind::Whole},
    {"node", "skin", Kind::Whole},
    {"node", "camera", Kind::Whole},
    {"node", "matrix", Kind::Numbers},
    {"node", "translation", Kind::Numbers},
    {"node", "rotation", Kind::Numbers},
    {"node", "scale", Kind::Numbers},
    {"node", "weights", Kind::Numbers},
    {"mesh", "primitives", Kind::Objects, "primitive", true},
    {"mesh", "name", Kind::Text},
    {"mesh", "weights", Kind::Numbers},
    {"primitive", "attributes", Kind::Object, "attributes", true},
    {"primitive", "indices", Kind::Whole},
    {"primitive", "mode", Kind::Whole},
    {"primitive", "material", Kind::Whole},
    {"primitive", "targets", Kind::Objects},
    {"attributes", "POSITION", Kind::Whole},
    {"attributes", "NORMAL", Kind::Whole},
    {"attributes", "JOINTS_0", Kind::Whole},
    {"attributes", "WEIGHTS_0", Kind::Whole},
    {"accessor", "bufferView", Kind::Whole},
    {"accessor", "byteOffset", Kind::Whole},
    {"accessor", "componentType", Kind::Whole, {}, true},
    {"accessor", "count", Kind::Whole, {}, true},
    {"accessor", "type", Kind::Text, {}, true},
    {"accessor", "min", Kind::Numbers},
    {"accessor", "max", Kind::Numbers},
    {"accessor", "normalized", Kind::Yes},
    {"accessor", "sparse", Kind::Object},
    {"view", "buffer", Kind::Whole, {}, true},
    {"view", "byteOffset", Kind::Whole},
    {"view", "byteLength", Kind::Whole, {}, true},
    {"view", "byteStride", Kind::Whole},
    {"view", "target", Kind::Whole},
    {"buffer", "byteLength", Kind::Whole, {}, true},
    {"buffer", "uri", Kind::Text},
    {"material", "name", Kind::Text},
    {"material", "pbrMetallicRoughness", Kind::Object, "pbr"},
    {"material", "normalTexture", Kind::Object, "texture_info"},
    {"material", "occlusionTexture", Kind::Object, "texture_info"},
    {"material", "emissiveTexture", Kind::Object, "texture_info"},
    {"material", "emissiveFactor", Kind::Numbers},
    {"material", "alphaMode", Kind::Text},
    {"material", "alphaCutoff", Kind::Number},
    {"material", "doubleSided", Kind::Yes},
    {"pbr", "baseColorFactor", Kind::Numbers},
    {"pbr", "baseColorTexture", Kind::Object, "texture_info"},
    {"pbr", "metallicFactor", Kind::Number},
    {"pbr", "roughnessFactor", Kind::Number},
    {"pbr", "metallicRoughnessTexture", Kind::Object, "texture_info"},
    {"texture_info", "index", Kind::Whole},
    {"texture_info", "texCoord", Kind::Whole},
    {"texture_info", "scale", Kind::Number},
    {"texture_info", "strength", Kind::Number},
    {"texture", "sampler", Kind::Whole},
    {"texture", "source", Kind::Whole},
    {"texture", "name", Kind::Text},
    {"image", "uri", Kind::Text},
    {"image", "mimeType", Kind::Text},
    {"image", "bufferView", Kind::Whole},
    {"image", "name", Kind::Text},
    {"sampler", "magFilter", Kind::Whole},
    {"sampler", "minFilter", Kind::Whole},
    {"sampler", "wrapS", Kind::Whole},
    {"sampler", "wrapT", Kind::Whole},
    {"skin", "joints", Kind::Wholes, {}, true},
    {"skin", "inverseBindMatrices", Kind::Whole},
    {"skin", "skeleton", Kind::Whole},
    {"skin", "name", Kind::Text},
    {"animation", "channels", Kind::Objects, "channel", true},
    {"animation", "samplers", Kind::Objects, "curve", true},
    {"animation", "name", Kind::Text},
    {"channel", "sampler", Kind::Whole, {}, true},
    {"channel", "target", Kind::Object, "target", true},
    {"target", "node", Kind::Whole},
    {"target", "path", Kind::Text, {}, true},
    {"curve", "input", Kind::Whole, {}, true},
    {"curve", "output", Kind::Whole, {}, true},
    {"curve", "interpolation", Kind::Text},
    {"camera", "type", Kind::Text},
    {"camera", "name", Kind::Text},
};

bool all_of(const Json& list, auto&& holds) {
  for (const Json& one : list)
    if (!holds(one)) return false;
  return true;
}

bool is_whole(const Json& value) {
  return value.is_number_integer() && (value.is_number_unsigned() || value.get<std::int64_t>() >= 0) &&
         value.get<std::uint64_t>() <= std::uint64_t{1} << 53;
}

bool has_kind(const Json& value, Kind kind) {
  auto is_number = [](const Json& v) { return v.is_number(); };
  auto is_object = [](const Json& v) { return v.is_object(); };
  switch (kind) {
    case Kind::Text: return value.is_string();
    case Kind::Number: return value.is_number();
    case Kind::Whole: return is_whole(value);
    case Kind::Yes: return value.is_boolean();
    case Kind::Numbers: return value.is_array() && all_of(value, is_number);
    case Kind::Wholes: return value.is_array() && all_of(value, is_whole);
    case Kind::Object: return value.is_object();
    case Kind::Objects: return value.is_array() && all_of(value, is_object);
  }
  return false;
}

constexpr std::string_view kind_name(Kind kind) {
  constexpr std::string_view kNames[] = {"a text",        "a number",          "a whole number",
                                         "true or false", "a list of numbers", "a list of whole numbers",
                                         "an object",     "a list of objects"};
  return kNames[static_cast<int>(kind)];
}

// Checks that the properties of an object have the types of kProperties. Throws Error if not.
//   owner  type of the object, as in kProperties
//   place  path of the object in the file, such as meshes[0].primitives
void check_types(const Json& object, std::string_view owner, const std::string& place, const std::string& where) {
  for (const Property& property : kProperties) {
    if (property.owner != owner) continue;
    const std::string key(property.key), here = place.empty() ? key : place + "." + key;
    const auto found = object.find(key);
    if (found == object.end()) {
      if (property.required) throw Error("\"" + here + "\" is missing", where, "export the file again");
      continue;
    }
    if (!has_kind(*found, property.kind))
      throw Error("\"" + here + "\" is not " + std::string(kind_name(property.kind)), where, "export the file again");
    if (property.inner.empty()) continue;
    if (property.kind == Kind::Object) check_types(*found, property.inner, here, where);
    if (property.kind == Kind::Objects)
      for (size_t i = 0; i < found->size(); ++i)
        check_types((*found)[i], property.inner, here + "[" + std::to_string(i) + "]", where);
  }
}

// ---- The binary container (.glb).

std::uint32_t u32_at(const std::string& bytes, size_t at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

struct Chunks {
  std::string_view json;
  std::string_view binary;
};

Chunks chunks_of_glb(const std::string& bytes, const std::string& where) {
  if (bytes.starts_with("version https://git-lfs"))
    throw Error("this is a Git LFS pointer, not the model", where, "fetch the file with git lfs pull");
  if (bytes.size() < 20 || !bytes.starts_with("glTF"))
    throw Error("this is not a binary glTF file", where, "export the file again");
  if (u32_at(bytes, 4) != 2)
    throw Error("this is glTF " + std::to_string(u32_at(bytes, 4)), where, "export it as glTF 2.0");
  if (u32_at(bytes, 8) > bytes.size())
    throw Error("the file is shorter than its header says", where, "copy the whole file again");
  const std::uint64_t json_bytes = u32_at(bytes, 12);
  if (bytes.compare(16, 4, "JSON") != 0 || json_bytes > bytes.size() - 20)
    throw Error("the JSON part of the file is cut off", where, "copy the whole file again");
  Chunks chunks{std::string_view(bytes).substr(20, json_bytes)};
  const std::uint64_t rest = 20 + json_bytes;
  if (rest + 8 <= bytes.size() && bytes.compare(rest + 4, 4, std::string("BIN\0", 4)) == 0) {
    const std::uint64_t binary_bytes = u32_at(bytes, rest);
    if (binary_bytes > bytes.size() - rest - 8)
      throw Error("the binary data of the file are cut off", where, "copy the whole file again");
    chunks.binary = std::string_view(bytes).substr(rest + 8, binary_bytes);
  }
  return chunks;
}

// Checks that each buffer inside this file has all its bytes. Buffers in other files are not checked.
void check_buffers(const Json& gltf, const Chunks& chunks, bool is_binary, const std::string& where) {
  if (!gltf.contains("buffers")) return;
  for (size_t i = 0; i < gltf["buffers"].size(); ++i) {
    const Json& buffer = gltf["buffers"][i];
    std::uint64_t held = 0;
    if (buffer.contains("uri")) {
      const auto& uri = buffer["uri"].get_ref<const std::string&>();
      const size_t data = uri.starts_with("data:") ? uri.find(";base64,") : uri.npos;
      if (data == uri.npos) continue;
      std::uint64_t letters = uri.size() - data - 8;
      while (letters && uri[data + 8 + letters - 1] == '=') --letters;
      held = letters * 3 / 4;
    } else if (is_binary && i == 0) {
      held = chunks.binary.size();
    } else {
      continue;
    }
    if (held < buffer["byteLength"].get<std::uint64_t>())
      throw Error("buffer " + std::to_string(i) + " holds " + std::to_string(held) + " of " +
                      buffer["byteLength"].dump() + " bytes",
                  where, "copy the whole file again");
  }
}

// ---- Nodes of the scene.

glm::dmat4 parent_from_node(const Json& node, const std::string& where) {
  auto numbers = [&](const char* key, size_t count) {
    const std::vector<double> values = node[key];
    if (values.size() != count)
      throw Error("a node's " + std::string(key) + " does not have " + std::to_string(count) + " numbers", where,
                  "export the file again");
    return values;
  };
  glm::dmat4 matrix(1);
  if (node.contains("matrix")) {
    const auto m = numbers("matrix", 16);
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[i];
    return matrix;
  }
  if (node.contains("rotation")) {
    const auto q = numbers("rotation", 4);
    const glm::dquat turn(q[3], q[0], q[1], q[2]);
    if (glm::length(turn) > 1e-6) matrix = glm::mat4_cast(glm::normalize(turn));
  }
  if (node.contains("scale")) {
    const auto s = numbers("scale", 3);
    for (int i = 0; i < 3; ++i) matrix[i] *= s[i];
  }
  if (node.contains("translation")) {
    const auto t = numbers("translation", 3);
    matrix[3] = {t[0], t[1], t[2], 1};
  }
  return matrix;
}

size_t size_of(const Json& gltf, const char* list) { return gltf.contains(list) ? gltf[list].size() : 0; }

// Returns the index that the property `key` of `object` contains, or -1 without the property. Throws Error if `list`
// has no element with this index.
//   what  names the property in the message
std::int64_t reference(const Json& gltf, const Json& object, const char* key, const char* list, const std::string& what,
                       const std::string& where) {
  if (!object.contains(key)) return -1;
  const std::uint64_t index = object[key].get<std::uint64_t>();
  check_gltf_index(index, size_of(gltf, list), what, list, where);
  return static_cast<std::int64_t>(index);
}

void find_parents(const Json& gltf, GltfDescription& description, const std::string& where) {
  const size_t count = description.nodes.size();
  for (size_t i = 0; i < count; ++i) {
    if (!gltf["nodes"][i].contains("children")) continue;
    for (const Json& child : gltf["nodes"][i]["children"]) {
      check_gltf_index(child.get<std::uint64_t>(), count, "a node's child", "nodes", where);
      int& parent = description.nodes[child.get<size_t>()].parent;
      if (parent >= 0) throw Error("a node has two parents", where, "export the file again");
      parent = static_cast<int>(i);
    }
  }
}

// Marks the nodes that the default scene lists. Without scenes, it marks every node that has no parent.
void mark_scene(const Json& gltf, GltfDescription& description, const std::string& where) {
  const std::int64_t scene = std::max<std::int64_t>(reference(gltf, gltf, "scene", "scenes", "\"scene\"", where), 0);
  if (size_of(gltf, "scenes") == 0) {
    for (GltfDescription::Node& node : description.nodes) node.is_in_scene = node.parent < 0;
  } else if (gltf["scenes"][scene].contains("nodes")) {
    for (const Json& root : gltf["scenes"][scene]["nodes"]) {
      check_gltf_index(root.get<std::uint64_t>(), description.nodes.size(), "a scene", "nodes", where);
      description.nodes[root.get<size_t>()].is_in_scene = true;
    }
  }
}

void read_nodes(const Json& gltf, GltfDescription& description, const std::string& where) {
  std::vector<GltfDescription::Node>& nodes = description.nodes;
  nodes.resize(size_of(gltf, "nodes"));
  find_parents(gltf, description, where);
  mark_scene(gltf, description, where);

  std::vector<size_t> ready;
  for (size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].parent < 0) ready.push_back(i);
  while (!ready.empty()) {
    const size_t i = ready.back();
    ready.pop_back();
    description.order.push_back(i);
    const Json& json = gltf["nodes"][i];
    GltfDescription::Node& node = nodes[i];
    node.name = json.value("name", "");
    node.mesh = reference(gltf, json, "mesh", "meshes", "a node", where);
    node.world_from_node = parent_from_node(json, where);
    if (node.parent >= 0) {
      node.world_from_node = nodes[node.parent].world_from_node * node.world_from_node;
      node.is_in_scene |= nodes[node.parent].is_in_scene;
    }
    if (json.contains("children"))
      for (const Json& child : json["children"]) ready.push_back(child.get<size_t>());
  }
  if (description.order.size() != nodes.size())
    throw Error("some nodes are their own ancestors", where, "export the file again");
}

// ---- Meshes, and where their data are.

void read_meshes(const Json& gltf, GltfDescription& description, const std::string& where) {
  if (!gltf.contains("meshes")) return;
  for (const Json& mesh : gltf["meshes"]) {
    std::vector<GltfDescription::Primitive>& primitives = description.meshes.emplace_back();
    for (const Json& json : mesh["primitives"])
      primitives.push_back({.positions = reference(gltf, json["attributes"], "POSITION", "accessors", "a mesh", where),
                            .indices = reference(gltf, json, "indices", "accessors", "a mesh", where),
                            .mode = json.value("mode", std::int64_t{4})});
  }
}

void read_data(const Json& gltf, GltfDescription& description, const std::string& where) {
  constexpr std::uint64_t kNone = 0;
  if (gltf.contains("accessors"))
    for (const Json& json : gltf["accessors"])
      description.accessors.push_back({.view = reference(gltf, json, "bufferView", "bufferViews", "an accessor", where),
                                       .offset = json.value("byteOffset", kNone),
                                       .count = json["count"].get<std::uint64_t>(),
                                       .component = json["componentType"].get<std::int64_t>(),
                                       .type = json["type"].get<std::string>(),
                                       .is_sparse = json.contains("sparse")});
  if (gltf.contains("bufferViews"))
    for (const Json& json : gltf["bufferViews"])
      description.views.push_back({.buffer = reference(gltf, json, "buffer", "buffers", "a buffer view", where),
                                   .offset = json.value("byteOffset", kNone),
                                   .bytes = json["byteLength"].get<std::uint64_t>(),
                                   .stride = json.value("byteStride", kNone)});
  if (gltf.contains("buffers"))
    for (const Json& json : gltf["buffers"])
      description.buffers.push_back({.bytes = json["byteLength"].get<std::uint64_t>(), .uri = json.value("uri", "")});
}
}  // namespace

void check_gltf_index(std::uint64_t index, std::size_t size, const std::string& what, const char* list,
                      const std::string& where) {
  if (index >= size)
    throw Error(what + " refers to number " + std::to_string(index) + ", but there are only " + std::to_string(size) +
                    " " + list,
                where, "export the file again");
}

GltfDescription parse_gltf_description(const std::string& bytes, bool is_binary, const std::string& where) {
  try {
    const Chunks chunks = is_binary ? chunks_of_glb(bytes, where) : Chunks{bytes};
    const Json gltf = Json::parse(checked_json(std::string(chunks.json), where));
    if (!gltf.is_object()) throw Error("this is not a glTF file", where, "export the file again");
    check_types(gltf, "gltf", "", where);
    const std::string version = gltf["asset"]["version"];
    if (!version.starts_with("2."))
      throw Error("this is glTF " + version.substr(0, 10), where, "export it as glTF 2.0");
    check_buffers(gltf, chunks, is_binary, where);

    GltfDescription description;
    description.binary = chunks.binary;
    read_meshes(gltf, description, where);
    read_data(gltf, description, where);
    read_nodes(gltf, description, where);
    description.animations = size_of(gltf, "animations");
    if (gltf.contains("skins"))
      for (const Json& skin : gltf["skins"])
        description.skins.push_back(skin["joints"].get<std::vector<std::uint64_t>>());
    return description;
  } catch (const Json::exception& error) {
    throw Error("this is not valid JSON (" + std::string(error.what()).substr(0, 160) + ")", where,
                "export the file again");
  }
}

}  // namespace limber
