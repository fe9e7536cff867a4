// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests bodies whose bones touch and share one label. The truth is known: each voxel belongs to the bone in which it
// lies deepest.
#include "core/bones/joint_cuts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/bones/bone_parts.h"
#include "core/bones/unsure_bones.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
// A shaft with a knob at either end.
struct Dumbbell {
  glm::dvec3 from, to;
  double shaft, knob;  // radii of the shaft and of both knobs, mm
  int rig_bone;
};

// Returns how far outside a bone a position lies, mm; negative inside. The knobs reach a third of their radius beyond
// the ends, into the next bone.
double outside_of(const Dumbbell& bone, const glm::dvec3& at) {
  const glm::dvec3 along = glm::normalize(bone.to - bone.from), inset = 2.0 / 3 * bone.knob * along;
  const double length = glm::length(bone.to - bone.from), t = std::clamp(glm::dot(at - bone.from, along), 0.0, length);
  return std::min({glm::distance(at, bone.from + t * along) - bone.shaft,
                   glm::distance(at, bone.from + inset) - bone.knob, glm::distance(at, bone.to - inset) - bone.knob});
}

struct FusedBody {
  SmallBody body;
  std::vector<int> truth;  // rig bone of each voxel, -1 for no bone
};
FusedBody fused(const std::vector<Dumbbell>& bones, const Armature& rig, const glm::ivec3& size,
                const glm::dvec3& spacing) {
  FusedBody made;
  made.body.volume.grid.size = size;
  made.body.volume.grid.spacing = spacing;
  made.body.volume.voxels.assign(made.body.volume.grid.voxel_count(), kMuscle);
  made.body.tissues = muscle_and_bone();
  made.body.armature = rig;
  made.truth.assign(made.body.volume.grid.voxel_count(), -1);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        double deepest = 0;
        for (const Dumbbell& bone : bones)
          if (const double d = outside_of(bone, glm::dvec3(x, y, z) * spacing); d < deepest)
            deepest = d, made.truth[made.body.volume.grid.index({x, y, z})] = bone.rig_bone;
        if (deepest < 0) made.body.volume.at({x, y, z}) = kBone;
      }
  return made;
}

struct Wrong {
  std::int64_t voxels = 0;
  double worst_share = 0;  // largest share of a rig bone's true voxels that follow another rig bone
};
// Counts the voxels that follow another rig bone than the true one.
Wrong wrong_bones(const FusedBody& made) {
  const TissueVoxels tissue(made.body.volume);
  const BoneParts parts = split_bones(made.body.volume, tissue, made.body.tissues, made.body.armature);
  std::map<int, std::pair<std::int64_t, std::int64_t>> wrong_of;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const int true_bone = made.truth[made.body.volume.grid.index(v)];
    REQUIRE((parts.part_of[place] > 0) == (true_bone >= 0));
    if (true_bone < 0) return;
    auto& [wrong, all] = wrong_of[true_bone];
    wrong += parts.parts[parts.part_of[place] - 1].bone != true_bone;
    ++all;
  });
  Wrong all;
  for (const auto& [bone, count] : wrong_of) {
    MESSAGE(made.body.armature.bones[bone].name, ": ", count.first, " of ", count.second,
            " voxels follow another rig bone");
    all.worst_share = std::max(all.worst_share, double(count.first) / double(count.second));
    all.voxels += count.first;
  }
  return all;
}
double worst_share(const FusedBody& made) { return wrong_bones(made).worst_share; }

// Makes thigh and shank along z, in voxels of 2 x 2 x 8 mm. The rig's knee lies `off` mm away from where the bones
// touch.
FusedBody coarse_leg(const glm::dvec3& off) {
  const glm::dvec3 hip(50, 50, 396), knee(50, 50, 204), ankle(50, 50, 12);
  Armature rig;
  rig.bones = {bone_between("Thigh", -1, hip, knee + off), bone_between("Shank", 0, knee + off, ankle)};
  return fused({{hip, knee, 13, 32, 0}, {knee, ankle, 12, 30, 1}}, rig, {51, 51, 52}, {2, 2, 8});
}

