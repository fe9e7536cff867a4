// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/auto_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>

#include <glm/gtc/quaternion.hpp>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/rig/articulated_fit.h"
#include "core/rig/body_atlas.h"
#include "core/rig/body_skeleton.h"
#include "core/rig/capsule_atlas.h"
#include "core/bones/guess_bone_labels.h"
#include "core/rig/draw_inside.h"
#include "core/rig/fit_starts.h"
#include "core/rig/joint_landmarks.h"
#include "core/rig/limb_paths.h"
#include "core/rig/named_joints.h"
#include "core/rig/rig_placing.h"
#include "core/rig/surface_points.h"
#include "core/rig/tissue_cuts.h"
#include "core/volume/distance.h"

namespace limber {

namespace {

constexpr double kCells = 380;      // along the longest side of the tissue
constexpr double kRoughCells = 190;
constexpr double kLeastBone = 0.004;  // of all tissue: less bone than that is no skeleton
constexpr std::int64_t kBoneCells = 6000;

// What is fitted to.
struct Target {
  Occupancy body, rough_body, bone_body;  // rough enough for ways through it
  std::vector<TissueCut> cuts;
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

std::vector<SurfacePoint> surface_seen(const Occupancy& cells, const std::vector<TissueCut>& cuts) {
  std::vector<SurfacePoint> points = surface_points(cells);
  drop_cut_faces(points, cuts, 1.5 * std::max({cells.grid.spacing.x, cells.grid.spacing.y, cells.grid.spacing.z}));
  return points;
}

Target make_target(const LabelVolume& volume) {
  const VoxelBox box = tissue_box(volume);
  if (box.voxel_count() == 0) throw Error("a volume without tissue cannot be rigged", "every voxel is air", "give a label volume with tissue");
  Target target;
  const glm::dvec3 sides = glm::dvec3(box.size) * volume.grid.spacing;
  const double longest = std::max({sides.x, sides.y, sides.z}), spacing = longest / kCells;
  LabelSet all(65536, 1);
  all[0] = 0;

  target.body = occupancy_of(volume, all, spacing);
  close_body(target.body);
  target.rough_body = coarsened(target.body, longest / kRoughCells);
  target.length = glm::length(sides);
  target.cell = std::max({target.body.grid.spacing.x, target.body.grid.spacing.y, target.body.grid.spacing.z});
  target.cuts = tissue_cuts(volume);
  target.skin.emplace(surface_seen(target.body, target.cuts), longest / 150, target.cuts);
  return target;
}

// Of these labels; nothing where they are no skeleton.
void add_bone(Target& target, const LabelVolume& volume, const LabelSet& labels) {
  const glm::dvec3 sides = glm::dvec3(tissue_box(volume).size) * volume.grid.spacing;
  const double longest = std::max({sides.x, sides.y, sides.z});
  target.bone_body = occupancy_of(volume, labels, longest / kCells);
  const auto filled = [](const Occupancy& cells) {
    return parallel_sum(std::ssize(cells.share), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
      double sum = 0;
      for (std::int64_t i = begin; i < end; ++i) sum += cells.share[i];
      return sum;
    });
  };
  if (filled(target.bone_body) <= kLeastBone * filled(target.body)) return;
  target.bone.emplace(surface_seen(target.bone_body, target.cuts), longest / 200, target.cuts);
  target.bone_cells = filled_cells(target.bone_body, kBoneCells);
}

// Too few points of surface say nothing of a body.
bool has_shape(const Target& target) {
  constexpr std::int64_t kLeast = 300;
  return std::ssize(target.skin->points) >= kLeast;
}

bool ends_with_any(const std::string& name, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(), [&](const char* part) { return name.ends_with(part); });
}

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
  bool is_capsules = false;  // of a body that only its rig tells of
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
  // Ribs, skull and hip bones stand far off any rig's lines: told after a few steps.
  constexpr double kNearlyAll = 0.9;
  FitStage stage{.iterations = 8, .wide = 0.02 * L, .narrow = 0.02 * L, .bone_share = 0.8, .stride = 6};
  fit_rods(rods, target.bone_cells, *target.skin, stage);
  if (rod_share(rods, target.bone_cells, target.bone_body, 0.03 * L).near < kNearlyAll) return false;
  rods = m;
  stage.iterations = 40, stage.narrow = 0.006 * L, stage.stride = 3;
  fit_rods(rods, target.bone_cells, *target.skin, stage);
  split_rods(rods, target.bone_cells);
  const RodShare share = rod_share(rods, target.bone_cells, target.bone_body, 0.015 * L);
  if (share.near < 0.9 || share.inside < 0.85) return false;
  m = rods;
  return true;
}

// Of a body that only its rig tells of: its segments drawn into the bones, kept where more bone lies close around them then.
bool follow_bones(Mannequin& m, const Target& target) {
  constexpr double kClose = 0.025, kMost = 0.8;  // of the tissue's diagonal; share of the bone
  const double L = target.length;
  Mannequin drawn = m;
  fit_rods(drawn, target.bone_cells, *target.skin, {.iterations = 40, .wide = 0.03 * L, .narrow = 0.008 * L, .bone_share = 0.6, .stride = 3});
  const double before = rod_share(m, target.bone_cells, target.bone_body, kClose * L).near, after = rod_share(drawn, target.bone_cells, target.bone_body, kClose * L).near;
  if (after < kMost || after < before) return false;
  m = drawn;
  return true;
}

std::vector<std::uint8_t> branch_of(const Armature& rig, int root) {
  std::vector<std::uint8_t> in(rig.bones.size(), 0);
  for (int b = root; b < std::ssize(rig.bones); ++b) in[b] = b == root || (rig.bones[b].parent >= 0 && in[rig.bones[b].parent]);
  return in;
}

// A hand and what it is compared by.
struct HandFit {
  int hand = 0, knuckle = 0, index = 0, little = 0;
  FitStage stage;
  double palm = 0;
};

