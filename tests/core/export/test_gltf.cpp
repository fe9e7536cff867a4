// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/gltf.h"

#include <cstring>
#include <fstream>
#include <numeric>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/binding/geodesic.h"
#include "core/deform/skinning.h"
#include "core/motion/retarget.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/gltf_rig.h"
#include "core/skin/weight_at.h"
#include "tests/support/program.h"

using namespace limber;

namespace {

struct Arm {
  Phantom body = make_arm_phantom(8);
  TissueVoxels tissue{body.volume};
  SkinWeights weights =
      bind_geodesic(body.volume, tissue, body.armature, split_bones(body.volume, tissue, body.tissues, body.armature));
  std::vector<std::shared_ptr<const Clip>> clips;

  Arm() {
    Clip clip = clip_of(std::make_shared<const Motion>(body.motion), "Curl");
    clip.retarget.travel = Travel::Free;
    Clip keys{.name = "Keys \"alone\"", .rate = 24};
    Pose pose = rest_pose(body.armature);
    flex(pose, body.armature, require_bone(body.armature, "Forearm"), 70);
    pose.root_translation = {10, -20, 30};
    std::vector<int> all(body.armature.bones.size());
    std::iota(all.begin(), all.end(), 0);
    insert_key(keys.keys, body.armature, pose, all, 12);
    insert_key(keys.keys, body.armature, rest_pose(body.armature), all, 2);
    keys.range_start = 2;
    keys.range_end = 12;
    clips = {std::make_shared<const Clip>(clip), std::make_shared<const Clip>(keys)};
  }
  GltfBody gltf() const { return {body.volume, body.tissues, body.armature, weights}; }
};

const Arm& arm() {
  static const Arm body;
  return body;
}

// An independent reader, written from the glTF specification.
struct Reader {
  std::string bytes;
  nlohmann::json json;
  const char* data;

  explicit Reader(const std::string& glb) : bytes(glb) {
    std::uint32_t length;
    std::memcpy(&length, &bytes[12], 4);
    json = nlohmann::json::parse(bytes.substr(20, length));
    data = bytes.data() + 20 + length + 8;
  }
  // Returns all numbers of an accessor, one after the other.
  std::vector<double> numbers(int index) const {
    const auto& accessor = json["accessors"][index];
    const auto& view = json["bufferViews"][accessor["bufferView"].get<int>()];
    const std::map<std::string, int> width{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    const std::size_t count = accessor["count"].get<std::size_t>() * width.at(accessor["type"]);
    const char* at = data + view["byteOffset"].get<std::size_t>();
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      const int component = accessor["componentType"];
      if (component == 5126) {
        float v;
        std::memcpy(&v, at + 4 * i, 4);
        values[i] = v;
      }
      if (component == 5125) {
        std::uint32_t v;
        std::memcpy(&v, at + 4 * i, 4);
        values[i] = v;
      }
      if (component == 5123) {
        std::uint16_t v;
        std::memcpy(&v, at + 2 * i, 2);
        values[i] = accessor.value("normalized", false) ? v / 65535.0 : v;
      }
    }
    return values;
  }

  // Returns the skinned positions of all vertices at a key of an animation; -1: at rest.
  std::vector<glm::dvec3> skinned(int animation, int key) const {
    std::vector<glm::dmat4> local, world, joint;
    for (const auto& node : json["nodes"]) {
      glm::dmat4 m(1);
      if (node.contains("translation"))
        m[3] = {node["translation"][0], node["translation"][1], node["translation"][2], 1};
      local.push_back(m);
    }
    if (key >= 0)
      for (const auto& channel : json["animations"][animation]["channels"]) {
        const auto values = numbers(json["animations"][animation]["samplers"][channel["sampler"].get<int>()]["output"]);
        glm::dmat4& m = local[channel["target"]["node"].get<int>()];
        if (channel["target"]["path"] == "rotation") {
          const double* q = &values[4 * key];
          const glm::dvec4 place = m[3];
          m = glm::mat4_cast(glm::dquat(q[3], q[0], q[1], q[2]));
          m[3] = place;
        } else {
          m[3] = {values[3 * key], values[3 * key + 1], values[3 * key + 2], 1};
        }
      }
    world = local;
    for (std::size_t n = 0; n < local.size(); ++n)  // parents come before their children
      if (json["nodes"][n].contains("children") && n < json["skins"][0]["joints"].size())
        for (const int child : json["nodes"][n]["children"]) world[child] = world[n] * local[child];
    const auto bind = numbers(json["skins"][0]["inverseBindMatrices"]);
    for (std::size_t j = 0; j < json["skins"][0]["joints"].size(); ++j) {
      glm::dmat4 m;
      for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = bind[16 * j + i];
      joint.push_back(world[json["skins"][0]["joints"][j].get<int>()] * m);
    }
    const auto& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    const auto position = numbers(attributes["POSITION"]), joints = numbers(attributes["JOINTS_0"]),
               weights = numbers(attributes["WEIGHTS_0"]);
    std::vector<glm::dvec3> places;
    for (std::size_t v = 0; 3 * v < position.size(); ++v) {
      glm::dvec4 sum(0);
      for (int i = 0; i < 4; ++i)
        sum += weights[4 * v + i] * (joint[static_cast<int>(joints[4 * v + i])] *
                                     glm::dvec4(position[3 * v], position[3 * v + 1], position[3 * v + 2], 1));
      places.push_back(glm::dvec3(sum));
    }
    return places;
  }
};

}  // namespace