// Makes the bones of a finger, each from one of the joints to the next, mm.
//   first_bone  index of the first one's rig bone; the next ones follow
std::vector<Dumbbell> finger(const std::vector<glm::dvec3>& joints, int first_bone) {
  std::vector<Dumbbell> bones;
  for (std::size_t k = 0; k + 1 < joints.size(); ++k)
    bones.push_back({joints[k], joints[k + 1], 3.5, 5.5, first_bone + static_cast<int>(k)});
  return bones;
}
void add_chain(Armature& rig, const std::string& name, const std::vector<glm::dvec3>& joints) {
  for (std::size_t k = 0; k + 1 < joints.size(); ++k)
    rig.bones.push_back(bone_between((name + std::to_string(k)).c_str(),
                                     k == 0 ? -1 : static_cast<int>(rig.bones.size()) - 1, joints[k], joints[k + 1]));
}
}  // namespace

TEST_CASE("joint cuts: femur and tibia that touch broadly on 8 mm slices are cut at the knee") {
  CHECK(worst_share(coarse_leg({0, 0, 0})) < 0.01);
}

TEST_CASE("joint cuts: a rig's knee 5 mm off moves the cut by one 8 mm slice at most") {
  for (const glm::dvec3& off : {glm::dvec3(0, 0, 5), glm::dvec3(0, 0, -5), glm::dvec3(5, 0, 0), glm::dvec3(3, 3, 3)})
    CHECK(worst_share(coarse_leg(off)) < 0.065);
}

// Makes thigh, shank and kneecap with one label, in voxels of 2 x 2 x 5 mm. The kneecap touches the femur; its tip lies
// `low` mm below the joint.
FusedBody leg_with_kneecap(double low) {
  const glm::dvec3 hip(50, 60, 796), knee(50, 60, 404), ankle(50, 60, 12);
  Armature rig;
  rig.bones = {bone_between("RightThigh", -1, hip, knee), bone_between("RightShank", 0, knee, ankle)};
  const Dumbbell thigh{hip, knee, 13, 32, 0}, shank{knee, ankle, 12, 30, 1};
  const Dumbbell kneecap{{50, 24, 444}, {50, 24, 404 - low}, 9, 9, 0};
  return fused({thigh, shank, kneecap}, rig, {51, 51, 164}, {2, 2, 5});
}

TEST_CASE("joint cuts: the thin shaft beside a broad joint is not cut in its place") {
  const glm::dvec3 hip(50, 50, 796), knee(50, 50, 404), ankle(50, 50, 12);
  for (const double off : {-8.0, 0.0, 8.0}) {
    INFO("the rig's knee ", off, " mm too high");
    const glm::dvec3 rig_knee = knee + glm::dvec3(0, 0, off);
    Armature rig;
    rig.bones = {bone_between("Thigh", -1, hip, rig_knee), bone_between("Shank", 0, rig_knee, ankle)};
    const Dumbbell thigh{hip, knee, 11, 32, 0}, shank{knee, ankle, 10, 30, 1};
    CHECK(worst_share(fused({thigh, shank}, rig, {35, 35, 164}, {3, 3, 5})) < 0.05);
  }
}

TEST_CASE("joint cuts: a kneecap that leans on the femur stays whole, also where its tip hangs below the joint" *
          doctest::test_suite("slow")) {
  for (const double low : {-5.0, 5.0, 15.0}) {
    INFO("tip ", low, " mm below the joint");
    CHECK(wrong_bones(leg_with_kneecap(low)).voxels < 10);
  }
}

TEST_CASE("joint cuts: a curled finger whose joints are closed is cut at each of them") {
  const std::vector<glm::dvec3> joints = {{20, 12, 90}, {20, 12, 50}, {20, 40, 32}, {20, 60, 50}};
  Armature rig;
  add_chain(rig, "Finger", joints);
  CHECK(worst_share(fused(finger(joints, 0), rig, {40, 75, 102}, {1, 1, 1})) < 0.02);
}

TEST_CASE("joint cuts: finger joints 2 mm off along the finger move the cuts by less than that") {
  const std::vector<glm::dvec3> joints = {{20, 20, 110}, {20, 20, 66}, {20, 20, 38}, {20, 20, 12}};
  std::vector<glm::dvec3> off = joints;
  off[1].z += 2;
  off[2].z -= 2;
  Armature rig;
  add_chain(rig, "Finger", off);
  // A cut that is off by two layers of voxels would give 0.08.
  CHECK(worst_share(fused(finger(joints, 0), rig, {40, 40, 122}, {1, 1, 1})) < 0.05);
}