std::optional<HandFit> hand_fit(const Mannequin& m, int hand) {
  const Armature& rig = m.atlas().rig;
  const std::string side = rig.bones[hand].name.substr(0, rig.bones[hand].name.size() - 4);
  const auto knuckle = rig.find(side + "MiddleProximal"), index = rig.find(side + "IndexProximal"), little = rig.find(side + "LittleProximal");
  if (!knuckle || !index || !little) return std::nullopt;
  HandFit fit{.hand = hand, .knuckle = *knuckle, .index = *index, .little = *little};
  fit.palm = glm::distance(m.joint(hand), m.joint(*knuckle));
  fit.stage = {.iterations = 14, .wide = 0.2 * fit.palm, .narrow = 0.04 * fit.palm, .turns = branch_of(rig, hand), .stretches = false, .bone_share = 0.6, .stride = 3};
  fit.stage.points = fit.stage.turns;
  fit.stage.around = m.joint(*knuckle), fit.stage.reach = 1.6 * fit.palm;
  return fit;
}

// The hand of one side bent like the other's.
void bend_alike(Mannequin& m, int hand, int other) {
  const Armature& rig = m.atlas().rig;
  const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  const std::vector<std::uint8_t> below = branch_of(rig, hand);
  // Bones of both hands stand in the same order.
  for (int b = hand; b < m.bone_count(); ++b)
    if (below[b]) {
      const int there = other + b - hand;
      m.turn[b] = m.turn[rig.bones[b].parent] * mirror * (glm::transpose(m.turn[rig.bones[there].parent]) * m.turn[there]) * mirror;
    }
  m.settle();
}

// A hand can come to lie one finger beside itself, or with its palm out. It is tried turned in its plane and about the forearm,
// then bent like the other one, and what fits best is kept.
void try_hands(Mannequin& m, const Target& target, const FitSurface* bone) {
  const Armature& rig = m.atlas().rig;
  std::vector<std::pair<int, double>> hands;  // and their misfit
  const auto keep_better = [&](Mannequin& best, double& least, Mannequin tried, const HandFit& hand, double share) {
    fit(tried, &*target.skin, bone, hand.stage);
    const double off = misfit(tried, &*target.skin, bone, 0.25 * hand.palm, hand.stage);
    if (off < least * share) least = off, best = std::move(tried);
  };
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (!rig.bones[b].name.ends_with("Hand")) continue;
    const auto hand = hand_fit(m, b);
    if (!hand) continue;
    const glm::dvec3 along = glm::normalize(m.joint(hand->knuckle) - m.joint(b)), normal = glm::normalize(glm::cross(along, m.joint(hand->index) - m.joint(hand->little)));
    Mannequin best = m;
    double least = 1e300;
    for (double twist : {0.0, -0.7, 0.7, -1.6, 1.6, 3.14})
      for (double aside : {0.0, -0.25, 0.25}) {
        if (std::abs(twist) > 1 && aside != 0) continue;
        Mannequin tried = m;
        tried.turn_branch(b, glm::mat3_cast(glm::angleAxis(twist, along) * glm::angleAxis(aside, normal)));
        keep_better(best, least, tried, *hand, twist == 0 && aside == 0 ? 1 : 0.97);  // without need it stays as it is
      }
    m = best;
    hands.push_back({b, least});
  }
  if (hands.size() != 2) return;
  for (int k = 0; k < 2; ++k) {
    auto& [hand, least] = hands[k];
    Mannequin tried = m, best = m;
    bend_alike(tried, hand, hands[1 - k].first);
    if (const auto how = hand_fit(m, hand)) keep_better(best, least, tried, *how, 1);
    m = best;
  }
}

// The hands open and of the size that the limbs have: what was drawn onto fingers that are not its own is bent and shrunk.
Mannequin with_fresh_hands(const Mannequin& m) {
  Mannequin fresh = m;
  const Armature& rig = m.atlas().rig;
  double size = 0;
  int limbs = 0;
  for (int b = 0; b < m.bone_count(); ++b)
    if (ends_with_any(rig.bones[b].name, {"UpperArm", "Forearm", "Thigh", "Shank"})) size += m.along[m.group_of(b)], ++limbs;
  for (int b = 0; b < m.bone_count() && limbs > 0; ++b)
    if (is_digit(rig.bones[b].name) && rig.bones[b].name != "Jaw") {
      fresh.turn[b] = fresh.turn[rig.bones[b].parent];
      fresh.along[m.group_of(b)] = fresh.across[m.group_of(b)] = size / limbs;
    } else if (rig.bones[b].name.ends_with("Hand")) {
      fresh.along[m.group_of(b)] = fresh.across[m.group_of(b)] = size / limbs;
    }
  fresh.settle();
  return fresh;
}

// Open hands of the size that the limbs have, turned about their forearms and drawn onto the skin with the forearm's own turn
// and all sizes free.
Mannequin with_turned_hands(const Mannequin& m, double twist, const Target& target) {
  Mannequin turned = with_fresh_hands(m);
  const Armature& rig = m.atlas().rig;
  for (int b = 0; b < m.bone_count(); ++b) {
    if (!rig.bones[b].name.ends_with("Hand")) continue;
    const auto hand = hand_fit(turned, b);
    if (!hand) continue;
    FitStage stage = hand->stage;
    stage.turns = stage.points = branch_of(rig, std::max(0, rig.bones[b].parent));
    stage.stretches = true, stage.iterations = 25, stage.wide = 0.4 * hand->palm, stage.narrow = 0.06 * hand->palm;
    const bool left = rig.bones[b].name.starts_with("Left");
    turned.turn_branch(b, glm::mat3_cast(glm::angleAxis(left ? -twist : twist, glm::normalize(turned.joint(hand->knuckle) - turned.joint(b)))));
    fit(turned, &*target.skin, nullptr, stage);
  }
  // All but the arms keeps its place and size, which nothing asked for in that.
  turned.root = m.root;
  std::vector<std::uint8_t> of_arm(m.group_count(), 0);
  for (int b = 0; b < m.bone_count(); ++b) of_arm[m.group_of(b)] |= ends_with_any(rig.bones[b].name, {"Forearm", "Hand"}) || (is_digit(rig.bones[b].name) && rig.bones[b].name != "Jaw");
  for (int g = 0; g < m.group_count(); ++g)
    if (!of_arm[g]) turned.along[g] = m.along[g], turned.across[g] = m.across[g];
  turned.settle();
  return turned;
}

