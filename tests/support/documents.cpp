// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/support/documents.h"

#include <bit>
#include <cmath>

#include "core/motion/constraint.h"
#include "core/skin/weight_layers.h"

namespace limber::test {

namespace {

template <class T>
std::shared_ptr<const T> shared(T value) {
  return std::make_shared<const T>(std::move(value));
}

// Compares the bits of the numbers: 0 and -0 differ, and equal NaNs do not.
bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(const glm::dvec3& a, const glm::dvec3& b) { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }
bool same(const glm::dquat& a, const glm::dquat& b) {
  return same(a.w, b.w) && same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

bool equal(const NamedPose& a, const NamedPose& b) {
  const auto same_turn = [](const auto& x, const auto& y) { return x.first == y.first && same(x.second, y.second); };
  return a.name == b.name && a.picture == b.picture &&
         std::equal(a.rotation.begin(), a.rotation.end(), b.rotation.begin(), b.rotation.end(), same_turn) &&
         a.root_translation.has_value() == b.root_translation.has_value() &&
         (!a.root_translation || same(*a.root_translation, *b.root_translation));
}
bool equal(const Anchors& a, const Anchors& b) {
  const auto same_pole = [](const auto& x, const auto& y) { return x.first == y.first && same(x.second, y.second); };
  return a.pins == b.pins && std::equal(a.poles.begin(), a.poles.end(), b.poles.begin(), b.poles.end(), same_pole);
}
bool equal(const WeightLocks& a, const WeightLocks& b) { return a == b; }
bool equal(const Seams& a, const Seams& b) { return a == b; }
bool equal(const BoneMap& a, const BoneMap& b) { return a == b; }
bool equal(const Measurements& a, const Measurements& b) { return a == b; }
bool equal(const LabelVolume& a, const LabelVolume& b) { return a.grid == b.grid && a.voxels == b.voxels; }
bool equal(const Tissue& a, const Tissue& b) {
  return a.label == b.label && same(a.file_value, b.file_value) && a.name == b.name && a.colour == b.colour &&
         a.kind == b.kind && same(a.density, b.density) && same(a.young_modulus, b.young_modulus) &&
         same(a.poisson_ratio, b.poisson_ratio) && a.priority == b.priority;
}
bool equal(const TissueTable& a, const TissueTable& b) {
  if (a.source != b.source || a.tissues.size() != b.tissues.size()) return false;
  for (std::size_t i = 0; i < a.tissues.size(); ++i)
    if (!equal(a.tissues[i], b.tissues[i])) return false;
  return true;
}
bool equal(const FileType& a, const FileType& b) {
  return a.format == b.format && a.voxel_type == b.voxel_type && a.compressed == b.compressed;
}
bool equal(const Armature& a, const Armature& b) { return a == b; }
bool equal(const SkinWeights& a, const SkinWeights& b) { return a == b; }
bool equal(const Pose& a, const Pose& b) {
  if (a.rotation.size() != b.rotation.size() || !same(a.root_translation, b.root_translation)) return false;
  for (std::size_t i = 0; i < a.rotation.size(); ++i)
    if (!same(a.rotation[i], b.rotation[i])) return false;
  return true;
}
bool equal(const Motion& a, const Motion& b) {
  return a.joints == b.joints && a.channel_count == b.channel_count && a.frame_count == b.frame_count &&
         same(a.frame_time, b.frame_time) && a.values == b.values && a.warnings == b.warnings;
}
bool equal(const Visibility& a, const Visibility& b) { return a == b; }

template <class T>
bool equal(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b);

bool equal(const WeightLayer& a, const WeightLayer& b) {
  return a.name == b.name && a.visible == b.visible && same(a.opacity, b.opacity) && a.weights == b.weights &&
         std::equal(a.mask.begin(), a.mask.end(), b.mask.begin(), b.mask.end(),
                    [](const auto& x, const auto& y) { return x && y ? *x == *y : !x && !y; });
}
bool equal(const WeightLayers& a, const WeightLayers& b) {
  return equal(a.base, b.base) && std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(),
                                             [](const auto& x, const auto& y) { return equal(*x, *y); });
}

template <class Track>
bool same_track(const Track& a, const Track& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.first == y.first && same(x.second, y.second); });
}
bool equal(const Clip& a, const Clip& b) {
  const auto same_bone = [](const auto& x, const auto& y) {
    return x.first == y.first && same_track(x.second, y.second);
  };
  return a.name == b.name && equal(a.motion, b.motion) && same(a.rate, b.rate) && a.start == b.start &&
         a.first == b.first && a.last == b.last && a.map == b.map && a.retarget == b.retarget &&
         a.range_start == b.range_start && a.range_end == b.range_end && a.markers == b.markers &&
         same_track(a.keys.root, b.keys.root) && a.keys.shapes == b.keys.shapes &&
         a.keys.root_shapes == b.keys.root_shapes && a.keys.weights == b.keys.weights &&
         a.keys.weight_shapes == b.keys.weight_shapes && !a.constraints == !b.constraints &&
         (!a.constraints || *a.constraints == *b.constraints) &&
         std::equal(a.keys.bones.begin(), a.keys.bones.end(), b.keys.bones.begin(), b.keys.bones.end(), same_bone);
}
bool equal(const Result& a, const Result& b) {
  return a.name == b.name && a.method == b.method && a.report == b.report && equal(a.volume, b.volume) &&
         equal(a.from_volume, b.from_volume) && equal(a.from_tissues, b.from_tissues) &&
         equal(a.from_armature, b.from_armature) && equal(a.from_weights, b.from_weights) &&
         equal(a.from_pose, b.from_pose) && !a.overlap == !b.overlap && (!a.overlap || *a.overlap == *b.overlap) &&
         equal(a.from_seams, b.from_seams) && equal(a.from_bone_map, b.from_bone_map);
}

