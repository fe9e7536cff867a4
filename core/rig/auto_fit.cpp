// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/auto_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include <glm/gtc/quaternion.hpp>

#include "core/base/error.h"
#include "core/rig/articulated_fit.h"
#include "core/rig/body_atlas.h"
#include "core/rig/body_skeleton.h"
#include "core/rig/limb_paths.h"
#include "core/rig/rig_placing.h"
#include "core/rig/surface_points.h"
#include "core/volume/distance.h"

namespace limber {

namespace {

constexpr double kCells = 380;      // along the longest side of the tissue
constexpr double kLeastBone = 0.004;  // of all tissue: less bone than that is no skeleton
constexpr std::int64_t kBoneCells = 6000;
constexpr double kPi = 3.14159265358979323846;

// What is fitted to.
struct Target {
  Occupancy body, bone_body;
  double length = 0;  // mm, diagonal of the tissue's extent
  double cell = 0;    // mm, the largest side of a cell
  std::optional<FitSurface> skin, bone;
  std::vector<glm::dvec3> bone_cells;  // centres, some thousands
};

// The centres of at most so many filled cells, evenly chosen.
std::vector<glm::dvec3> filled_cells(const Occupancy& occupancy, std::int64_t most) {
  std::vector<std::int64_t> filled;
  for (std::int64_t i = 0; i < std::ssize(occupancy.share); ++i)
    if (occupancy.share[i] >= 0.5f) filled.push_back(i);
  const AffineTransform to_world = world_from_voxel(occupancy.grid);
  const glm::ivec3 size = occupancy.grid.size;
  const std::int64_t count = std::min(most, std::ssize(filled));
  std::vector<glm::dvec3> centres;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t i = filled[k * std::ssize(filled) / count];
    centres.push_back(to_world * glm::dvec3(i % size.x, i / size.x % size.y, i / (std::int64_t{size.x} * size.y)));
  }
  return centres;
}

std::optional<std::pair<glm::dvec3, glm::dvec3>> extent_of(const std::vector<SurfacePoint>& points) {
  if (points.empty()) return std::nullopt;
  glm::dvec3 low = points[0].place, high = low;
  for (const SurfacePoint& p : points) low = glm::min(low, p.place), high = glm::max(high, p.place);
  return std::pair(low, high);
}

Target make_target(const LabelVolume& volume, const TissueTable& tissues) {
  const VoxelBox box = tissue_box(volume);
  if (box.voxel_count() == 0) throw Error("a volume without tissue cannot be rigged", "every voxel is air", "give a label volume with tissue");
  Target target;
  const glm::dvec3 sides = glm::dvec3(box.size) * volume.grid.spacing;
  const double longest = std::max({sides.x, sides.y, sides.z}), spacing = longest / kCells;
  LabelSet all(65536, 1), bone(65536, 0);
  all[0] = 0;
  const std::vector<TissueKind> kinds = tissues.kinds();
  for (size_t label = 1; label < kinds.size(); ++label) bone[label] = is_bone(kinds[label]);

  target.body = occupancy_of(volume, all, spacing);
  close_body(target.body);
  std::vector<SurfacePoint> skin = surface_points(target.body);
  target.length = glm::length(sides);
  target.cell = std::max({target.body.grid.spacing.x, target.body.grid.spacing.y, target.body.grid.spacing.z});
  target.skin.emplace(std::move(skin), longest / 150);

  target.bone_body = occupancy_of(volume, bone, spacing);
  const Occupancy& bones = target.bone_body;
  double of_bone = 0, of_body = 0;
  for (float share : bones.share) of_bone += share;
  for (float share : target.body.share) of_body += share;
  if (of_bone > kLeastBone * of_body) {
    target.bone.emplace(surface_points(bones), longest / 200);
    target.bone_cells = filled_cells(bones, kBoneCells);
  }
  return target;
}

// Too few points of surface say nothing of a body.
bool has_shape(const Target& target) {
  constexpr std::int64_t kLeast = 300;
  return std::ssize(target.skin->points) >= kLeast;
}

double rest_length(const Armature& rig, int bone, int child) { return glm::distance(rig.bones[bone].head, rig.bones[child].head); }

glm::dmat3 turn_between(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 a = glm::normalize(from), b = glm::normalize(to), across = glm::cross(a, b);
  const double s = glm::length(across);
  if (s < 1e-9) return glm::dmat3(1);
  return glm::mat3_cast(glm::angleAxis(std::atan2(s, glm::dot(a, b)), across / s));
}

void stretch_all(Mannequin& m, double factor) {
  for (double& a : m.along) a = std::log(factor);
  m.across = m.along;
  m.settle();
}

// A limb without its digits, and the bone whose tail is its end.
struct Chain {
  std::vector<int> bones;
  int last = 0;
};

Chain chain_of(const Armature& rig, std::initializer_list<std::string> names, const std::string& last) {
  Chain chain;
  for (const std::string& name : names)
    if (const auto bone = rig.find(name)) chain.bones.push_back(*bone);
  chain.last = rig.find(last).value_or(chain.bones.empty() ? 0 : chain.bones.back());
  return chain;
}

double length_from(const Armature& rig, const Chain& chain, size_t k) {
  double length = glm::distance(rig.bones[chain.bones.back()].head, rig.bones[chain.last].tail);
  for (; k + 1 < chain.bones.size(); ++k) length += rest_length(rig, chain.bones[k], chain.bones[k + 1]);
  return length;
}

// Lays a chain along a way that starts at its end.
void lay_chain(Mannequin& m, const Chain& chain, const LimbPath& path, double scale) {
  const Armature& rig = m.atlas().rig;
  for (size_t k = 0; k < chain.bones.size(); ++k) {
    const bool is_last = k + 1 == chain.bones.size();
    const double from = scale * length_from(rig, chain, k), to = is_last ? 0 : scale * length_from(rig, chain, k + 1);
    const glm::dvec3 way = path.at(to) - path.at(from);
    const glm::dvec3 next = is_last ? m.carried(chain.last, rig.bones[chain.last].tail) : m.joint(chain.bones[k + 1]);
    const glm::dvec3 now = next - m.joint(chain.bones[k]);
    if (glm::length(way) > 1e-6 && glm::length(now) > 1e-6) m.turn_branch(chain.bones[k], turn_between(now, way));
  }
}

// --- starts ---------------------------------------------------------------------------------------------------------------

glm::dmat3 frame(const glm::dvec3& left, const glm::dvec3& up) {
  const glm::dvec3 z = glm::normalize(up), x = glm::normalize(left - z * glm::dot(left, z));
  return glm::dmat3(x, glm::cross(z, x), z);
}

void put_body(Mannequin& m, const glm::dmat3& axes, double scale, const glm::dvec3& hips) {
  for (glm::dmat3& turn : m.turn) turn = axes;
  m.root = hips;
  stretch_all(m, scale);
}

std::vector<Mannequin> body_starts(const BodyAtlas& atlas, const Target& target) {
  std::vector<Mannequin> starts;
  const auto [low, high] = *extent_of(target.skin->points);
  const auto paths = limb_paths(target.body, PathCentre::Thickest);
  const Armature& rig = atlas.rig;
  const double stature = 1748;
  {
    Mannequin upright(atlas);
    const double scale = (high.z - low.z) / stature;
    put_body(upright, glm::dmat3(1), scale, glm::dvec3((low.x + high.x) / 2, (low.y + high.y) / 2, low.z + 925 * scale));
    starts.push_back(upright);
  }
  if (paths.size() < 3) return starts;

  // The head is the nearest of the five ends, the feet lie farthest away from it.
  std::vector<LimbPath> ends(paths.begin(), paths.begin() + std::min<size_t>(paths.size(), 5));
  const glm::dvec3 centre = ends[0].points.back();
  const auto head = std::min_element(ends.begin(), ends.end(), [](auto& a, auto& b) { return a.length < b.length; });
  const LimbPath crown = *head;
  ends.erase(head);
  const glm::dvec3 upwards = crown.points.front() - centre;
  std::sort(ends.begin(), ends.end(), [&](auto& a, auto& b) { return glm::dot(a.points.front(), upwards) < glm::dot(b.points.front(), upwards); });
  const LimbPath feet[2] = {ends[0], ends[1]};
  const double whole = crown.length + (feet[0].length + feet[1].length) / 2, scale = whole / 1960;
  // From the toes, the hip is at the end of foot, shank and thigh.
  const double leg = scale * 1040;
  const glm::dvec3 hips = (feet[0].at(leg) + feet[1].at(leg)) / 2.0;
  const glm::dvec3 up = crown.points.front() - hips, across = feet[0].at(leg * 0.75) - feet[1].at(leg * 0.75);
  if (glm::length(glm::cross(up, across)) < 1e-6) return starts;
  for (int facing = 0; facing < 2; ++facing) {
    const glm::dmat3 axes = frame(facing ? -across : across, up);
    Mannequin m(atlas);
    put_body(m, axes, scale, hips);
    lay_chain(m, chain_of(rig, {"LeftThigh", "LeftShank", "LeftFoot"}, "LeftToes"), feet[facing], scale);
    lay_chain(m, chain_of(rig, {"RightThigh", "RightShank", "RightFoot"}, "RightToes"), feet[1 - facing], scale);
    for (size_t k = 2; k < ends.size(); ++k) {
      // An arm belongs to the side it leaves the trunk on.
      const glm::dvec3 shoulder = ends[k].at(scale * 700);
      const bool left = glm::dot(axes[0], shoulder - hips) > 0;
      const std::string side = left ? "Left" : "Right";
      lay_chain(m, chain_of(rig, {side + "UpperArm", side + "Forearm", side + "Hand"}, side + "MiddleDistal"), ends[k], scale);
    }
    starts.push_back(m);
  }
  return starts;
}

// A single limb runs from its farthest end to the other one; it may run either way, turned about itself in eight ways.
std::vector<Mannequin> limb_starts(const BodyAtlas& atlas, const Target& target, const Chain& chain, double beyond_root) {
  std::vector<Mannequin> starts;
  auto paths = limb_paths(target.body, PathCentre::FarthestEnd);
  if (paths.empty() || chain.bones.empty()) return starts;
  LimbPath path = paths[0];
  const Armature& rig = atlas.rig;
  const double length = beyond_root + length_from(rig, chain, 0);
  const double scale = path.length / length;
  for (int way = 0; way < 2; ++way) {
    for (int roll = 0; roll < 8; ++roll) {
      Mannequin m(atlas);
      const glm::dvec3 start = path.at(path.length - beyond_root * scale), on = path.at(path.length - (beyond_root + 0.4 * (length - beyond_root)) * scale) - start;
      if (!(glm::length(on) > 0)) return starts;
      const glm::dvec3 first = rig.bones[chain.bones[0]].head, rest = (chain.bones.size() > 1 ? rig.bones[chain.bones[1]].head : rig.bones[chain.last].tail) - first;
      const glm::dmat3 lie = turn_between(rest, on);
      const glm::dmat3 about = glm::mat3_cast(glm::angleAxis(roll * kPi / 4, glm::normalize(on)));
      put_body(m, about * lie, scale, start);
      lay_chain(m, chain, path, scale);
      starts.push_back(m);
    }
    std::reverse(path.points.begin(), path.points.end());
  }
  return starts;
}

// --- fitting --------------------------------------------------------------------------------------------------------------

bool is_digit(const std::string& name) {
  for (const char* word : {"Thumb", "Index", "Middle", "Ring", "Little", "Jaw"})
    if (name.find(word) != std::string::npos) return true;
  return false;
}

std::vector<std::uint8_t> without_digits(const Armature& rig) {
  std::vector<std::uint8_t> free;
  for (const Bone& bone : rig.bones) free.push_back(!is_digit(bone.name));
  return free;
}

struct Fitted {
  std::shared_ptr<const BodyAtlas> atlas;  // the mannequin stands on it
  std::optional<Mannequin> body;
  double misfit = 1e300;  // mm
  bool is_rods = false;
};

// Every start is tried roughly, the best of them in earnest.
void take_best_start(Fitted& result, const Target& target, std::vector<Mannequin> starts) {
  constexpr size_t kInEarnest = 5;
  const auto main = without_digits(result.atlas->rig);
  const double L = target.length;
  std::vector<std::pair<double, size_t>> order;
  if (starts.size() > kInEarnest) {
    for (size_t k = 0; k < starts.size(); ++k) {
      fit(starts[k], &*target.skin, nullptr, {.iterations = 6, .wide = 0.06 * L, .narrow = 0.03 * L, .turns = main, .stride = 20});
      order.push_back({misfit(starts[k], &*target.skin, nullptr, 0.04 * L, {.stride = 10}), k});
    }
    std::sort(order.begin(), order.end());
    order.resize(kInEarnest);
  } else {
    for (size_t k = 0; k < starts.size(); ++k) order.push_back({0, k});
  }
  double least = std::numeric_limits<double>::max();
  for (const auto& [rough, k] : order) {
    fit(starts[k], &*target.skin, nullptr, {.iterations = 12, .wide = 0.06 * L, .narrow = 0.02 * L, .turns = main, .stride = 8});
    const double off = misfit(starts[k], &*target.skin, nullptr, 0.04 * L, {.stride = 4});
    if (off < least) least = off, result.body = starts[k];
  }
  result.misfit = std::sqrt(least);
}

// Bones that are drawn as rods along a rig: the body's own segments are drawn onto their axes. Kept when nearly all bone
// lies close around the segments and the long bones' segments run inside bone; anatomical bones do neither.
bool follow_rods(Mannequin& m, const Target& target) {
  const double L = target.length;
  Mannequin rods = m;
  fit_rods(rods, target.bone_cells, *target.skin, {.iterations = 40, .wide = 0.02 * L, .narrow = 0.006 * L, .bone_share = 0.8, .stride = 3});
  split_rods(rods, target.bone_cells);
  const RodShare share = rod_share(rods, target.bone_cells, target.bone_body, 0.015 * L);
  if (share.near < 0.9 || share.inside < 0.85) return false;
  m = rods;
  return true;
}

std::vector<std::uint8_t> branch_of(const Armature& rig, int root) {
  std::vector<std::uint8_t> in(rig.bones.size(), 0);
  for (int b = root; b < std::ssize(rig.bones); ++b) in[b] = b == root || (rig.bones[b].parent >= 0 && in[rig.bones[b].parent]);
  return in;
}

// A hand can come to lie one finger beside itself. It is tried turned in its plane and about the forearm, and what fits best
// is kept.
void try_hands(Mannequin& m, const Target& target, const FitSurface* bone) {
  const Armature& rig = m.atlas().rig;
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (!rig.bones[b].name.ends_with("Hand")) continue;
    const auto knuckle = rig.find(rig.bones[b].name.substr(0, rig.bones[b].name.size() - 4) + "MiddleProximal");
    const auto index = rig.find(rig.bones[b].name.substr(0, rig.bones[b].name.size() - 4) + "IndexProximal");
    const auto little = rig.find(rig.bones[b].name.substr(0, rig.bones[b].name.size() - 4) + "LittleProximal");
    if (!knuckle || !index || !little) continue;
    const double palm = glm::distance(m.joint(b), m.joint(*knuckle));
    FitStage stage{.iterations = 14, .wide = 0.2 * palm, .narrow = 0.04 * palm, .turns = branch_of(rig, b), .stretches = false, .bone_share = 0.6, .stride = 3};
    stage.points = stage.turns;
    stage.around = m.joint(*knuckle), stage.reach = 1.6 * palm;
    const glm::dvec3 along = glm::normalize(m.joint(*knuckle) - m.joint(b)), normal = glm::normalize(glm::cross(along, m.joint(*index) - m.joint(*little)));
    std::optional<Mannequin> best;
    double least = 1e300;
    for (double twist : {0.0, -0.7, 0.7})
      for (double aside : {0.0, -0.25, 0.25}) {
        Mannequin tried = m;
        tried.turn_branch(b, glm::mat3_cast(glm::angleAxis(twist, along) * glm::angleAxis(aside, normal)));
        fit(tried, &*target.skin, bone, stage);
        const double off = misfit(tried, &*target.skin, bone, 0.25 * palm, stage);
        if (off < least * (best ? 0.97 : 1)) least = off, best = tried;  // without need it stays as it is
      }
    m = *best;
  }
}