// How much of the fingers' skin lies where it should, 0 .. 1; 1 for a body without hands. Finger bones are thinner than many
// voxels are.
double hands_near(const Mannequin& m, const Target& target) {
  const std::vector<double> share = share_near(m, *target.skin, false, 2.5 + target.cell);
  double sum = 0;
  int digits = 0;
  for (int b = 0; b < m.bone_count(); ++b)
    if (is_digit(m.atlas().rig.bones[b].name) && m.atlas().rig.bones[b].name != "Jaw" && share[b] >= 0) sum += share[b], ++digits;
  return digits ? sum / digits : 1;
}

void refine_by_skin(Fitted& result, const Target& target) {
  const double L = target.length;
  fit(*result.body, &*target.skin, nullptr, {.iterations = 20, .wide = 0.03 * L, .narrow = 0.01 * L, .turns = without_digits(result.atlas->rig), .stride = 3});
}

// Hands first, then all, roughly with some of the points and to the end with all of them.
void finish(Mannequin& m, const Target& target, const FitSurface* bone, bool is_rods) {
  const double L = target.length;
  try_hands(m, target, bone);
  // Voxels coarser than finger bones are thick show skin better than bone.
  const double bone_share = 0.8 * std::min(1.0, 4 / target.cell);
  if (is_rods) return;
  for (const auto& [iterations, stride, wide, narrow] : {std::tuple(14, 3, 0.012, 0.005), std::tuple(9, 1, 0.005, bone ? 0.003 : 0.004)})
    fit(m, &*target.skin, bone, {.iterations = iterations, .wide = wide * L, .narrow = narrow * L, .bone_share = bone_share, .stride = stride});
}

void refine(Fitted& result, const Target& target, Progress& progress) {
  Mannequin& m = *result.body;
  const double L = target.length;
  const FitSurface* bone = target.bone && !result.is_capsules ? &*target.bone : nullptr;
  if (target.bone && result.is_capsules) {
    result.is_rods = follow_bones(m, target);
  } else if (bone && follow_rods(m, target)) {
    result.is_rods = true;
    bone = nullptr;
  } else if (bone) {
    fit(m, &*target.skin, bone, {.iterations = 24, .wide = 0.03 * L, .narrow = 0.006 * L, .turns = without_digits(result.atlas->rig), .bone_share = 0.7, .stride = 2});
  }
  progress.update("fitting", 0.6);
  const Mannequin before = m;
  finish(m, target, bone, result.is_rods);
  // Hands that lie on nothing like a hand may be turned another way.
  constexpr double kLittle = 0.78, kBetter = 1.05;
  double most = hands_near(m, target);
  for (double twist : {0.0, 3.14, 1.57, -1.57}) {
    if (most > kLittle) break;
    Mannequin turned = with_turned_hands(before, twist, target);
    finish(turned, target, bone, result.is_rods);
    const double share = hands_near(turned, target);
    if (share > kBetter * most) most = share, m = turned;
  }
  result.misfit = std::sqrt(misfit(m, &*target.skin, nullptr, 0.04 * L, {}));
  progress.update("fitting", 1);
}

}  // namespace

std::string_view to_string(JointFit::How how) {
  switch (how) {
    case JointFit::How::Skin: return "skin";
    case JointFit::How::BoneSurface: return "bone surface";
    case JointFit::How::BoneAxis: return "bone axis";
    case JointFit::How::Girth: return "girth";
    case JointFit::How::Ball: return "joint ball";
    case JointFit::How::NamedBones: return "named bones";
    case JointFit::How::Carried: return "carried along";
    case JointFit::How::Extents: return "extents";
    case JointFit::How::Unseen: return "proportion";
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
      take_best_start(tried, target, kind == AtlasKind::Body ? body_starts(*tried.atlas, target.rough_body, target.cuts) : limb_starts(*tried.atlas, target.rough_body, kind, target.cuts));
      if (tried.body && tried.misfit < best.misfit) best = tried;
    }
  }
  return best;
}

// From a bone at a limb's end up to the first that hangs from the trunk.
std::vector<int> limb_to(const Armature& rig, int last) {
  std::vector<int> children(rig.bones.size(), 0), limb{last};
  for (const Bone& bone : rig.bones)
    if (bone.parent >= 0) ++children[bone.parent];
  for (int b = rig.bones[last].parent; b >= 0 && children[b] == 1 && rig.bones[b].parent >= 0; b = rig.bones[b].parent) limb.push_back(b);
  std::reverse(limb.begin(), limb.end());
  return limb;
}

// Limbs that end short of the tissue's ends, or beyond them, are aimed at those and stretched; both sides alike.
void reach_ends(Mannequin& m, const Occupancy& body) {
  constexpr double kMost = 0.6, kNear = 0.7;  // logarithm of the stretch; of the limb's length
  const Armature& rig = m.atlas().rig;
  std::vector<std::uint8_t> is_last(rig.bones.size(), 1);
  for (const Bone& bone : rig.bones)
    if (bone.parent >= 0) is_last[bone.parent] = 0;
  std::map<int, std::pair<double, int>> stretch;  // by group: sum and count
  struct Aim {
    int root, last;
    glm::dvec3 end;
  };
  std::vector<Aim> aims;
  for (const LimbPath& path : limb_paths(body, PathCentre::Thickest)) {
    const glm::dvec3 end = path.points.front();
    const auto apart = [&](int b) { return is_last[b] ? glm::distance(m.carried(b, rig.bones[b].tail), end) : 1e300; };
    int last = 0;
    for (int b = 1; b < m.bone_count(); ++b)
      if (apart(b) < apart(last)) last = b;
    const std::vector<int> limb = limb_to(rig, last);
    double length = 0;
    for (int b : limb) length += glm::distance(m.joint(b), m.carried(b, rig.bones[b].tail));
    const bool taken = std::any_of(aims.begin(), aims.end(), [&](const Aim& aim) { return aim.last == last; });
    if (taken || !(length > 0) || apart(last) > kNear * length) continue;
    const glm::dvec3 root = m.joint(limb.front()), tail = m.carried(last, rig.bones[last].tail);
    if (!(glm::distance(tail, root) > 0) || !(glm::distance(end, root) > 0)) continue;
    const double by = std::clamp(std::log(glm::distance(end, root) / glm::distance(tail, root)), -kMost, kMost);
    for (int b : limb) stretch[m.group_of(b)].first += by, ++stretch[m.group_of(b)].second;
    aims.push_back({limb.front(), last, end});
  }
  for (const auto& [group, sum] : stretch) m.along[group] += sum.first / sum.second;
  m.settle();
  for (const Aim& aim : aims) {
    const glm::dvec3 root = m.joint(aim.root), tail = m.carried(aim.last, rig.bones[aim.last].tail);
    m.turn_branch(aim.root, glm::mat3_cast(shortest_turn(tail - root, aim.end - root)));
  }
}