template <class T>
bool equal(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b) {
  if (!a || !b) return !a && !b;
  return a == b || equal(*a, *b);
}

int below(std::mt19937& random, int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); }
double unit(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0; }

Influence random_influence(std::mt19937& random, int bones) {
  return quantize({{below(random, bones), unit(random) + 0.01}, {bones, unit(random)}});
}

LabelVolume bar() {
  LabelVolume volume;
  volume.grid.size = {24, 10, 9};
  volume.grid.spacing = {2, 2, 2.5};
  volume.grid.origin = {-1.5, 0.1, 1e-7};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (int z = 1; z < 8; ++z)
    for (int y = 1; y < 9; ++y)
      for (int x = 1; x < 23; ++x) volume.at({x, y, z}) = y > 3 && y < 6 && z > 2 && z < 5 ? 2 : 1;
  return volume;
}

TissueTable two_tissues() {
  TissueTable table;
  table.source = "names in the file";
  table.tissues.resize(2);
  table.tissues[0] = {.label = 1, .file_value = 17, .name = "flesh", .kind = TissueKind::Muscle};
  table.tissues[1] = {.label = 2,
                      .file_value = 9007199254740991.0,
                      .name = "bone \xff not UTF-8",
                      .kind = TissueKind::Bone,
                      .priority = 9};
  return table;
}

Armature two_bones() {
  Armature armature;
  armature.bones.push_back({.name = "Upper", .tail = {22, 8, 9}});
  armature.bones.push_back({.name = "Lower", .parent = 0, .head = {22, 8, 9}, .tail = {44, 8, 9}, .roll = 0.3});
  armature.bones[1].limits = {.type = JointLimits::Type::Hinge, .axis = {0, 0, 1}, .minimum = -0.1, .maximum = 2};
  return armature;
}

Motion short_motion() {
  Motion motion;
  motion.joints.push_back(
      {.name = "Hips", .channels = {BvhChannel::Xposition, BvhChannel::Zrotation}, .end_site = glm::dvec3(0, 1, 0)});
  motion.channel_count = 2;
  motion.frame_count = 3;
  motion.values = {0, 1, 2, 3, 4, -0.0f};
  motion.warnings = {"the last line was cut"};
  return motion;
}

