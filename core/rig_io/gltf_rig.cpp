// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/gltf_rig.h"

#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>

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
  std::string_view inner = {};  // type of the object or objects that are this property's value, as in `owner`
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
  std::uint64_t binary_bytes = 0;
};

Chunks chunks_of_glb(const std::string& bytes, const std::string& where) {
  if (bytes.starts_with("version https://git-lfs"))
    throw Error("this is a Git LFS pointer, not the model", where, "fetch the file with git lfs pull");
  if (bytes.size() < 20 || !bytes.starts_with("glTF"))
    throw Error("this is no binary glTF", where, "export the file again");
  if (u32_at(bytes, 4) != 2)
    throw Error("this is glTF " + std::to_string(u32_at(bytes, 4)), where, "export it as glTF 2.0");
  if (u32_at(bytes, 8) > bytes.size())
    throw Error("the file is shorter than its header says", where, "copy the whole file again");
  const std::uint64_t json_bytes = u32_at(bytes, 12);
  if (bytes.compare(16, 4, "JSON") != 0 || json_bytes > bytes.size() - 20)
    throw Error("the description is not whole", where, "copy the whole file again");
  Chunks chunks{std::string_view(bytes).substr(20, json_bytes)};
  const std::uint64_t rest = 20 + json_bytes;
  if (rest + 8 <= bytes.size() && bytes.compare(rest + 4, 4, std::string("BIN\0", 4)) == 0) {
    chunks.binary_bytes = u32_at(bytes, rest);
    if (chunks.binary_bytes > bytes.size() - rest - 8)
      throw Error("the data are not whole", where, "copy the whole file again");
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
      held = chunks.binary_bytes;
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

size_t size_of(const Json& gltf, const char* list) { return gltf.contains(list) ? gltf[list].size() : 0; }

size_t index_in(const Json& gltf, const char* list, const Json& value, const std::string& what,
                const std::string& where) {
  const std::uint64_t index = value.get<std::uint64_t>();
  if (index >= size_of(gltf, list))
    throw Error(
        what + " points at number " + std::to_string(index) + " of " + std::to_string(size_of(gltf, list)) + " " + list,
        where, "export the file again");
  return index;
}

glm::dmat4 parent_from_node(const Json& node, const std::string& where) {
  auto numbers = [&](const char* key, size_t count) {
    const std::vector<double> values = node[key];
    if (values.size() != count)
      throw Error("a node's " + std::string(key) + " has not " + std::to_string(count) + " numbers", where,
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

struct Nodes {
  std::vector<int> parent;
  std::vector<glm::dvec3> place;  // position of each node's origin, LPS mm
  std::vector<size_t> order;      // all nodes, parents before their children
};

Nodes place_nodes(const Json& gltf, const std::string& where) {
  const size_t count = size_of(gltf, "nodes");
  Nodes nodes{std::vector<int>(count, -1), std::vector<glm::dvec3>(count), {}};
  for (size_t i = 0; i < count; ++i) {
    if (!gltf["nodes"][i].contains("children")) continue;
    for (const Json& child : gltf["nodes"][i]["children"]) {
      int& parent = nodes.parent[index_in(gltf, "nodes", child, "a node's child", where)];
      if (parent >= 0) throw Error("a node has two parents", where, "export the file again");
      parent = static_cast<int>(i);
    }
  }

  std::vector<glm::dmat4> world(count);
  std::vector<size_t> ready;
  for (size_t i = 0; i < count; ++i)
    if (nodes.parent[i] < 0) ready.push_back(i);
  while (!ready.empty()) {
    const size_t i = ready.back();
    ready.pop_back();
    nodes.order.push_back(i);
    const Json& node = gltf["nodes"][i];
    world[i] = (nodes.parent[i] < 0 ? glm::dmat4(1) : world[nodes.parent[i]]) * parent_from_node(node, where);
    const glm::dvec4 p = world[i][3] * 1000.0;
    nodes.place[i] = {p.x, -p.z, p.y};
    if (node.contains("children"))
      for (const Json& child : node["children"]) ready.push_back(child.get<size_t>());
  }
  if (nodes.order.size() != count) throw Error("some nodes are their own ancestors", where, "export the file again");
  return nodes;
}

// ---- Rig and counts.

Armature armature_of_skin(const Json& gltf, const Json& skin, const Nodes& nodes, const std::string& where) {
  std::vector<int> bone_of(nodes.parent.size(), -1);
  std::vector<size_t> joints;
  for (const Json& joint : skin["joints"]) {
    const size_t node = index_in(gltf, "nodes", joint, "a skin's joint", where);
    if (bone_of[node] >= 0) throw Error("a skin names a joint twice", where, "export the file again");
    bone_of[node] = static_cast<int>(joints.size());
    joints.push_back(node);
  }

  // Finds the parent bone of each node: the nearest ancestor that is a joint. Nodes between the two are not bones.
  std::vector<int> bone_above(nodes.parent.size(), -1);
  for (size_t node : nodes.order)
    if (const int parent = nodes.parent[node]; parent >= 0)
      bone_above[node] = bone_of[parent] >= 0 ? bone_of[parent] : bone_above[parent];

  std::vector<Bone> bones(joints.size());
  std::vector<glm::dvec3> sum(joints.size(), glm::dvec3(0));
  std::vector<int> children(joints.size(), 0);
  std::set<std::string> names;
  for (size_t b = 0; b < bones.size(); ++b) {
    bones[b].parent = bone_above[joints[b]];
    bones[b].head = nodes.place[joints[b]];
    const Json& node = gltf["nodes"][joints[b]];
    bones[b].name = node.contains("name") ? node["name"].get<std::string>() : "";
    if (bones[b].name.empty()) bones[b].name = "joint";
    while (!names.insert(bones[b].name).second) bones[b].name += "." + std::to_string(b);
    if (bones[b].parent >= 0) sum[bones[b].parent] += bones[b].head, ++children[bones[b].parent];
  }
  for (size_t b = 0; b < bones.size(); ++b) {
    Bone& bone = bones[b];
    bone.tail = children[b] ? sum[b] / double(children[b]) : bone.head;
    // A bone without children continues the line from its parent's head to its own head. Its length is a third of the
    // distance between these two heads.
    if (bone.tail == bone.head && bone.parent >= 0) bone.tail = bone.head + (bone.head - bones[bone.parent].head) / 3.0;
    if (bone.tail == bone.head) bone.tail = bone.head + glm::dvec3(0, 0, 10);
  }
  Armature armature = parents_first(std::move(bones), where);
  check_armature(armature, where);
  return armature;
}

std::int64_t triangles_of(std::int64_t mode, std::int64_t corners) {
  if (mode == 4) return corners / 3;
  if (mode == 5 || mode == 6) return std::max<std::int64_t>(corners - 2, 0);
  return 0;
}

void count_meshes(const Json& gltf, GltfSummary& summary, const std::string& where) {
  auto count_of = [&](const Json& accessor) -> std::int64_t {
    return gltf["accessors"][index_in(gltf, "accessors", accessor, "a mesh", where)]["count"].get<std::int64_t>();
  };
  if (!gltf.contains("meshes")) return;
  for (const Json& mesh : gltf["meshes"])
    for (const Json& primitive : mesh["primitives"]) {
      const Json& attributes = primitive["attributes"];
      const std::int64_t vertices = attributes.contains("POSITION") ? count_of(attributes["POSITION"]) : 0;
      const std::int64_t corners = primitive.contains("indices") ? count_of(primitive["indices"]) : vertices;
      summary.vertices += vertices;
      summary.triangles += triangles_of(primitive.value("mode", std::int64_t{4}), corners);
    }
}
}  // namespace

GltfSummary parse_gltf(const std::string& bytes, bool is_binary, const std::string& where) {
  try {
    const Chunks chunks = is_binary ? chunks_of_glb(bytes, where) : Chunks{bytes};
    const Json gltf = Json::parse(checked_json(std::string(chunks.json), where));
    if (!gltf.is_object()) throw Error("this is no glTF", where, "export the file again");
    check_types(gltf, "gltf", "", where);
    const std::string version = gltf["asset"]["version"];
    if (!version.starts_with("2."))
      throw Error("this is glTF " + version.substr(0, 10), where, "export it as glTF 2.0");
    check_buffers(gltf, chunks, is_binary, where);
    if (gltf.contains("scene")) index_in(gltf, "scenes", gltf["scene"], "\"scene\"", where);

    GltfSummary summary;
    summary.nodes = static_cast<int>(size_of(gltf, "nodes"));
    summary.meshes = static_cast<int>(size_of(gltf, "meshes"));
    summary.skins = static_cast<int>(size_of(gltf, "skins"));
    summary.animations = static_cast<int>(size_of(gltf, "animations"));
    count_meshes(gltf, summary, where);
    const Nodes nodes = place_nodes(gltf, where);
    if (summary.skins > 0) summary.armature = armature_of_skin(gltf, gltf["skins"][0], nodes, where);
    if (summary.skins > 1)
      summary.warnings.push_back("the file has " + std::to_string(summary.skins) +
                                 " skins; the bones are the first one's");
    return summary;
  } catch (const Json::exception& error) {
    throw Error("this is not valid JSON (" + std::string(error.what()).substr(0, 160) + ")", where,
                "export the file again");
  }
}

}  // namespace limber