// A body that is not known but for the rig.
Fitted capsule_start(const Armature& rig, const Target& target, Progress& progress) {
  progress.update("starting", 0);
  Fitted tried{.atlas = std::make_shared<BodyAtlas>(capsule_atlas(rig)), .body = std::nullopt, .is_capsules = true};
  take_best_start(tried, target, turned_starts(*tried.atlas, target.rough_body));
  if (!tried.body) return tried;
  refine_by_skin(tried, target);
  reach_ends(*tried.body, target.rough_body);
  return tried;
}

// The bones that are seen well enough, and from one to the next: those beyond a cut are not, nor a hand whose forearm is cut
// away; but both legs of a body without hips are, since they hang from one bone.
std::vector<std::uint8_t> seen_bones(const Fitted& fitted, const Target& target) {
  constexpr double kLeast = 0.3;  // of a bone's skin
  const Mannequin& m = *fitted.body;
  std::vector<double> all(m.bone_count(), 0), inside(all);
  for (const AtlasPoint& point : m.atlas().skin) ++all[point.bone], inside[point.bone] += beyond(target.cuts, m.carried(point.bone, point.place)) <= 0;
  // Pieces of the skeleton by the bone they hang from.
  std::vector<int> piece(m.bone_count(), -1);
  std::vector<double> weight(m.bone_count(), 0);
  for (int b = 0; b < m.bone_count(); ++b) {
    const int parent = m.atlas().rig.bones[b].parent;
    const bool seen = all[b] > 0 ? inside[b] >= kLeast * all[b] : parent >= 0 && piece[parent] >= 0;
    if (!seen) continue;
    piece[b] = parent < 0 ? b : piece[parent] >= 0 ? piece[parent] : parent;
    weight[piece[b]] += inside[b];
  }
  const int largest = static_cast<int>(std::max_element(weight.begin(), weight.end()) - weight.begin());
  std::vector<std::uint8_t> result;
  for (int b = 0; b < m.bone_count(); ++b) result.push_back(piece[b] == largest);
  return result;
}

// Bones that nothing shows lie as those of the other side do, or as the atlas has them.
void lay_unseen(Fitted& fitted, const std::vector<std::uint8_t>& seen) {
  Mannequin& m = *fitted.body;
  const Armature& rig = m.atlas().rig;
  const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  std::vector<std::uint8_t> holds_seen = seen;
  for (int b = m.bone_count(); b-- > 0;)
    if (holds_seen[b] && rig.bones[b].parent >= 0) holds_seen[rig.bones[b].parent] = 1;
  for (int b = 0; b < m.bone_count(); ++b) {
    const int parent = rig.bones[b].parent;
    if (holds_seen[b] || parent < 0) continue;
    m.turn[b] = m.turn[parent];
    const std::string& name = rig.bones[b].name;
    const auto other = name.starts_with("Left") ? rig.find("Right" + name.substr(4)) : name.starts_with("Right") ? rig.find("Left" + name.substr(5)) : std::nullopt;
    if (other && seen[*other]) m.turn[b] = m.turn[parent] * mirror * glm::transpose(m.turn[rig.bones[*other].parent]) * m.turn[*other] * mirror;
  }
  m.settle();
}

// Confidence in the heads of the fitted body's bones: how much of the surface on either side of the joint lies where it should.
std::vector<double> shares_near(const Fitted& fitted, const Target& target) {
  const Mannequin& m = *fitted.body;
  const bool by_bone = target.bone && !fitted.is_rods && !fitted.is_capsules;
  const double near = by_bone ? 2.5 + 1.2 * target.cell : 2.5 + 0.004 * target.length + target.cell;
  std::vector<double> share = share_near(m, by_bone ? *target.bone : *target.skin, by_bone, near);
  std::vector<double> result(share.size(), 0);
  for (int b = 0; b < m.bone_count(); ++b) {
    const int parent = m.atlas().rig.bones[b].parent;
    double own = share[b], sum = 0;
    int children = 0;
    for (int c = b + 1; c < m.bone_count() && own < 0; ++c)
      if (m.atlas().rig.bones[c].parent == b && share[c] >= 0) sum += share[c], ++children;
    if (own < 0) own = children ? sum / children : 0.5;
    const double above = parent < 0 || share[parent] < 0 ? own : share[parent];
    result[b] = std::sqrt(own * above);
  }
  return result;
}