void refine(Fitted& result, const Target& target, Progress& progress) {
  Mannequin& m = *result.body;
  const double L = target.length;
  const auto main = without_digits(result.atlas->rig);
  progress.update("fitting", 0.4);
  fit(m, &*target.skin, nullptr, {.iterations = 20, .wide = 0.03 * L, .narrow = 0.01 * L, .turns = main, .stride = 3});
  progress.update("fitting", 0.6);
  const FitSurface* bone = target.bone ? &*target.bone : nullptr;
  if (bone && follow_rods(m, target)) {
    result.is_rods = true;
    bone = nullptr;
  } else if (bone) {
    fit(m, &*target.skin, bone, {.iterations = 24, .wide = 0.03 * L, .narrow = 0.006 * L, .turns = main, .bone_share = 0.7, .stride = 2});
  }
  progress.update("fitting", 0.8);
  try_hands(m, target, bone);
  if (bone) fit(m, &*target.skin, bone, {.iterations = 16, .wide = 0.01 * L, .narrow = 0.003 * L, .bone_share = 0.8});
  else if (!result.is_rods) fit(m, &*target.skin, nullptr, {.iterations = 16, .wide = 0.012 * L, .narrow = 0.004 * L});
  result.misfit = std::sqrt(misfit(m, &*target.skin, nullptr, 0.04 * L, {}));
  progress.update("fitting", 1);
}

}  // namespace

