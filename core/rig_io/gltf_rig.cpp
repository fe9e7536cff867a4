// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/gltf_rig.h"

#include <set>

#include "core/base/error.h"
#include "core/rig_io/gltf_description.h"

namespace limber {

namespace {
Armature armature_of_skin(const GltfDescription& gltf, const std::vector<std::uint64_t>& skin,
                          const std::string& where) {
  std::vector<int> bone_of(gltf.nodes.size(), -1);
  std::vector<size_t> joints;
  for (const std::uint64_t node : skin) {
    check_gltf_index(node, gltf.nodes.size(), "a skin's joint", "nodes", where);
    if (bone_of[node] >= 0) throw Error("a skin names a joint twice", where, "export the file again");
    bone_of[node] = static_cast<int>(joints.size());
    joints.push_back(node);
  }

  // Finds the parent bone of each node: the nearest ancestor that is a joint. Nodes between the two are not bones.
  std::vector<int> bone_above(gltf.nodes.size(), -1);
  for (size_t node : gltf.order)
    if (const int parent = gltf.nodes[node].parent; parent >= 0)
      bone_above[node] = bone_of[parent] >= 0 ? bone_of[parent] : bone_above[parent];

  std::vector<Bone> bones(joints.size());
  std::vector<glm::dvec3> sum(joints.size(), glm::dvec3(0));
  std::vector<int> children(joints.size(), 0);
  std::set<std::string> names;
  for (size_t b = 0; b < bones.size(); ++b) {
    bones[b].parent = bone_above[joints[b]];
    const GltfDescription::Node& node = gltf.nodes[joints[b]];
    bones[b].head = lps_from_gltf(node.world_from_node[3]);
    bones[b].name = node.name;
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

void count_meshes(const GltfDescription& gltf, GltfSummary& summary) {
  auto count_of = [&](std::int64_t accessor) -> std::int64_t {
    return accessor < 0 ? 0 : static_cast<std::int64_t>(gltf.accessors[accessor].count);
  };
  for (const auto& mesh : gltf.meshes)
    for (const GltfDescription::Primitive& primitive : mesh) {
      const std::int64_t vertices = count_of(primitive.positions);
      summary.vertices += vertices;
      summary.triangles +=
          triangles_of(primitive.mode, primitive.indices >= 0 ? count_of(primitive.indices) : vertices);
    }
}
}  // namespace

GltfSummary parse_gltf(const std::string& bytes, bool is_binary, const std::string& where) {
  const GltfDescription gltf = parse_gltf_description(bytes, is_binary, where);
  GltfSummary summary;
  summary.nodes = static_cast<int>(gltf.nodes.size());
  summary.meshes = static_cast<int>(gltf.meshes.size());
  summary.skins = static_cast<int>(gltf.skins.size());
  summary.animations = static_cast<int>(gltf.animations);
  count_meshes(gltf, summary);
  if (summary.skins > 0) summary.armature = armature_of_skin(gltf, gltf.skins[0], where);
  if (summary.skins > 1)
    summary.warnings.push_back("the file has " + std::to_string(summary.skins) +
                               " skins; the bones of the first skin are used");
  return summary;
}

}  // namespace limber