struct Head {
  double radius, apex;  // mm; the apex of the head lies this far beyond the joint
};
// Makes a finger as one rod whose bones end in rounded heads, in voxels of 1 mm.
//   heads  the head at each joint between two bones
FusedBody rounded_finger(const std::vector<glm::dvec3>& joints, const Armature& rig, const std::vector<Head>& heads) {
  std::vector<Dumbbell> bones = finger(joints, 0);
  for (Dumbbell& bone : bones) bone.shaft = bone.knob = 5;
  FusedBody made = fused(bones, rig, {40, 44, 122}, {1, 1, 1});
  for (int z = 0; z < 122; ++z)
    for (int y = 0; y < 44; ++y)
      for (int x = 0; x < 40; ++x) {
        const glm::dvec3 at(x, y, z);
        int& bone = made.truth[made.body.volume.grid.index({x, y, z})];
        for (std::size_t k = 1; k + 1 < joints.size(); ++k) {
          if (bone < 0 || glm::distance(at, joints[k]) > 10) continue;
          const Head& head = heads[k - 1];
          const glm::dvec3 middle = joints[k] + (head.apex - head.radius) * glm::normalize(joints[k + 1] - joints[k]);
          bone = static_cast<int>(glm::distance(at, middle) < head.radius ? k - 1 : k);
        }
      }
  return made;
}

TEST_CASE("joint cuts: rounded heads of finger bones stay with their bone, and the hollow bases with theirs") {
  const std::vector<glm::dvec3> joints = {{20, 16, 112}, {20, 16, 70}, {20, 20, 42}, {20, 27, 16}};
  Armature rig;
  int parent = -1;
  for (const char* name : {"RightMiddleMetacarpal", "RightMiddleProximal", "RightMiddleMiddle"}) {
    const std::size_t k = rig.bones.size();
    rig.bones.push_back(bone_between(name, parent, joints[k], joints[k + 1]));
    parent = static_cast<int>(k);
  }
  const FusedBody body = rounded_finger(joints, rig, {{9, 0.7}, {11, 0}});
  Armature unnamed = rig;
  for (Bone& bone : unnamed.bones) bone.name = "bone " + bone.name.substr(11, 2);
  FusedBody flat = body;
  flat.body.armature = unnamed;
  const Wrong wrong = wrong_bones(body);
  CHECK(wrong.worst_share < 0.02);
  CHECK(wrong.voxels < 0.7 * wrong_bones(flat).voxels);  // without fingers' names, a joint is cut by a plane
}

Armature ring_finger(const std::vector<glm::dvec3>& joints) {
  Armature rig;
  for (const char* name : {"RightRingProximal", "RightRingMiddle", "RightRingDistal"}) {
    const int k = static_cast<int>(rig.bones.size());
    rig.bones.push_back(bone_between(name, k - 1, joints[k], joints[k + 1]));
  }
  return rig;
}

// Makes a finger as one rod, 12 mm wide and 9 mm deep, in voxels of 1 mm. Its bones end in cylinders that lie across
// the finger.
//   apex  for each joint between bones: how far the cylinder reaches beyond it towards the finger's tip, mm
FusedBody rolling_finger(const std::vector<glm::dvec3>& joints, const Armature& rig, const std::vector<double>& apex) {
  FusedBody made;
  SmallBody& body = made.body;
  body.volume.grid.size = {40, 40, 122};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), kMuscle);
  body.tissues = muscle_and_bone();
  body.armature = rig;
  made.truth.assign(body.volume.grid.voxel_count(), -1);
  const double roller = 6.5;  // radius of the cylinder, mm
  for (int z = 0; z < 122; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const double wide = (x - 20) / 6.0, deep = (y - 20) / 4.5;
        if (wide * wide + deep * deep > 1 || z > joints.front().z || z < joints.back().z) continue;
        body.volume.at({x, y, z}) = kBone;
        int bone = 0;
        for (std::size_t k = 1; k + 1 < joints.size(); ++k) {
          const double axis = joints[k].z - apex[k - 1] + roller;
          bone += z < axis && std::hypot(z - axis, y - 20.0) > roller;
        }
        made.truth[body.volume.grid.index({x, y, z})] = bone;
      }
  return made;
}

TEST_CASE("joint cuts: rollers at the ends of finger bones stay with their bone") {
  const std::vector<glm::dvec3> joints = {{20, 20, 112}, {20, 20, 70.3}, {20, 20, 38.6}, {20, 20, 14}};
  const FusedBody body = rolling_finger(joints, ring_finger(joints), {0.4, -0.5});
  FusedBody flat = body;
  for (Bone& bone : flat.body.armature.bones) bone.name = "bone " + bone.name.substr(9);
  const Wrong wrong = wrong_bones(body);
  CHECK(wrong.worst_share < 0.03);
  CHECK(wrong.voxels < 0.6 * wrong_bones(flat).voxels);
}