std::string_view to_string(JointFit::How how) {
  switch (how) {
    case JointFit::How::Skin: return "skin";
    case JointFit::How::BoneSurface: return "bone surface";
    case JointFit::How::BoneAxis: return "bone axis";
    case JointFit::How::Carried: return "carried along";
    case JointFit::How::Extents: return "extents";
  }
  return "";
}

namespace {

// What kind of body a rig is of; none for one whose names mean nothing, or that goes on four legs.
std::vector<AtlasKind> kinds_for(const Armature& rig) {
  const Skeleton skeleton = skeleton_of(rig);
  std::set<BodyPart> parts;
  for (const auto& role : skeleton.role)
    if (role) parts.insert(role->part);
  const bool arm = parts.contains(BodyPart::UpperArm) || parts.contains(BodyPart::Forearm), leg = parts.contains(BodyPart::Thigh) || parts.contains(BodyPart::Shank);
  if (leg && (arm || parts.contains(BodyPart::Neck) || parts.contains(BodyPart::Head))) return {AtlasKind::Body};
  if (arm) return {AtlasKind::Arm, AtlasKind::ArmWithShoulder};
  if (leg) return {AtlasKind::Leg};
  if (parts.contains(BodyPart::Index) || parts.contains(BodyPart::Middle)) return {AtlasKind::Hand};
  return {};
}

Chain chain_for(AtlasKind kind, const Armature& rig) {
  if (kind == AtlasKind::Leg) return chain_of(rig, {"Thigh", "Shank", "Foot"}, "Toes");
  if (kind == AtlasKind::Hand) return chain_of(rig, {"Hand"}, "MiddleDistal");
  return chain_of(rig, {"UpperArm", "Forearm", "Hand"}, "MiddleDistal");
}

// The best of several kinds of body, right and left.
Fitted best_start(const std::vector<AtlasKind>& kinds, const Target& target, Progress& progress) {
  Fitted best;
  int done = 0;
  for (AtlasKind kind : kinds) {
    const BodyAtlas atlas = make_atlas(kind);
    for (bool mirror : {false, true}) {
      progress.update("starting", done++ / double(2 * kinds.size()));
      if (kind == AtlasKind::Body && mirror) continue;
      Fitted tried{.atlas = std::make_shared<BodyAtlas>(mirror ? mirrored(atlas) : atlas), .body = std::nullopt};
      // Flesh goes on some way beyond the joint that a limb begins with.
      constexpr double kBeyond = 40;
      take_best_start(tried, target, kind == AtlasKind::Body ? body_starts(*tried.atlas, target) : limb_starts(*tried.atlas, target, chain_for(kind, tried.atlas->rig), kBeyond));
      if (tried.body && tried.misfit < best.misfit) best = tried;
    }
  }
  return best;
}

// Confidence in the heads of the fitted body's bones: how much of the surface on either side of the joint lies where it should.
std::vector<double> confidences(const Fitted& fitted, const Target& target) {
  const Mannequin& m = *fitted.body;
  const bool by_bone = target.bone && !fitted.is_rods;
  const double near = by_bone ? 2.5 + 1.2 * target.cell : 2.5 + 0.004 * target.length + target.cell;
  std::vector<double> share = share_near(m, by_bone ? *target.bone : *target.skin, by_bone, near);
  std::vector<double> result(share.size(), 0);
  for (int b = 0; b < m.bone_count(); ++b) {
    const int parent = m.atlas().rig.bones[b].parent;
    const double own = share[b] < 0 ? 0.5 : share[b], above = parent < 0 || share[parent] < 0 ? own : share[parent];
    result[b] = std::sqrt(own * above);
  }
  return result;
}

bool is_followed_rod(const std::string& name) {
  for (const char* part : {"UpperArm", "Forearm", "Thigh", "Shank", "Foot"})
    if (name.ends_with(part)) return true;
  return false;
}

AutoFit by_extents(const LabelVolume& volume, const Armature& rig, const std::string& reason) {
  AutoFit result;
  result.armature = scaled_to_tissue(volume, rig);
  result.joints.assign(rig.bones.size(), {JointFit::How::Extents, 0.1});
  result.warnings.push_back(reason + ": the rig was only scaled to the tissue's extents");
  return result;
}

void warn_of_joints(AutoFit& result) {
  constexpr double kDoubtful = 0.35, kOutside = 0.85;
  std::string doubtful, outside;
  for (size_t b = 0; b < result.joints.size(); ++b) {
    const auto list = [&](std::string& names) { names += (names.empty() ? "" : ", ") + result.armature.bones[b].name; };
    if (result.joints[b].how != JointFit::How::Carried && result.joints[b].how != JointFit::How::Extents && result.joints[b].confidence < kDoubtful) list(doubtful);
    if (result.check.share[b] < kOutside) list(outside);
  }
  if (!doubtful.empty()) result.warnings.push_back("found with little confidence, check by eye: " + doubtful);
  if (!outside.empty()) result.warnings.push_back("bones that leave the tissue: " + outside);
}

}  // namespace