// Per bone: how little its surface and its parent's is that of the body that was laid over it, 0 for the same and 1 for another
// shape.
struct Likeness {
  double same, other, of_cell;  // mm off for the same shape, mm more for another, and what voxels alone put it off, of a cell
};
std::vector<double> strangeness(const Mannequin& m, const std::vector<AtlasPoint>& points, const FitSurface& surface, const Likeness& like, const Target& target) {
  const Armature& rig = m.atlas().rig;
  std::vector<std::vector<double>> off(m.bone_count());
  const double reach = 0.05 * target.length;
  for (const AtlasPoint& point : points) {
    const glm::dvec3 here = m.carried(point.bone, point.place);
    const int n = surface.tree.nearest(here, m.turn_at(point.bone, point.place) * point.normal, reach);
    if (beyond(target.cuts, here) > 0) continue;
    off[point.bone].push_back(n < 0 ? reach : std::abs(glm::dot(surface.points[n].normal, here - surface.points[n].place)));
  }
  std::vector<double> result;
  for (int b = 0; b < m.bone_count(); ++b) {
    std::vector<double> both = off[b];
    const auto join = [&](int beside) { both.insert(both.end(), off[beside].begin(), off[beside].end()); };
    for (int c = b + 1; c < m.bone_count() && off[b].empty(); ++c)
      if (rig.bones[c].parent == b) join(c);
    if (rig.bones[b].parent >= 0) join(rig.bones[b].parent);
    std::nth_element(both.begin(), both.begin() + both.size() / 2, both.end());
    const double scale = std::exp(m.across[m.group_of(b)]);
    result.push_back(both.empty() ? 1 : std::clamp((both[both.size() / 2] - like.same * scale - like.of_cell * target.cell) / (like.other * scale), 0.0, 1.0));
  }
  return result;
}

// By its skin; and where bones are known that are alike, it is alike, however fat lies over them.
std::vector<double> strangeness(const Fitted& fitted, const Target& target) {
  const Mannequin& m = *fitted.body;
  std::vector<double> result = strangeness(m, m.atlas().skin, *target.skin, {.same = 0.8, .other = 0.8, .of_cell = 0.08}, target);
  if (!target.bone || fitted.is_rods || fitted.is_capsules) return result;
  const std::vector<double> bones = strangeness(m, m.atlas().bone, *target.bone, {.same = 0.5, .other = 0.4, .of_cell = 0.15}, target);
  for (size_t b = 0; b < result.size(); ++b) result[b] = std::min(result[b], bones[b]);
  return result;
}

// Of the whole: the mean of the limbs and the trunk, and 1 where voxels are too coarse to tell.
double whole_strangeness(const Fitted& fitted, const std::vector<double>& strange, const Target& target) {
  constexpr double kFine = 5, kCoarse = 9;  // mm, of a cell
  double sum = 0;
  int bones = 0;
  for (size_t b = 0; b < strange.size(); ++b)
    if (!is_digit(fitted.atlas->rig.bones[b].name)) sum += strange[b], ++bones;
  const double size = std::exp(fitted.body->along[0]);
  return std::max(bones ? sum / bones : 1.0, std::clamp((target.cell / size - kFine) / (kCoarse - kFine), 0.0, 1.0));
}

// The fitted body's joints. Where it is of another shape than the body laid over it, its own landmarks say more.
struct FoundJoints {
  std::vector<glm::dvec3> places;
  std::vector<JointFit> how;
};

// Of a body that only its rig tells of the skin shows how limbs run, and their ends, but not where along them they bend; a limb
// that lies on nothing may lie anywhere about its root.
void doubt_capsules(FoundJoints& found, const std::vector<double>& near, const Mannequin& m, const Target& target) {
  constexpr double kOfWhole = 0.02, kOfBone = 0.2, kLost = 0.75, kEnough = 0.8;  // of the tissue's diagonal, and of a bone's length
  const Armature& rig = m.atlas().rig;
  std::vector<double> lost(rig.bones.size(), 0);
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    const int parent = rig.bones[b].parent;
    const double length = parent < 0 ? glm::distance(m.joint(b), m.carried(b, rig.bones[b].tail)) : glm::distance(m.joint(b), m.joint(parent));
    if (parent >= 0) lost[b] = lost[parent] + kLost * length * std::clamp((kEnough - near[b]) / kEnough, 0.0, 1.0);
    found.how[b].error = kOfWhole * target.length + kOfBone * length + lost[b];
  }
}