Clip keyed_clip() {
  Clip clip = clip_of(shared(short_motion()), "walk \xff", 7);
  clip.map.sources = {{"Lower", {"Hips", glm::dquat(0.5, -0.5, 0.5, -0.0)}}, {"Upper", {"Hips", {}}}};
  clip.map.stances = {RestStance::TPose, RestStance::Anatomical};
  clip.retarget = {.travel = Travel::InPlace, .mirror = true, .scale = 2.54, .reference = Reference::FirstFrame};
  clip.range_end = 99;
  clip.keys.bones["Lower"] = {{-5, {1, 0, 0, 0}}, {12, {0.1, 0.2, 0.3, 0.4}}};
  clip.keys.root[12] = {1e-300, -0.0, 7};
  set_shape(clip.keys, "Lower", -5, {Interpolation::Bezier, HandleKind::Free, {1e-9, 0, -2}, {0.5, 1e5, 0}});
  set_root_shape(clip.keys, 12, {Interpolation::Constant, HandleKind::Flat});
  clip.markers = {{3, "step"}, {3, ""}};
  Constraint plant{.name = "Plant \xfe", .kind = ConstraintKind::Plant, .bone = "Lower", .target = "Upper"};
  plant.on = false;
  plant.weight = 0.75;
  plant.place = {1, -2.5, 1e-12};
  plant.point = PlantPoint::Joint;
  plant.keeps_rotation = false;
  plant.rotation = {0.5, -0.5, 0.5, -0.5};
  Constraint limit{.name = "Limit", .kind = ConstraintKind::LimitRotation, .bone = "Upper"};
  limit.axes = {true, false, true};
  limit.minimum = {-1, 0.25, 0};
  limit.maximum = {0.5, 0.25, 3};
  Constraint ik{.name = "IK", .kind = ConstraintKind::InverseKinematics, .bone = "Lower", .place{7, 8, 9}, .chain = 0};
  ik.space = RotationSpace::Parent;
  ik.aim = BoneAxis::MinusZ;
  ik.keep_limits = false;
  clip.constraints = std::make_shared<const Constraints>(Constraints{{plant, limit, ik}});
  clip.keys.weights["IK"] = {{-3, 0}, {40, 0.125}};
  clip.keys.weights["Limit"] = {{0, 1}};
  clip.keys.weight_shapes["IK"][-3] = {Interpolation::Bezier, HandleKind::Free, {0.1, 0, 0}, {-0.2, 0, 0}};
  return clip;
}

// Replaces the document's weights by a base and two weight layers. The upper layer is painted at two voxels of a brick.
void add_layers(Document& document, std::mt19937& random) {
  WeightLayers layers = with_new_layer(with_new_layer({document.weights, {}}, "lower \xff"), "upper");
  WeightLayer upper = *layers.layers[1];
  upper.opacity = 0.1 + 0.9 * unit(random);
  SkinWeights painted = *document.weights;
  const auto brick = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(painted.chunk_count()));
  SkinWeights::Influences chunk = painted.chunk(brick);
  for (int i = 0; i < 2; ++i) chunk[random() % chunk.size()] = random_influence(random, 1);
  painted.set_chunk(brick, std::move(chunk));
  layers.layers[1] = shared(painted_on(upper, *document.weights, painted));
  document.weights = shared(composed(layers));
  document.layers = shared(std::move(layers));
}

Result result_of(const Document& document, std::mt19937& random) {
  LabelVolume posed = *document.volume;
  for (int i = 0; i < 20; ++i) posed.voxels[random() % posed.voxels.size()] = static_cast<Label>(below(random, 3));
  return {"Result " + std::to_string(random()),
          "dqs",
          shared(std::move(posed)),
          "{\"schema\": \"limber-report/1\"}",
          document.volume,
          document.tissues,
          document.armature,
          document.weights,
          document.pose,
          nullptr,
          nullptr,
          document.seams,
          document.bone_map};
}

}  // namespace