TEST_CASE("gltf: the surface moves in every clip as the linear blend moves the same points") {
  const Arm& body = arm();
  const Reader file(glb_of(body.gltf(), body.clips));
  CHECK(file.json["animations"].size() == 2);
  const auto rest = file.skinned(0, -1);
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& p : rest) points.push_back(1000.0 * glm::dvec3(p.x, -p.z, p.y));
  const auto skin = skin_at(body.body.volume, body.tissue, body.weights, points);
  double extent = 0, moved = 0;
  for (const glm::dvec3& p : points) extent = std::max(extent, glm::length(p - points[0]));
  for (std::size_t clip = 0; clip < 2; ++clip) {
    const ClipOnRig on_rig(body.clips[clip], std::make_shared<const Armature>(body.body.armature));
    const int frames = body.clips[clip]->range_end - body.clips[clip]->range_start;
    for (const int frame : {0, frames / 3, frames}) {
      const auto bones =
          skin_transforms(posed_from_rest(body.body.armature, on_rig.at(body.clips[clip]->range_start + frame)));
      const auto told = file.skinned(static_cast<int>(clip), frame);
      double farthest = 0;
      for (std::size_t v = 0; v < points.size(); ++v) {
        std::vector<BoneWeight> influences;
        for (int i = 0; i < 4; ++i)
          influences.push_back({skin[v].influence.bone[i], skin[v].influence.weight[i] / double(kFullWeight)});
        const glm::dvec3 ours = blend_point(Blend::Linear, bones, influences, points[v]);
        farthest = std::max(farthest, glm::length(1000.0 * told[v] - glm::dvec3(ours.x, ours.z, -ours.y)));
        moved = std::max(moved, glm::length(ours - points[v]));
      }
      CHECK(farthest < 1e-5 * extent);
    }
  }
  CHECK(moved > 0.1 * extent);
}

// Blender reads and skins the file independently. Blender's axes, in metres, are the body's world axes.
TEST_CASE("gltf: Blender opens the file, and its vertices go where ours go") {
  NEEDS_PROGRAM("blender");
  const Arm& body = arm();
  const test::TemporaryFolder folder;
  const std::string glb = (folder / "arm.glb").string(), told = (folder / "told.txt").string();
  write_glb(body.gltf(), body.clips, glb);
  const Reader file(read_file(glb));
  std::vector<std::string> arguments{"-b",
                                     "--factory-startup",
                                     "--python-exit-code",
                                     "1",
                                     "--python",
                                     LIMBER_SOURCE_DIR "/tests/core/export/blender_gltf.py",
                                     "--",
                                     glb,
                                     told};
  struct Frame {
    std::size_t clip;
    int frame;
  };
  std::vector<Frame> frames;
  for (std::size_t clip = 0; clip < body.clips.size(); ++clip) {
    const Clip& played = *body.clips[clip];
    const int last = played.range_end - played.range_start;
    for (const int frame : {0, last / 3, last}) {
      frames.push_back({clip, frame});
      arguments.insert(arguments.end(), {played.name, std::to_string(frame / played.rate)});
    }
  }
  const test::ProgramRun run = test::run_program("blender", arguments);
  INFO(run.out, run.err);
  REQUIRE(run.exit_code == 0);

  std::ifstream places(told);
  double farthest = 0, extent = 0, moved = 0;
  const auto rest = file.skinned(0, -1);
  for (const auto& [clip, frame] : frames) {
    const auto ours = file.skinned(static_cast<int>(clip), frame);
    for (std::size_t v = 0; v < ours.size(); ++v) {
      glm::dvec3 theirs;
      places >> theirs.x >> theirs.y >> theirs.z;
      REQUIRE(!places.fail());
      farthest = std::max(farthest, glm::length(theirs - glm::dvec3(ours[v].x, -ours[v].z, ours[v].y)));
      extent = std::max(extent, glm::length(rest[v] - rest[0]));
      moved = std::max(moved, glm::length(ours[v] - rest[v]));
    }
  }
  CHECK((places >> std::ws).eof());
  CHECK(moved > 0.1 * extent);
  CHECK(farthest < 1e-4 * extent);
  MESSAGE("farthest ", farthest / extent, " of the extent");
}