FoundJoints found_joints(const Fitted& fitted, const Target& target) {
  using How = JointFit::How;
  // mm within which nine of ten such joints lay on segmented adults, beside those that another shape adds. Of hips even the
  // authors of rigs differ by 5 cm where skin is all there is.
  constexpr double kLeastError = 4, kByBone = 14, kCollarByBone = 28, kFingerByBone = 14, kBySkin = 22, kShoulderBySkin = 26, kCollarBySkin = 36, kHipsBySkin = 58, kByGirth = 12, kHandByGirth = 15, kNeckByGirth = 22, kByBall = 9, kByAxis = 16;
  const Mannequin& m = *fitted.body;
  const Armature& rig = m.atlas().rig;
  const bool by_bone = target.bone && !fitted.is_rods && !fitted.is_capsules;
  const std::vector<double> near = shares_near(fitted, target);
  const std::vector<double> strange = strangeness(fitted, target);
  // A body of another build puts its joints elsewhere also where a bone by itself looks alike, as thin ones always do.
  const double whole = whole_strangeness(fitted, strange, target);
  FoundJoints found;
  for (int b = 0; b < m.bone_count(); ++b) {
    const std::string& name = rig.bones[b].name;
    const bool rod = fitted.is_rods && (fitted.is_capsules || ends_with_any(name, {"UpperArm", "Forearm", "Thigh", "Shank", "Foot"}));
    const double by_skin = ends_with_any(name, {"Thigh", "Hips", "Neck", "Spine"}) ? kHipsBySkin : name.ends_with("UpperArm") ? kShoulderBySkin : kBySkin;
    const bool collar = name.ends_with("Clavicle");
    const double other = by_bone ? (collar ? kCollarByBone : is_digit(name) ? kFingerByBone : kByBone) : collar ? kCollarBySkin : by_skin;
    found.places.push_back(m.joint(b));
    found.how.push_back({.how = rod ? How::BoneAxis : by_bone ? How::BoneSurface : How::Skin, .confidence = rod ? 0.9 : near[b], .error = rod ? kByAxis : kLeastError + std::max(strange[b], whole) * other});
  }
  const auto take = [&](const JointLandmark& mark, How how, double weight, double error) {
    const double off = glm::distance(found.places[mark.bone], mark.place);
    found.places[mark.bone] = glm::mix(found.places[mark.bone], mark.place, weight);
    JointFit& joint = found.how[mark.bone];
    joint.error = std::min(joint.error, glm::mix(joint.error, error, weight));
    // Two ways of finding it that disagree: skin alone slides along a limb, and a joint put between the two is told by neither.
    if (how == How::Girth && joint.how == How::Skin) joint.error = std::max({joint.error, (1 - weight) * off, 4 * weight * (1 - weight) * weight * off});
    if (weight > 0.5) joint.how = how;
  };
  // Skin alone slides along a limb by a tenth of the bone above, rarely more: a waist farther off is another one. Rods say
  // nothing of the hand, which may slide far.
  const auto believable = [&](const JointLandmark& mark) {
    constexpr double kSlides = 0.12, kNever = 0.24;
    const int above = rig.bones[mark.bone].parent;
    if (above < 0 || fitted.is_rods || rig.bones[mark.bone].name == "Neck") return 1.0;
    const double apart = glm::distance(m.joint(mark.bone), mark.place) / glm::distance(m.joint(above), m.joint(mark.bone));
    return std::clamp((kNever - apart) / (kNever - kSlides), 0.0, 1.0);
  };
  for (const JointLandmark& mark : girth_landmarks(m, target.body)) {
    const std::string& name = rig.bones[mark.bone].name;
    // Bones tell elbow and wrist themselves. Of the knee they show the condyles' middle and skin the gap below it; rigs
    // bend in between.
    const double share = name == "Neck" ? 1 : by_bone ? (name.ends_with("Shank") ? 0.5 : 0) : fitted.is_rods ? double(name.ends_with("Hand")) : 1;
    // Flesh folds where a limb is bent, and its waist moves down.
    constexpr double kBent = 45, kHardlyBent = 0.09;  // mm at a right angle, radians
    const double bent = kBent * std::max(0.0, std::sin(mark.bend) - kHardlyBent);
    take(mark, How::Girth, share * strange[mark.bone] * believable(mark), (name == "Neck" ? kNeckByGirth : name.ends_with("Hand") ? kHandByGirth : kByGirth) + bent);
  }
  // A hand that lies against something has no wrist to be seen, and slides.
  constexpr double kHandSlides = 38;
  for (int b = 0; b < m.bone_count(); ++b)
    if (found.how[b].how == How::Skin && rig.bones[b].name.ends_with("Hand")) found.how[b].error = std::max(found.how[b].error, kLeastError + strange[b] * kHandSlides);
  if (by_bone)
    for (const JointLandmark& mark : ball_landmarks(m, *target.bone)) take(mark, How::Ball, strange[mark.bone], kByBall);
  // Where little of the body lies where it should, nothing is sure, whatever was found there.
  // Bones of limbs are much alike, those of trunks are not, and a ball is told by itself.
  constexpr double kFew = 0.35, kFewOfLimb = 0.62, kFewOfHand = 0.7, kFarOff = 100, kLimbFarOff = 300;  // share, and mm for a share of 1 less
  // Of the tissue's diagonal: whole bodies of other shapes came out at 0.011 at most, parts at 0.015 with joints 11 mm off, at
  // 0.019 with 50 mm, and limbs laid the wrong way round above that.
  constexpr double kUnlike = 0.013, kWrong = 6, kSteep = 0.004;
  const double unlike = std::max(0.0, (fitted.is_rods ? 0 : fitted.misfit) / target.length - kUnlike);
  const double wrong = kWrong * unlike * target.length * (1 + unlike * unlike / (kSteep * kSteep));
  const auto doubt = [&](int b) {
    const std::string& name = rig.bones[b].name;
    const bool in_limb = by_bone && ends_with_any(name, {"UpperArm", "Forearm", "Hand", "Thigh", "Shank", "Foot"});
    const double few = !in_limb || found.how[b].how == How::Ball ? kFew : name.ends_with("Hand") ? kFewOfHand : kFewOfLimb;
    return (in_limb ? kLimbFarOff : kFarOff) * std::max(0.0, few - near[b]);
  };
  // Fingers that lie on nothing like fingers may be those of a hand that is turned another way.
  constexpr double kHandShare = 0.85, kHandFarOff = 120;
  if (!fitted.is_capsules) {
    const double lost = kHandFarOff * std::max(0.0, kHandShare - hands_near(m, target));
    for (int b = 0; b < m.bone_count(); ++b)
      if (is_digit(rig.bones[b].name) && rig.bones[b].name != "Jaw") found.how[b].error += lost;
  }
  if (fitted.is_capsules) doubt_capsules(found, near, m, target);
  // Half sure of what may lie off by as much as a joint is thick.
  constexpr double kJoint = 40;
  for (int b = 0; b < m.bone_count(); ++b) {
    JointFit& joint = found.how[b];
    if (joint.how != How::BoneAxis) joint.error = std::max(joint.error, doubt(b));
    joint.error = std::max(joint.error, wrong);
    joint.confidence *= 1 / (1 + joint.error / kJoint);
  }
  return found;
}

// The labels that are bone, as the table says. Where it says nothing of any label: the one that lies along the long bones of the
// body, as it lies by its skin.
LabelSet bone_labels(const LabelVolume& volume, const TissueTable& tissues, const Fitted& fitted, std::vector<std::string>& warnings) {
  LabelSet labels(65536, 0);
  const std::vector<TissueKind> kinds = tissues.kinds();
  for (size_t label = 1; label < kinds.size(); ++label) labels[label] = is_bone(kinds[label]);
  const Mannequin& m = *fitted.body;
  Armature long_bones;
  for (int b = 0; b < m.bone_count(); ++b) {
    const Bone& bone = m.atlas().rig.bones[b];
    if (fitted.is_capsules || ends_with_any(bone.name, {"UpperArm", "Forearm", "Thigh", "Shank"})) long_bones.bones.push_back({.name = bone.name, .parent = -1, .head = m.joint(b), .tail = m.carried(b, bone.tail)});
  }
  if (const auto guess = guess_bone_tissue(volume, tissues, long_bones)) {
    const Tissue* tissue = tissues.find(guess->label);
    char text[160];
    std::snprintf(text, sizeof text, "no table says what is bone: label %.0f, which lies along %.0f %% of the long bones, is taken for it",
                  tissue ? tissue->file_value : double(guess->label), 100 * guess->share_of_rig);
    warnings.push_back(text);
    labels[guess->label] = 1;
  }
  return labels;
}