bool same_contents(const Document& a, const Document& b) {
  if (!equal(a.volume, b.volume) || !equal(a.tissues, b.tissues) || !equal(a.volume_type, b.volume_type) ||
      !equal(a.armature, b.armature) || !equal(a.weights, b.weights) || !equal(a.pose, b.pose) ||
      !equal(a.visibility, b.visibility) || a.results.size() != b.results.size())
    return false;
  for (std::size_t i = 0; i < a.results.size(); ++i)
    if (!equal(a.results[i], b.results[i])) return false;
  const auto all_equal = [](const auto& ours, const auto& theirs) {
    return std::equal(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                      [](const auto& x, const auto& y) { return equal(x, y); });
  };
  return a.clip == b.clip && a.frame == b.frame && all_equal(a.clips, b.clips) && all_equal(a.poses, b.poses) &&
         equal(a.anchors, b.anchors) && equal(a.locks, b.locks) && equal(a.layers, b.layers) &&
         equal(a.seams, b.seams) && equal(a.bone_map, b.bone_map) && equal(a.measurements, b.measurements);
}

Document small_document() {
  std::mt19937 random(7);
  Document document;
  document.volume = shared(bar());
  document.tissues = shared(two_tissues());
  document.volume_type = shared(FileType{"NRRD", "uint8", true});
  document.armature = shared(two_bones());
  document.weights = shared(SkinWeights({"Upper", "Lower"}, TissueVoxels(*document.volume)));
  document.pose = shared(rest_pose(*document.armature));
  document.clips = {shared(keyed_clip()), shared(Clip{.name = "Keys alone", .rate = 23.976})};
  document.clip = 1;
  document.frame = -3;
  document.poses = {
      shared(NamedPose{"Reach \xff", {{"Lower", {0.5, -0.0, 1e-300, 0.5}}}, {}, std::string("\0PNG", 4)}),
      shared(NamedPose{"", {{"Upper", {1, 0, 0, 0}}}, glm::dvec3(1, -0.0, 1e-9), std::string(100'000, 'p')})};
  document.anchors = shared(Anchors{.pins = {"Lower", "gone \xff"}, .poles = {{"Lower", {1e-300, -0.0, 70}}}});
  document.locks = shared(WeightLocks{{"Lower", "gone \xff"}});
  document.visibility = shared(Visibility{.looks = {{2, {.visible = false, .opacity = 0.25f}}}});
  add_layers(document, random);
  Seams seams(document.volume->grid.size);
  for (int y = 1; y < 9; ++y) seams.cut({12, y, 4}, 0);
  for (int x = 3; x < 20; ++x) seams.cut({x, 7, 2}, 1), seams.cut({x, 7, 6}, 2);
  document.seams = shared(seams);
  document.bone_map = shared(BoneMap{{"17@left", "Lower"}, {"bone \xff not UTF-8", "Upper"}});
  document.measurements =
      shared(Measurements{{"Distance \xff", MeasureKind::Distance, {{1e-300, -0.0, 3}, {4, 5, 6}}},
                          {"Waist", MeasureKind::Girth, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}});
  document.results.push_back(shared(result_of(document, random)));
  return document;
}

Document random_edit(const Document& document, std::mt19937& random) {
  Document next = document;
  switch (below(random, 12)) {
    case 11: {
      Measurements all = document.measurements ? *document.measurements : Measurements{};
      if (!all.empty() && below(random, 2)) all.pop_back();
      else
        all.push_back(
            {"Angle " + std::to_string(random()), MeasureKind::Angle, {{unit(random), 0, 0}, {0, 1, 0}, {0, 0, 1}}});
      next.measurements = all.empty() ? nullptr : shared(std::move(all));
      break;
    }
    case 10: {
      Seams seams = document.seams ? *document.seams : Seams(document.volume->grid.size);
      const glm::ivec3 lower(1 + below(random, 20), 1 + below(random, 6), 1 + below(random, 5));
      if (seams.is_cut(lower, 1)) seams.join(lower, 1);
      else seams.cut(lower, 1);
      next.seams = shared(std::move(seams));
      next.bone_map = below(random, 2) ? shared(BoneMap{{"17", below(random, 2) ? "Lower" : "Upper"}}) : nullptr;
      break;
    }
    case 9: {
      if (!document.layers) {
        add_layers(next, random);
        break;
      }
      WeightLayers layers = *document.layers;
      WeightLayer layer = *layers.layers.back();
      layer.opacity = unit(random);
      layer.visible = below(random, 2) == 0;
      layers.layers.back() = shared(std::move(layer));
      next.weights = shared(recomposed(layers, *document.layers, *document.weights));
      next.layers = shared(std::move(layers));
      break;
    }
    case 8: {
      Clip clip = document.clips.empty() ? Clip{.name = "New"} : *document.clips[0];
      const int frame = below(random, 50);
      clip.keys.bones["Lower"][frame] = glm::angleAxis(unit(random), glm::dvec3(1, 0, 0));
      set_shape(clip.keys, "Lower", frame,
                {static_cast<Interpolation>(below(random, 3)), static_cast<HandleKind>(below(random, 5)),
                 glm::dvec3(unit(random)), glm::dvec3(unit(random))});
      clip.markers.push_back({below(random, 50), "m"});
      next.clips = {shared(std::move(clip))};
      next.clip = 0;
      next.frame = below(random, 50);
      break;
    }
    case 0: {
      TissueTable table = *document.tissues;
      table.tissues[random() % table.tissues.size()].name = "tissue " + std::to_string(random());
      next.tissues = shared(std::move(table));
      break;
    }
    case 1: {
      Armature armature = *document.armature;
      armature.bones[1].tail += glm::dvec3(unit(random), unit(random), -unit(random));
      next.armature = shared(std::move(armature));
      break;
    }
    case 2: {
      Visibility looks = document.visibility ? *document.visibility : Visibility{};
      looks.looks[static_cast<Label>(below(random, 4))].opacity = static_cast<float>(unit(random));
      looks.clip_box = {true, {0, 0, 0}, {unit(random), 1, 1}};
      next.visibility = shared(std::move(looks));
      break;
    }
    case 3:
      if (document.results.size() > 3) next.results.erase(next.results.begin());
      else next.results.push_back(shared(result_of(document, random)));
      break;
    case 4:
    case 5: {
      SkinWeights weights = *document.weights;
      const auto brick = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(weights.chunk_count()));
      SkinWeights::Influences chunk = weights.chunk(brick);
      for (int i = 0; i < 10; ++i) chunk[random() % chunk.size()] = random_influence(random, 1);
      weights.set_chunk(brick, std::move(chunk));
      next.weights = shared(std::move(weights));
      break;
    }
    default: {
      Pose pose = *document.pose;
      const double angle = unit(random);
      pose.rotation[random() % pose.rotation.size()] = glm::dquat(std::cos(angle), 0, std::sin(angle), 0);
      next.pose = shared(std::move(pose));
    }
  }
  return next;
}

Document large_document(std::uint32_t seed) {
  std::mt19937 random(seed);
  Document document;
  LabelVolume volume;
  volume.grid.size = {64, 32, 32};
  volume.voxels.assign(volume.grid.voxel_count(), 1);
  SkinWeights weights({"Upper", "Lower"}, TissueVoxels(volume));
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    SkinWeights::Influences chunk = weights.chunk(brick);
    for (Influence& influence : chunk) influence = random_influence(random, 1);
    weights.set_chunk(brick, std::move(chunk));
  }
  document.volume = shared(std::move(volume));
  document.weights = shared(std::move(weights));
  return document;
}

}  // namespace limber::test