TEST_CASE("gltf: the file is whole, names its bones and reads back as the rig's joints") {
  const Arm& body = arm();
  const std::string bytes = glb_of(body.gltf(), body.clips);
  const GltfSummary summary = parse_gltf(bytes, true, "arm.glb");
  CHECK(summary.warnings.empty());
  CHECK(summary.meshes == 1);
  CHECK(summary.skins == 1);
  CHECK(summary.animations == 2);
  CHECK(summary.triangles > 1000);
  REQUIRE(summary.armature.bones.size() == body.body.armature.bones.size());
  for (const Bone& bone : body.body.armature.bones) {
    const auto found = summary.armature.find(bone.name);
    REQUIRE(found);
    CHECK(glm::length(summary.armature.bones[*found].head - bone.head) < 1e-3);
    const int parent = summary.armature.bones[*found].parent;
    CHECK((parent < 0) == (bone.parent < 0));
    if (parent >= 0) CHECK(summary.armature.bones[parent].name == body.body.armature.bones[bone.parent].name);
  }
  CHECK(glb_of(body.gltf(), body.clips) == bytes);
}

TEST_CASE("gltf: weights of another body, a volume of air and a clip that does not fit are refused") {
  const Arm& body = arm();
  const GltfBody whole = body.gltf();
  const SkinWeights others({"Wing"}, body.tissue);
  CHECK_THROWS_AS(glb_of({whole.volume, whole.tissues, whole.armature, others}, {}), Error);
  LabelVolume air = whole.volume;
  std::fill(air.voxels.begin(), air.voxels.end(), Label{0});
  CHECK_THROWS_AS(glb_of({air, whole.tissues, whole.armature, whole.weights}, {}), Error);
  Clip stray = *body.clips[0];
  Motion motion = *stray.motion;
  for (std::size_t j = 0; j < motion.joints.size(); ++j) motion.joints[j].name = "thing" + std::to_string(j);
  stray.motion = std::make_shared<const Motion>(motion);
  CHECK_THROWS_AS(glb_of(whole, {std::make_shared<const Clip>(stray)}), Error);
}

TEST_CASE("skin at a point: between voxels the mean of their influences, away from tissue the nearest voxel's") {
  LabelVolume volume{{{6, 1, 1}}, {0, 1, 2, 0, 0, 0}};
  const TissueVoxels tissue(volume);
  SkinWeights weights({"a", "b"}, tissue);
  weights.set_chunk(0, std::array{rigid_influence(0), rigid_influence(1)});
  const std::vector<glm::dvec3> points{{1, 0, 0}, {1.25, 0, 0}, {2.4, 0, 0}, {5, 0, 0}, {-9, 3, 0}};
  const auto skin = skin_at(volume, tissue, weights, points);
  CHECK(skin[0].influence == rigid_influence(0));
  CHECK(skin[1].influence.of(0) == doctest::Approx(0.75).epsilon(1e-4));
  CHECK(skin[1].influence.of(1) == doctest::Approx(0.25).epsilon(1e-4));
  CHECK(skin[1].label == 1);
  for (const int i : {2, 3}) CHECK(skin[i].influence == rigid_influence(1));
  CHECK(skin[4].influence == rigid_influence(0));
}