// The joints that the names of bones tell, with the body laid along them.
std::vector<NamedJoint> joints_by_name(Fitted& fitted, const Target& target, const LabelVolume& volume, const TissueTable& tissues) {
  Mannequin& m = *fitted.body;
  std::vector<NamedJoint> joints = named_joints(volume, tissues, m);
  if (!same_sides(m, joints)) {
    const glm::dvec3 up = m.turn[0] * m.rest_axis(0);
    m.turn_branch(0, glm::mat3_cast(glm::angleAxis(3.14159265358979323846, glm::normalize(up))));
    refine_by_skin(fitted, target);
    joints = named_joints(volume, tissues, m);
  }
  lay_along(m, joints);
  return joints;
}

// What the names of bones say counts; what hangs from such a joint moves along.
void take_named(FoundJoints& found, const Armature& rig, const std::vector<NamedJoint>& named, double size) {
  // That the body puts its joints elsewhere between the same bones moves nothing else.
  constexpr double kElsewhere = 0.009;
  std::vector<glm::dvec3> shift(rig.bones.size(), glm::dvec3(0));
  std::vector<const NamedJoint*> own(rig.bones.size(), nullptr);
  for (const NamedJoint& joint : named) own[joint.bone] = &joint;
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (own[b]) {
      const glm::dvec3 off = own[b]->place - found.places[b];
      shift[b] = off * std::max(0.0, 1 - kElsewhere * size / std::max(glm::length(off), 1e-9));
      found.places[b] = own[b]->place;
      found.how[b] = {.how = JointFit::How::NamedBones, .confidence = 0.95, .error = own[b]->error};
    } else if (rig.bones[b].parent >= 0) {
      shift[b] = shift[rig.bones[b].parent];
      found.places[b] += shift[b];
    }
  }
}

// What lies beyond a cut is laid on by proportion alone, and a limb that is cut off looks short.
void doubt_cut_limbs(const Fitted& fitted, const Target& target, FoundJoints& found, std::vector<std::string>& warnings) {
  constexpr double kNear = 0.05, kStrange = 5;  // of the tissue's diagonal; mm of error from which a joint is of another shape
  constexpr double kLeast = 36, kGrowth = 0.33;  // mm off at the cut, and more with every mm beyond it
  constexpr double kSureBall = 12;               // mm: a ball that is this sure is one, however near the cut
  const Armature& rig = fitted.atlas->rig;
  const std::vector<std::uint8_t> seen = seen_bones(fitted, target);
  std::string unseen, doubted;
  std::vector<std::uint8_t> near_cut(rig.bones.size(), 0);
  const auto list = [&](std::string& names, int b) { names += (names.empty() ? "" : ", ") + rig.bones[b].name; };
  for (int b = 0; b < std::ssize(rig.bones) && !target.cuts.empty(); ++b) {
    const double out = beyond(target.cuts, found.places[b]);
    JointFit& joint = found.how[b];
    const int parent = rig.bones[b].parent;
    if (joint.how == JointFit::How::NamedBones) continue;
    if (out > 0 || (!seen[b] && (parent < 0 || !seen[parent]))) {
      const double from_cut = out > 0 ? out : 0.1 * target.length;
      joint = {.how = JointFit::How::Unseen, .confidence = 0, .error = std::max(joint.error, kLeast + kGrowth * from_cut)};
      // Each bone on the way from what is seen may be turned otherwise.
      if (parent >= 0 && !seen[parent]) joint.error = std::max(joint.error, found.how[parent].error + kGrowth * glm::distance(found.places[parent], found.places[b]));
      if (!is_digit(rig.bones[b].name)) list(unseen, b);
    } else if (out > -kNear * target.length && joint.error > kStrange && !(joint.how == JointFit::How::Ball && joint.error < kSureBall)) {
      near_cut[b] = 1;
      joint.confidence *= 0.4;
      joint.error = std::max(joint.error, kLeast);
      if (!is_digit(rig.bones[b].name)) list(doubted, b);
    }
  }
  // And what lies next to such a joint slides with it.
  constexpr double kWithIt = 0.35, kMost = 100, kLessSure = 0.6;
  const std::vector<JointFit> own = found.how;
  const auto is_doubted = [&](int b) { return !is_digit(rig.bones[b].name) && (own[b].how == JointFit::How::Unseen || near_cut[b]); };
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (is_doubted(b) || own[b].how == JointFit::How::Unseen || own[b].how == JointFit::How::NamedBones || own[b].error <= kStrange) continue;
    double beside = 0;
    for (int c = 0; c < std::ssize(rig.bones); ++c)
      if ((rig.bones[c].parent == b || rig.bones[b].parent == c) && is_doubted(c)) beside = std::max(beside, own[c].error);
    if (beside == 0) continue;
    found.how[b].error = std::max(own[b].error, kWithIt * std::min(kMost, beside));
    found.how[b].confidence *= kLessSure;
  }
  // A limb alone that is cut off at its upper end may be longer or shorter than it looks, from its free end on.
  constexpr double kLonger = 0.13;
  const auto upper = std::find_if(rig.bones.begin(), rig.bones.end(), [](const Bone& bone) { return bone.name == "UpperArm" || bone.name == "Thigh"; });
  if (upper != rig.bones.end() && is_doubted(static_cast<int>(upper - rig.bones.begin()))) {
    std::vector<double> from_end(rig.bones.size(), 0);
    for (int b = static_cast<int>(std::ssize(rig.bones)); b-- > 0;) {
      if (from_end[b] == 0) from_end[b] = glm::distance(rig.bones[b].head, rig.bones[b].tail);
      if (const int parent = rig.bones[b].parent; parent >= 0) from_end[parent] = std::max(from_end[parent], from_end[b] + glm::distance(found.places[parent], found.places[b]));
      if (own[b].error > kStrange) found.how[b].error = std::max(found.how[b].error, kLonger * from_end[b]);
    }
  }
  if (!unseen.empty()) warnings.push_back("the tissue is cut off, and beyond the cut these joints are laid on by proportion alone: " + unseen);
  if (!doubted.empty()) warnings.push_back("the tissue is cut off close to these joints, which may lie far off: " + doubted);
}