Armature scaled_to_tissue(const LabelVolume& volume, const Armature& rig) {
  const VoxelBox box = tissue_box(volume);
  if (box.voxel_count() == 0) throw Error("a volume without tissue cannot be rigged", "every voxel is air", "give a label volume with tissue");
  const AffineTransform to_world = world_from_voxel(volume.grid);
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low), least(low), most(high);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = to_world * (glm::dvec3(box.lowest) - 0.5 + glm::dvec3(box.size) * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
    low = glm::min(low, p), high = glm::max(high, p);
  }
  for (const Bone& bone : rig.bones)
    for (const glm::dvec3& p : {bone.head, bone.tail}) least = glm::min(least, p), most = glm::max(most, p);
  const glm::dvec3 sides = high - low, own = most - least;
  const int longest = own.x >= own.y && own.x >= own.z ? 0 : own.y >= own.z ? 1 : 2;
  constexpr double kInside = 0.96;  // bones end some way below the skin
  const double scale = own[longest] > 0 ? kInside * sides[longest] / own[longest] : 1;
  return moved_rig(rig, glm::dmat3(1), scale, (least + most) / 2.0, (low + high) / 2.0);
}

AutoFit auto_fit(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig, Progress& progress) {
  check_armature(rig, "the template");
  progress.update("surfaces", 0);
  const Target target = make_target(volume, tissues);
  progress.update("surfaces", 1);
  AutoFit result;
  const std::vector<AtlasKind> kinds = kinds_for(rig);
  Fitted fitted;
  if (!kinds.empty() && has_shape(target)) fitted = best_start(kinds, target, progress);
  if (!fitted.body) {
    result = by_extents(volume, rig, kinds.empty() ? "the bones' names do not tell of a body that is known" : "the tissue has hardly any surface");
  } else {
    refine(fitted, target, progress);
    const PlacedRig placed = place_rig(rig, *fitted.body);
    result.armature = placed.armature;
    result.misfit_mm = fitted.misfit;
    const std::vector<double> sure = confidences(fitted, target);
    for (int match : placed.joint_of) {
      JointFit joint;
      if (match >= 0) {
        const bool rod = fitted.is_rods && is_followed_rod(fitted.atlas->rig.bones[match].name);
        joint.how = rod ? JointFit::How::BoneAxis : target.bone && !fitted.is_rods ? JointFit::How::BoneSurface : JointFit::How::Skin;
        joint.confidence = rod ? 0.9 : sure[match];
      }
      result.joints.push_back(joint);
    }
    // What rides along is as sure as what it rides on, and a little less.
    for (size_t b = 0; b < result.joints.size(); ++b)
      if (result.joints[b].how == JointFit::How::Carried && rig.bones[b].parent >= 0) result.joints[b].confidence = 0.7 * result.joints[rig.bones[b].parent].confidence;
    constexpr double kUnlike = 0.022;  // of the tissue's diagonal
    if (result.misfit_mm > kUnlike * target.length) result.warnings.push_back("the tissue looks little like the body that this rig is of; check every joint by eye");
  }
  result.check = check_rig(volume, result.armature);
  warn_of_joints(result);
  return result;
}

std::string suggest_template(const LabelVolume& volume, const TissueTable& tissues, Progress& progress) {
  const Target target = make_target(volume, tissues);
  if (!has_shape(target)) return "arm";
  // A body has five ends that stand far out.
  if (limb_paths(target.body, PathCentre::Thickest).size() >= 5) {
    const double whole = best_start({AtlasKind::Body}, target, progress).misfit;
    if (whole < 0.02 * target.length) return "adult";
  }
  std::pair<double, std::string> best{std::numeric_limits<double>::max(), "arm"};
  for (const auto& [kind, name] : {std::pair(AtlasKind::Arm, "arm"), std::pair(AtlasKind::Leg, "leg"), std::pair(AtlasKind::Hand, "hand"), std::pair(AtlasKind::Body, "adult")}) {
    const Fitted tried = best_start({kind}, target, progress);
    if (tried.body && tried.misfit < best.first) best = {tried.misfit, name};
  }
  return best.second;
}

}  // namespace limber