TEST_CASE("joint cuts: where finger bones touch in a small spot they are cut there, and not at the joint's shape") {
  const std::vector<glm::dvec3> joints = {{20, 20, 112}, {20, 20, 66}, {20, 20, 20}};
  Armature rig;
  rig.bones = {bone_between("RightRingProximal", -1, joints[0], joints[1]),
               bone_between("RightRingMiddle", 0, joints[1], joints[2])};
  FusedBody made = fused(finger(joints, 0), rig, {40, 40, 122}, {1, 1, 1});
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      if (std::hypot(x - 21, y - 20) > 1.5) {
        made.body.volume.at({x, y, 64}) = kMuscle;
        made.truth[made.body.volume.grid.index({x, y, 64})] = -1;
      }
      for (int z = 60; z < 72; ++z)
        if (int& bone = made.truth[made.body.volume.grid.index({x, y, z})]; bone >= 0) bone = z < 64;
    }
  CHECK(wrong_bones(made).voxels < 10);  // the two bones are joined at a spot of 9 voxels
}

TEST_CASE("joint cuts: a bone that hangs on the parent of the one it sits on is cut from both") {
  // A thumb sits on a wrist bone that reaches out towards it. In the rig the thumb's parent is the forearm.
  const glm::dvec3 elbow(24, 20, 112), wrist(24, 20, 70), palm(24, 20, 40), outer(44, 20, 54), tip(64, 20, 26);
  Armature rig;
  rig.bones = {bone_between("Forearm", -1, elbow, wrist), bone_between("Hand", 0, wrist, palm),
               bone_between("Thumb", 0, outer, tip)};
  const Dumbbell forearm{elbow, wrist, 5, 7, 0}, hand{wrist, palm, 6, 7, 1}, thumb{outer, tip, 5, 6.5, 2};
  const Dumbbell wrist_bone{{24, 20, 60}, outer, 6.5, 6.5, 1};
  CHECK(worst_share(fused({forearm, hand, wrist_bone, thumb}, rig, {76, 40, 122}, {1, 1, 1})) < 0.08);
}

FusedBody fingers_side_by_side() {
  const std::vector<glm::dvec3> first = {{20, 20, 110}, {20, 20, 66}, {20, 20, 38}, {20, 20, 12}},
                                second = {{30, 20, 112}, {30, 20, 70}, {30, 20, 40}, {30, 20, 10}};
  Armature rig;
  add_chain(rig, "One", first);
  add_chain(rig, "Two", second);
  std::vector<Dumbbell> bones = finger(first, 0), others = finger(second, 3);
  bones.insert(bones.end(), others.begin(), others.end());
  return fused(bones, rig, {50, 40, 124}, {1, 1, 1});
}

TEST_CASE("joint cuts: two fingers grown together side by side are cut between them") {
  CHECK(worst_share(fingers_side_by_side()) < 0.03);
}

TEST_CASE("joint cuts: bow legs whose knees touch are four bones") {
  const glm::dvec3 left_hip(40, 60, 390), left_knee(92, 60, 200), left_ankle(40, 60, 10), right_hip(196, 60, 390),
      right_knee(144, 60, 200), right_ankle(196, 60, 10);
  Armature rig;
  add_chain(rig, "Left", {left_hip, left_knee, left_ankle});
  add_chain(rig, "Right", {right_hip, right_knee, right_ankle});
  const std::vector<Dumbbell> bones = {{left_hip, left_knee, 13, 29, 0},
                                       {left_knee, left_ankle, 12, 28, 1},
                                       {right_hip, right_knee, 13, 29, 2},
                                       {right_knee, right_ankle, 12, 28, 3}};
  CHECK(worst_share(fused(bones, rig, {59, 30, 100}, {4, 4, 4})) < 0.01);
}

TEST_CASE("joint cuts: a bridge as thick as the shafts between two bones side by side is cut in its middle") {
  const glm::dvec3 a(20, 20, 110), b(20, 20, 60), c(20, 20, 10), d(44, 20, 110), e(44, 20, 60), f(44, 20, 10);
  Armature rig;
  add_chain(rig, "One", {a, b, c});
  add_chain(rig, "Two", {d, e, f});
  std::vector<Dumbbell> bones = {{a, b, 4, 7, 0}, {b, c, 4, 7, 1}, {d, e, 4, 7, 2}, {e, f, 4, 7, 3}};
  // These two halves of a bridge connect the bones; each half belongs to one of them.
  bones.push_back({glm::dvec3(20, 20, 35), glm::dvec3(32, 20, 35), 3.5, 3.5, 1});
  bones.push_back({glm::dvec3(44, 20, 35), glm::dvec3(32, 20, 35), 3.5, 3.5, 3});
  CHECK(worst_share(fused(bones, rig, {64, 40, 122}, {1, 1, 1})) < 0.02);
}

