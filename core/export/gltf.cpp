// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/gltf.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/export/glb_writer.h"
#include "core/mesh/surface.h"
#include "core/skin/weight_at.h"

namespace limber {

namespace {

using Json = nlohmann::ordered_json;

// Number of the cells from which the surface is made, along the volume's longest side; used if GltfSettings::step is 0.
constexpr double kLongestSide = 400;

// The JSON description of a .glb file and the binary data that it refers to.
struct Glb {
  Json json;
  GlbData data;
};

Json json_of(const glm::vec3& v) { return {v.x, v.y, v.z}; }
glm::vec4 curve_value(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

void check(const GltfBody& body, const TissueVoxels& tissue) {
  const bool same_bones = std::equal(body.weights.bones().begin(), body.weights.bones().end(),
                                     body.armature.bones.begin(), body.armature.bones.end(),
                                     [](const std::string& name, const Bone& bone) { return name == bone.name; });
  if (!same_bones)
    throw Error("the weights belong to another rig", "glTF export", "compute the weights again for this rig");
  if (body.weights.size() != tissue.size())
    throw Error("the weights belong to another volume", "glTF export", "compute the weights again for this volume");
}

// ---- Surface mesh

// Returns the colour (linear RGB) of the tissue to which more surface vertices belong than to any other.
Json colour_under(const std::vector<SkinAt>& skin, const TissueTable& tissues) {
  std::vector<std::int64_t> count(1 << 16, 0);
  for (const SkinAt& at : skin) ++count[at.label];
  const auto label = static_cast<Label>(std::max_element(count.begin(), count.end()) - count.begin());
  for (const Tissue& tissue : tissues.tissues)
    if (tissue.label == label) {
      const glm::dvec3 colour = linear_colour(tissue.colour);
      return {colour.r, colour.g, colour.b, 1.0};
    }
  return {0.8, 0.8, 0.8, 1.0};
}

void add_mesh(Glb& glb, const GltfBody& body, const TissueVoxels& tissue, const GltfSettings& settings,
              Progress& progress) {
  LabelSet all(std::size_t{1} << 16, 1);
  all[0] = 0;
  const glm::dvec3 extent = glm::dvec3(body.volume.grid.size) * body.volume.grid.spacing;
  const double step = settings.step > 0 ? settings.step : std::max({extent.x, extent.y, extent.z}) / kLongestSide;
  progress.update("surface", 0);
  const TriangleMesh mesh = surface_of(occupancy_of(body.volume, all, step));
  if (mesh.F.empty())
    throw Error("the volume has no surface at this step", "glTF export", "use a smaller step, or a volume with tissue");
  progress.update("surface", 0.5);
  const std::vector<SkinAt> skin = skin_at(body.volume, tissue, body.weights, mesh.V);

  std::vector<glm::vec3> places, normals;
  for (const glm::dvec3& v : mesh.V) places.emplace_back(gltf_from_lps(v));
  for (const glm::dvec3& n : vertex_normals(mesh)) normals.emplace_back(n.x, n.z, -n.y);
  std::vector<std::array<std::uint16_t, 4>> joints, weights;
  for (const SkinAt& at : skin) {
    joints.push_back(at.influence.bone);
    weights.push_back(at.influence.weight);
  }
  std::vector<std::uint32_t> corners;
  for (const glm::ivec3& f : mesh.F)
    corners.insert(corners.end(),
                   {static_cast<std::uint32_t>(f.x), static_cast<std::uint32_t>(f.y), static_cast<std::uint32_t>(f.z)});

  Json attributes;
  attributes["POSITION"] = glb.data.add_places(places);
  attributes["NORMAL"] = glb.data.add(normals, GlbData::Use::Vertices);
  attributes["JOINTS_0"] = glb.data.add(joints, GlbData::Use::Vertices);
  const int weight = glb.data.add(weights, GlbData::Use::Vertices);
  glb.data.accessor(weight).normalized = true;
  attributes["WEIGHTS_0"] = weight;
  Json primitive = {{"attributes", attributes}, {"material", 0}};
  primitive["indices"] = glb.data.add(corners, GlbData::Use::Indices);
  glb.json["meshes"] = Json::array({{{"name", "Surface"}, {"primitives", Json::array({primitive})}}});
  glb.json["materials"] = Json::array(
      {{{"name", "Tissue"},
        {"pbrMetallicRoughness",
         {{"baseColorFactor", colour_under(skin, body.tissues)}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}}});
}

// ---- Skeleton. Node b of the file is bone b. Two more nodes follow: the armature, which is the parent of the root
// bones, and the surface.

void add_skeleton(Glb& glb, const Armature& armature) {
  const std::size_t count = armature.bones.size();
  Json nodes = Json::array(), joints = Json::array(), roots = Json::array();
  std::vector<glm::mat4> bind;
  for (std::size_t b = 0; b < count; ++b) {
    const Bone& bone = armature.bones[b];
    const glm::dvec3 above = bone.parent >= 0 ? armature.bones[bone.parent].head : glm::dvec3(0);
    nodes.push_back({{"name", bone.name}, {"translation", json_of(glm::vec3(gltf_from_lps(bone.head - above)))}});
    if (bone.parent >= 0) nodes[static_cast<std::size_t>(bone.parent)]["children"].push_back(b);
    else roots.push_back(b);
    joints.push_back(b);
    glm::mat4& matrix = bind.emplace_back(1.0f);
    matrix[3] = glm::vec4(-glm::vec3(gltf_from_lps(bone.head)), 1);
  }
  nodes.push_back({{"name", "Armature"}, {"children", roots}});
  nodes.push_back({{"name", "Surface"}, {"mesh", 0}, {"skin", 0}});
  glb.json["nodes"] = nodes;
  const int matrices = glb.data.add(bind);
  glb.json["skins"] =
      Json::array({{{"name", "Armature"}, {"joints", joints}, {"skeleton", count}, {"inverseBindMatrices", matrices}}});
  glb.json["scenes"] = Json::array({{{"nodes", {count, count + 1}}}});
  glb.json["scene"] = 0;
}

// ---- Animations, one per clip

class Animation {
 public:
  Animation(Glb& glb, const std::string& name, const std::vector<float>& times)
      : glb_(glb),
        json_({{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}}) {
    times_ = glb.data.add(times);
    glb.data.accessor(times_).least = {times.front()};
    glb.data.accessor(times_).most = {times.back()};
  }
  template <class T>
  void add(std::size_t node, const char* path, const std::vector<T>& values) {
    json_["samplers"].push_back({{"input", times_}, {"output", glb_.data.add(values)}, {"interpolation", "LINEAR"}});
    json_["channels"].push_back(
        {{"sampler", json_["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }
  const Json& json() const { return json_; }

 private:
  Glb& glb_;
  Json json_;
  int times_;
};

// Returns the glTF animation of a clip. A bone that stays at rest gets no curve. If no bone moves, the last bone gets a
// curve nevertheless, since glTF does not allow an empty animation.
Json animation_of(Glb& glb, const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                  Progress& progress, double done) {
  const ClipOnRig on_rig(clip, armature);
  if (!on_rig.problem().empty())
    throw Error("the clip \"" + clip->name + "\" does not move this rig: " + on_rig.problem(), "glTF export",
                "match the clip's joints, or delete the clip");
  const int frames = std::max(0, clip->range_end - clip->range_start) + 1;
  const std::size_t count = armature->bones.size();
  std::vector<float> times;
  std::vector<std::vector<glm::dquat>> turns(count);
  std::vector<glm::dvec3> travel;
  for (int frame = 0; frame < frames; ++frame) {
    if (frame % 256 == 0) progress.update("clips", done);
    const Pose pose = on_rig.at(clip->range_start + frame);
    times.push_back(static_cast<float>(frame / clip->rate));
    for (std::size_t b = 0; b < count; ++b) {
      // The quaternions q and -q are the same rotation. Writes the one that is nearer to the previous key, so that
      // other programs interpolate in the direction of the smaller angle.
      const glm::dquat& q = pose.rotation[b];
      turns[b].push_back(!turns[b].empty() && glm::dot(q, turns[b].back()) < 0 ? -q : q);
    }
    travel.push_back(pose.root_translation);
  }

  Animation animation(glb, clip->name, times);
  const bool travels =
      std::any_of(travel.begin(), travel.end(), [](const glm::dvec3& t) { return t != glm::dvec3(0); });
  for (std::size_t b = 0; b < count; ++b) {
    const bool turned =
        std::any_of(turns[b].begin(), turns[b].end(), [](const glm::dquat& q) { return q != glm::dquat(1, 0, 0, 0); });
    if (turned || (b + 1 == count && animation.json()["channels"].empty())) {
      std::vector<glm::vec4> curve;
      for (const glm::dquat& q : turns[b]) curve.push_back(curve_value(gltf_from_lps(q)));
      animation.add(b, "rotation", curve);
    }
    if (!travels || armature->bones[b].parent >= 0) continue;
    std::vector<glm::vec3> places;
    for (const glm::dvec3& t : travel) places.emplace_back(gltf_from_lps(armature->bones[b].head + t));
    animation.add(b, "translation", places);
  }
  return animation.json();
}

}  // namespace

std::string glb_of(const GltfBody& body, const std::vector<std::shared_ptr<const Clip>>& clips,
                   const GltfSettings& settings, Progress& progress) {
  const TissueVoxels tissue(body.volume);
  check(body, tissue);
  Glb glb;
  glb.json["asset"] = {{"version", "2.0"}, {"generator", "Limber"}};
  add_mesh(glb, body, tissue, settings, progress);
  add_skeleton(glb, body.armature);
  const auto armature = std::make_shared<const Armature>(body.armature);
  for (std::size_t i = 0; i < clips.size(); ++i)
    glb.json["animations"].push_back(animation_of(glb, clips[i], armature, progress, double(i) / double(clips.size())));
  return glb.data.file(glb.json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void write_glb(const GltfBody& body, const std::vector<std::shared_ptr<const Clip>>& clips, const Path& path,
               const GltfSettings& settings, Progress& progress) {
  check_place(path);
  write_file_atomically(path, glb_of(body, clips, settings, progress));
}

}  // namespace limber