AutoFit by_extents(const LabelVolume& volume, const Armature& rig, const std::string& reason) {
  AutoFit result;
  result.armature = scaled_to_tissue(volume, rig);
  const double error = error_by_extents(volume);
  result.joints.assign(rig.bones.size(), {JointFit::How::Extents, 0.1, error});
  result.warnings.push_back(reason + ": the rig was only scaled to the tissue's extents, and its joints may lie up to some " + std::to_string(std::lround(error)) + " mm off");
  return result;
}

void warn_of_joints(AutoFit& result) {
  constexpr double kDoubtful = 0.35, kOutside = 0.85, kFarOff = 18;
  std::string doubtful, outside, far_off;
  double farthest = 0;
  for (size_t b = 0; b < result.joints.size(); ++b) {
    const JointFit& joint = result.joints[b];
    const auto list = [&](std::string& names) { names += (names.empty() ? "" : ", ") + result.armature.bones[b].name; };
    const bool found = joint.how != JointFit::How::Carried && joint.how != JointFit::How::Extents && joint.how != JointFit::How::Unseen;
    if (found && joint.confidence < kDoubtful) list(doubtful);
    else if (found && joint.error > kFarOff) list(far_off), farthest = std::max(farthest, joint.error);
    if (result.check.share[b] < kOutside) list(outside);
  }
  if (!doubtful.empty()) result.warnings.push_back("found with little confidence, check by eye: " + doubtful);
  if (!far_off.empty()) result.warnings.push_back("the body is of another shape here and little tells these joints, which may lie up to some " + std::to_string(std::lround(farthest)) + " mm off: " + far_off);
  if (!outside.empty()) result.warnings.push_back("bones that leave the tissue: " + outside);
}

}  // namespace

double error_by_extents(const LabelVolume& volume) {
  constexpr double kShare = 0.35;  // of the diagonal: a joint can lie at the other end of a body that is turned around
  return kShare * glm::length(glm::dvec3(tissue_box(volume).size) * volume.grid.spacing);
}

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
  Target target = make_target(volume);
  progress.update("surfaces", 1);
  AutoFit result;
  const std::vector<AtlasKind> kinds = kinds_for(rig);
  Fitted fitted;
  if (has_shape(target)) {
    if (!kinds.empty()) fitted = best_start(kinds, target, progress);
    else if (has_trunk(rig)) fitted = capsule_start(rig, target, progress);
  }
  if (!fitted.body) {
    result = by_extents(volume, rig, kinds.empty() ? "the bones' names do not tell of a body that is known" : "the tissue has hardly any surface");
  } else {
    progress.update("fitting", 0);
    refine_by_skin(fitted, target);
    const std::vector<NamedJoint> named = joints_by_name(fitted, target, volume, tissues);
    progress.update("fitting", 0.3);
    add_bone(target, volume, bone_labels(volume, tissues, fitted, result.warnings));
    refine(fitted, target, progress);
    if (!target.cuts.empty()) lay_unseen(fitted, seen_bones(fitted, target));
    FoundJoints found = found_joints(fitted, target);
    take_named(found, fitted.atlas->rig, named, target.length);
    doubt_cut_limbs(fitted, target, found, result.warnings);
    const PlacedRig placed = place_rig(rig, *fitted.body, found.places);
    result.misfit_mm = fitted.misfit;
    for (size_t b = 0; b < rig.bones.size(); ++b) {
      const int match = placed.joint_of[b];
      JointFit joint;
      if (match >= 0) joint = found.how[match];
      // What rides along is as sure as what it rides on, and a little less.
      else if (rig.bones[b].parent >= 0) joint.confidence = 0.7 * result.joints[rig.bones[b].parent].confidence, joint.error = 1.4 * result.joints[rig.bones[b].parent].error;
      result.joints.push_back(joint);
    }
    // A joint gives way by what it may be off, not by much more.
    constexpr double kGivesWay = 1.25;
    std::vector<double> free;
    for (const JointFit& joint : result.joints) free.push_back(kGivesWay * joint.error);
    result.armature = drawn_inside(placed.armature, volume, target.cuts, free);
    constexpr double kUnlike = 0.016;  // of the tissue's diagonal
    if (result.misfit_mm > kUnlike * target.length) result.warnings.push_back("the tissue looks little like the body that this rig is of; check every joint by eye");
  }
  result.check = check_rig(volume, result.armature);
  warn_of_joints(result);
  return result;
}

std::string suggest_template(const LabelVolume& volume, Progress& progress) {
  const Target target = make_target(volume);
  if (!has_shape(target)) return "arm";
  // A body has five ends that stand far out, or three at least where arms lie at the trunk.
  const size_t ends = limb_paths(target.rough_body, PathCentre::Thickest).size();
  if (ends >= 5) {
    const double whole = best_start({AtlasKind::Body}, target, progress).misfit;
    if (whole < 0.02 * target.length) return "adult";
  }
  std::pair<double, std::string> best{std::numeric_limits<double>::max(), "arm"};
  for (const auto& [kind, name] : {std::pair(AtlasKind::Arm, "arm"), std::pair(AtlasKind::Leg, "leg"), std::pair(AtlasKind::Hand, "hand"), std::pair(AtlasKind::Body, "adult")}) {
    if (kind == AtlasKind::Body && ends < 3) continue;
    const Fitted tried = best_start({kind}, target, progress);
    if (tried.body && tried.misfit < best.first) best = {tried.misfit, name};
  }
  return best.second;
}

}  // namespace limber