TEST_CASE("joint cuts: bones that do not touch keep every connection") {
  const SmallBody body = two_bone_bar(12, 40, 6);
  const TissueVoxels tissue(body.volume);
  const std::vector<TissueKind> kinds = body.tissues.kinds();
  BoneGraph graph = gather_bone(body.volume, tissue, kinds);
  const auto before = graph.neighbour;
  const auto [beyond, broad, depth] =
      cut_at_joints(graph, body.volume, kinds, body.armature, std::vector<std::int32_t>(graph.size(), 0), {{}});
  CHECK(graph.neighbour == before);
  CHECK(broad.empty());
  CHECK(depth == bone_depth(graph, body.volume.grid.spacing));
  CHECK(std::any_of(beyond.begin(), beyond.end(), [](const BeyondJoint& b) { return b.bone == 0 && b.other == 1; }));
  for (const BeyondJoint& b : beyond) CHECK((graph.voxel[b.voxel].z < 22) == (b.other == 0));
}

TEST_CASE("joint cuts: bones that touch more broadly than they are thick are told, those with a neck are not") {
  auto lines_of = [](const SmallBody& body) {
    return unsure_bones(split_bones(body.volume, TissueVoxels(body.volume), body.tissues, body.armature), body.tissues,
                        body.armature);
  };
  const auto lines = lines_of(coarse_leg({0, 0, 0}).body);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].find("between Thigh and Shank") != std::string::npos);
  CHECK(lines[0].find("kneecap") != std::string::npos);

  const glm::dvec3 top(20, 20, 110), joint(20, 20, 60), bottom(20, 20, 10);
  Armature rig;
  add_chain(rig, "Bone", {top, joint, bottom});
  CHECK(lines_of(fused({{top, joint, 6, 6, 0}, {joint, bottom, 6, 6, 1}}, rig, {40, 40, 122}, {1, 1, 1}).body).empty());
}

TEST_CASE("joint cuts: depths after a cut are those of the graph that was cut") {
  const SmallBody body = coarse_leg({0, 0, 0}).body;
  const std::vector<TissueKind> kinds = body.tissues.kinds();
  BoneGraph graph = gather_bone(body.volume, TissueVoxels(body.volume), kinds);
  const auto before = graph.neighbour;
  const JointCuts cuts =
      cut_at_joints(graph, body.volume, kinds, body.armature, std::vector<std::int32_t>(graph.size(), 0), {{}});
  CHECK(graph.neighbour != before);
  const std::vector<float> depth = bone_depth(graph, body.volume.grid.spacing);
  double worst = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) worst = std::max(worst, double(std::abs(depth[i] - cuts.depth[i])));
  CHECK(worst < 0.5);  // mm; distances that are propagated from voxel to voxel may be a little too long
}

TEST_CASE("joint cuts: one, two and four threads cut alike") {
  const std::vector<glm::dvec3> joints = {{20, 20, 112}, {20, 20, 70.3}, {20, 20, 38.6}, {20, 20, 14}};
  for (const FusedBody& made :
       {coarse_leg({0, 0, 0}), rolling_finger(joints, ring_finger(joints), {0, 0}), fingers_side_by_side()}) {
    const std::vector<TissueKind> kinds = made.body.tissues.kinds();
    auto cut_with = [&](int threads) {
      const ThreadCount count(threads);
      BoneGraph graph = gather_bone(made.body.volume, TissueVoxels(made.body.volume), kinds);
      const auto whole = graph.neighbour;
      JointCuts cuts = cut_at_joints(graph, made.body.volume, kinds, made.body.armature,
                                     std::vector<std::int32_t>(graph.size(), 0), {{}});
      CHECK(graph.neighbour != whole);
      std::vector<std::array<int, 3>> beyond;
      for (const BeyondJoint& b : cuts.beyond) beyond.push_back({b.voxel, b.bone, b.other});
      return std::tuple(graph.place, graph.neighbour, beyond, cuts.depth, flood(graph, cuts.depth, 0.6));
    };
    const auto one = cut_with(1);
    CHECK(cut_with(2) == one);
    CHECK(cut_with(4) == one);
  }
}
