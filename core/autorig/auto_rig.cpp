// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/auto_rig.h"

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

#include "core/autorig/articulated_fit.h"
#include "core/autorig/body_atlas.h"
#include "core/autorig/capsule_atlas.h"
#include "core/autorig/cut_planes.h"
#include "core/autorig/fit_target.h"
#include "core/autorig/fitted_limits.h"
#include "core/autorig/found_joints.h"
#include "core/autorig/hand_fit.h"
#include "core/autorig/initial_guess.h"
#include "core/autorig/limb_paths.h"
#include "core/autorig/named_joints.h"
#include "core/autorig/place_rig.h"
#include "core/autorig/pull_inside.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/bones/guess_bone_labels.h"
#include "core/mesh/surface_points.h"
#include "core/motion/body_frame.h"
#include "core/volume/distance_transform.h"

namespace limber {

namespace {

std::vector<std::uint8_t> without_digits(const Armature& rig) {
  std::vector<std::uint8_t> free;
  for (const Bone& bone : rig.bones) free.push_back(!is_digit(bone.name));
  return free;
}

// Fits every initial guess of the pose roughly and the kInEarnest best of them more exactly. Stores the best fit in
// `result`.
void take_best_start(Fitted& result, const FitTarget& target, std::vector<Mannequin> starts) {
  constexpr size_t kInEarnest = 5;
  const auto main = without_digits(result.atlas->rig);
  const double L = target.length;
  std::vector<std::pair<double, size_t>> order;
  if (starts.size() > kInEarnest) {
    for (size_t k = 0; k < starts.size(); ++k) {
      fit(starts[k], &*target.skin, nullptr,
          {.iterations = 6, .wide = 0.06 * L, .narrow = 0.03 * L, .turns = main, .stride = 20});
      order.push_back({residual(starts[k], &*target.skin, nullptr, 0.04 * L, {.stride = 10}), k});
    }
    std::sort(order.begin(), order.end());
    order.resize(kInEarnest);
  } else {
    for (size_t k = 0; k < starts.size(); ++k) order.push_back({0, k});
  }
  double least = std::numeric_limits<double>::max();
  for (const auto& [rough, k] : order) {
    fit(starts[k], &*target.skin, nullptr,
        {.iterations = 12, .wide = 0.06 * L, .narrow = 0.02 * L, .turns = main, .stride = 8});
    const double off = residual(starts[k], &*target.skin, nullptr, 0.04 * L, {.stride = 4});
    if (off < least) least = off, result.body = starts[k];
  }
  result.residual = std::sqrt(least);
}

// Fits the body's segments to bones that are rods (round bars along a rig) in the volume. Returns false and changes
// nothing unless after the fit nearly all bone is close to the segments and the segments of long bones are inside bone.
// Anatomical bones do not pass this test.
bool follow_rods(Mannequin& m, const FitTarget& target) {
  const double L = target.length;
  Mannequin rods = m;
  // After the first iterations at least this share of the bone tissue must be close to the segments. Anatomical bones
  // have less, because ribs, skull and hip bones are far from the lines of any rig.
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

// Fits the segments of a body whose shape comes from the rig alone to the volume's bone tissue. Returns false and
// changes nothing unless after the fit most of the bone is close to the segments, and at least as much as before the
// fit.
bool follow_bones(Mannequin& m, const FitTarget& target) {
  // kClose: bone up to this distance from a segment counts as close, as a share of the tissue's diagonal. kMost:
  // smallest share of the bone that must be close.
  constexpr double kClose = 0.025, kMost = 0.8;
  const double L = target.length;
  Mannequin drawn = m;
  fit_rods(drawn, target.bone_cells, *target.skin,
           {.iterations = 40, .wide = 0.03 * L, .narrow = 0.008 * L, .bone_share = 0.6, .stride = 3});
  const double before = rod_share(m, target.bone_cells, target.bone_body, kClose * L).near,
               after = rod_share(drawn, target.bone_cells, target.bone_body, kClose * L).near;
  if (after < kMost || after < before) return false;
  m = drawn;
  return true;
}

void refine_by_skin(Fitted& result, const FitTarget& target) {
  const double L = target.length;
  fit(*result.body, &*target.skin, nullptr,
      {.iterations = 20,
       .wide = 0.03 * L,
       .narrow = 0.01 * L,
       .turns = without_digits(result.atlas->rig),
       .stride = 3});
}

// Fits the hands first, then the whole body: roughly with some of the points, and at the end with all of them.
void finish(Mannequin& m, const FitTarget& target, const FitSurface* bone, bool is_rods) {
  const double L = target.length;
  try_hands(m, target, bone);
  // If voxels are larger than the thickness of finger bones, the skin is more exact than the bones and gets more
  // weight.
  const double bone_share = 0.8 * std::min(1.0, 4 / target.cell);
  if (is_rods) return;
  for (const auto& [iterations, stride, wide, narrow] :
       {std::tuple(14, 3, 0.012, 0.005), std::tuple(9, 1, 0.005, bone ? 0.003 : 0.004)})
    fit(m, &*target.skin, bone,
        {.iterations = iterations, .wide = wide * L, .narrow = narrow * L, .bone_share = bone_share, .stride = stride});
}

void refine(Fitted& result, const FitTarget& target, Progress& progress) {
  Mannequin& m = *result.body;
  const double L = target.length;
  const FitSurface* bone = target.bone && !result.is_capsules ? &*target.bone : nullptr;
  if (target.bone && result.is_capsules) {
    result.is_rods = follow_bones(m, target);
  } else if (bone && follow_rods(m, target)) {
    result.is_rods = true;
    bone = nullptr;
  } else if (bone) {
    fit(m, &*target.skin, bone,
        {.iterations = 24,
         .wide = 0.03 * L,
         .narrow = 0.006 * L,
         .turns = without_digits(result.atlas->rig),
         .bone_share = 0.7,
         .stride = 2});
  }
  progress.update("fitting", 0.6);
  const Mannequin before = m;
  finish(m, target, bone, result.is_rods);
  // If less than the share kLittle of the fingers' points is near the skin, a hand may be rotated the wrong way.
  // Another rotation is used if it multiplies this share by at least kBetter.
  constexpr double kLittle = 0.78, kBetter = 1.05;
  double most = hands_near(m, target);
  for (double twist : {0.0, 3.14, 1.57, -1.57}) {
    if (most > kLittle) break;
    Mannequin turned = with_turned_hands(before, twist, target);
    finish(turned, target, bone, result.is_rods);
    const double share = hands_near(turned, target);
    if (share > kBetter * most) most = share, m = turned;
  }
  result.residual = std::sqrt(residual(m, &*target.skin, nullptr, 0.04 * L, {}));
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

// Returns the kinds of atlas body that may match a rig; none for a rig whose bone names have no known meaning, or for a
// four-legged one.
std::vector<AtlasKind> kinds_for(const Armature& rig) {
  const Skeleton skeleton = skeleton_of(rig);
  std::set<BodyPart> parts;
  for (const auto& role : skeleton.role)
    if (role) parts.insert(role->part);
  const bool arm = parts.contains(BodyPart::UpperArm) || parts.contains(BodyPart::Forearm),
             leg = parts.contains(BodyPart::Thigh) || parts.contains(BodyPart::Shank);
  if (leg && (arm || parts.contains(BodyPart::Neck) || parts.contains(BodyPart::Head))) return {AtlasKind::Body};
  if (arm) return {AtlasKind::Arm, AtlasKind::ArmWithShoulder};
  if (leg) return {AtlasKind::Leg};
  if (parts.contains(BodyPart::Index) || parts.contains(BodyPart::Middle)) return {AtlasKind::Hand};
  return {};
}

// Returns the best fit among several kinds of body. A single limb is tried both as a right and as a left one.
Fitted best_start(const std::vector<AtlasKind>& kinds, const FitTarget& target, Progress& progress) {
  Fitted best;
  int done = 0;
  for (AtlasKind kind : kinds) {
    const BodyAtlas atlas = make_atlas(kind);
    for (bool mirror : {false, true}) {
      progress.update("starting", done++ / double(2 * kinds.size()));
      if (kind == AtlasKind::Body && mirror) continue;
      Fitted tried{.atlas = std::make_shared<BodyAtlas>(mirror ? mirrored(atlas) : atlas), .body = std::nullopt};
      take_best_start(tried, target,
                      kind == AtlasKind::Body ? body_starts(*tried.atlas, target.rough_body, target.cuts)
                                              : limb_starts(*tried.atlas, target.rough_body, kind, target.cuts));
      if (tried.body && tried.residual < best.residual) best = tried;
    }
  }
  return best;
}

// Returns the bones of the limb that ends with the bone `last`, starting at the trunk.
std::vector<int> limb_to(const Armature& rig, int last) {
  std::vector<int> children(rig.bones.size(), 0), limb{last};
  for (const Bone& bone : rig.bones)
    if (bone.parent >= 0) ++children[bone.parent];
  for (int b = rig.bones[last].parent; b >= 0 && children[b] == 1 && rig.bones[b].parent >= 0; b = rig.bones[b].parent)
    limb.push_back(b);
  std::reverse(limb.begin(), limb.end());
  return limb;
}

// Rotates and stretches limbs so that each one ends at an end of the tissue. Left and right limbs get the same stretch.
void reach_ends(Mannequin& m, const Occupancy& body) {
  // A limb's log stretch changes by at most kMost. A limb whose end is further from the end of the tissue than kNear,
  // as a share of the limb's length, is not changed.
  constexpr double kMost = 0.6, kNear = 0.7;
  const Armature& rig = m.atlas().rig;
  std::vector<std::uint8_t> is_last(rig.bones.size(), 1);
  for (const Bone& bone : rig.bones)
    if (bone.parent >= 0) is_last[bone.parent] = 0;
  // For each group of bones (left and right pair): the sum and the number of log stretches.
  std::map<int, std::pair<double, int>> stretch;
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

// Returns the fit of a body whose shape comes from the rig alone: its flesh is a round limb about each bone.
Fitted capsule_start(const Armature& rig, const FitTarget& target, Progress& progress) {
  progress.update("starting", 0);
  Fitted tried{.atlas = std::make_shared<BodyAtlas>(capsule_atlas(rig)), .body = std::nullopt, .is_capsules = true};
  take_best_start(tried, target, turned_starts(*tried.atlas, target.rough_body));
  if (!tried.body) return tried;
  refine_by_skin(tried, target);
  reach_ends(*tried.body, target.rough_body);
  return tried;
}

// Sets the rotation of each bone without visible tissue to the mirrored rotation of its counterpart on the other side
// or, if there is none, to the atlas's rest rotation relative to the parent.
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
    const auto other = name.starts_with("Left")    ? rig.find("Right" + name.substr(4))
                       : name.starts_with("Right") ? rig.find("Left" + name.substr(5))
                                                   : std::nullopt;
    if (other && seen[*other])
      m.turn[b] = m.turn[parent] * mirror * glm::transpose(m.turn[rig.bones[*other].parent]) * m.turn[*other] * mirror;
  }
  m.settle();
}

// Returns the labels that are bone according to the tissue table. If the table has no tissue kinds, returns the label
// found along the long bones of the fitted body, and adds a warning.
LabelSet bone_labels(const LabelVolume& volume, const TissueTable& tissues, const Fitted& fitted,
                     std::vector<std::string>& warnings) {
  LabelSet labels(65536, 0);
  const std::vector<TissueKind> kinds = tissues.kinds();
  for (size_t label = 1; label < kinds.size(); ++label) labels[label] = is_bone(kinds[label]);
  const Mannequin& m = *fitted.body;
  Armature long_bones;
  for (int b = 0; b < m.bone_count(); ++b) {
    const Bone& bone = m.atlas().rig.bones[b];
    if (fitted.is_capsules || ends_with_any(bone.name, {"UpperArm", "Forearm", "Thigh", "Shank"}))
      long_bones.bones.push_back(
          {.name = bone.name, .parent = -1, .head = m.joint(b), .tail = m.carried(b, bone.tail)});
  }
  if (const auto guess = guess_bone_tissue(volume, tissues, long_bones)) {
    const Tissue* tissue = tissues.find(guess->label);
    char text[160];
    std::snprintf(text, sizeof text,
                  "no tissue table says which labels are bone: label %.0f is used, because it lies along %.0f %% of "
                  "the long bones",
                  tissue ? tissue->file_value : double(guess->label), 100 * guess->share_of_rig);
    warnings.push_back(text);
    labels[guess->label] = 1;
  }
  return labels;
}

// Finds the joints between bones that are named by labels, moves the fitted body onto these joints, and returns them.
std::vector<NamedJoint> joints_by_name(Fitted& fitted, const FitTarget& target, const LabelVolume& volume,
                                       const TissueTable& tissues) {
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

AutoFit by_extents(const LabelVolume& volume, const Armature& rig, const std::string& reason) {
  AutoFit result;
  result.armature = scaled_to_tissue(volume, rig);
  const double error = error_by_extents(volume);
  result.joints.assign(rig.bones.size(), {JointFit::How::Extents, 0.1, error});
  result.warnings.push_back(
      reason + ": the rig was only scaled to the tissue's extents, and its joints may be off by up to about " +
      std::to_string(std::lround(error)) + " mm");
  return result;
}

void warn_of_joints(AutoFit& result) {
  constexpr double kDoubtful = 0.35, kOutside = 0.85, kFarOff = 18;
  std::string doubtful, outside, far_off;
  double farthest = 0;
  for (size_t b = 0; b < result.joints.size(); ++b) {
    const JointFit& joint = result.joints[b];
    const auto list = [&](std::string& names) { names += (names.empty() ? "" : ", ") + result.armature.bones[b].name; };
    const bool found = joint.how != JointFit::How::Carried && joint.how != JointFit::How::Extents &&
                       joint.how != JointFit::How::Unseen;
    if (found && joint.confidence < kDoubtful) list(doubtful);
    else if (found && joint.error > kFarOff) list(far_off), farthest = std::max(farthest, joint.error);
    if (result.check.share[b] < kOutside) list(outside);
  }
  if (!doubtful.empty())
    result.warnings.push_back("joints found with little confidence, check them by eye: " + doubtful);
  if (!far_off.empty())
    result.warnings.push_back(
        "near these joints the body's shape differs from the known body, so they may be off by up to about " +
        std::to_string(std::lround(farthest)) + " mm: " + far_off);
  if (!outside.empty()) result.warnings.push_back("bones that lie partly outside the tissue: " + outside);
}

}  // namespace

double error_by_extents(const LabelVolume& volume) {
  // Estimated error of a joint of a rig that was only scaled to the tissue, as a share of the tissue's diagonal. The
  // error is this large because the body may be upside down, so that every joint is at the other end.
  constexpr double kShare = 0.35;
  return kShare * glm::length(glm::dvec3(tissue_box(volume).size) * volume.grid.spacing);
}

Armature scaled_to_tissue(const LabelVolume& volume, const Armature& rig) {
  const VoxelBox box = tissue_box(volume);
  if (box.voxel_count() == 0)
    throw Error("a volume without tissue cannot be rigged", "every voxel is air", "give a label volume with tissue");
  const AffineTransform to_world = world_from_voxel(volume.grid);
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low), least(low), most(high);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = to_world * (glm::dvec3(box.lowest) - 0.5 +
                                     glm::dvec3(box.size) * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
    low = glm::min(low, p), high = glm::max(high, p);
  }
  for (const Bone& bone : rig.bones)
    for (const glm::dvec3& p : {bone.head, bone.tail}) least = glm::min(least, p), most = glm::max(most, p);
  const glm::dvec3 sides = high - low, own = most - least;
  const int longest = own.x >= own.y && own.x >= own.z ? 0 : own.y >= own.z ? 1 : 2;
  constexpr double kInside = 0.96;  // ratio of the rig's size to the tissue's, below 1 because bones end below the skin
  const double scale = own[longest] > 0 ? kInside * sides[longest] / own[longest] : 1;
  return moved_rig(rig, glm::dmat3(1), scale, (least + most) / 2.0, (low + high) / 2.0);
}

AutoFit auto_fit(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig, Progress& progress) {
  check_armature(rig, "the template");
  progress.update("surfaces", 0);
  FitTarget target = make_fit_target(volume);
  progress.update("surfaces", 1);
  AutoFit result;
  const std::vector<AtlasKind> kinds = kinds_for(rig);
  Fitted fitted;
  if (has_shape(target)) {
    if (!kinds.empty()) fitted = best_start(kinds, target, progress);
    else if (has_trunk(rig)) fitted = capsule_start(rig, target, progress);
  }
  if (!fitted.body) {
    result = by_extents(volume, rig,
                        kinds.empty() ? "the bones' names match no known body" : "the tissue has too little surface");
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
    result.misfit_mm = fitted.residual;
    for (size_t b = 0; b < rig.bones.size(); ++b) {
      const int match = placed.joint_of[b];
      JointFit joint;
      if (match >= 0) joint = found.how[match];
      // A bone without a found joint moves with its parent. Its joint is slightly less certain than the parent's.
      else if (rig.bones[b].parent >= 0)
        joint.confidence = 0.7 * result.joints[rig.bones[b].parent].confidence,
        joint.error = 1.4 * result.joints[rig.bones[b].parent].error;
      result.joints.push_back(joint);
    }
    // A joint outside the tissue is moved by at most this multiple of its estimated error to get it inside.
    constexpr double kGivesWay = 1.25;
    std::vector<double> free;
    for (const JointFit& joint : result.joints) free.push_back(kGivesWay * joint.error);
    result.armature = with_fitted_limits(drawn_inside(placed.armature, volume, target.cuts, free), rig);
    // A warning is added if the distance of the fitted body from the volume exceeds this share of the tissue's
    // diagonal.
    constexpr double kUnlike = 0.016;
    if (result.misfit_mm > kUnlike * target.length)
      result.warnings.push_back(
          "the shape of the tissue differs much from the body of this rig; check every joint by eye");
  }
  result.check = check_rig(volume, result.armature);
  warn_of_joints(result);
  return result;
}

std::string suggest_template(const LabelVolume& volume, Progress& progress) {
  const FitTarget target = make_fit_target(volume);
  if (!has_shape(target)) return "arm";
  // A whole body has five prominent tissue ends (head, hands and feet), or at least three if the arms touch the trunk.
  const size_t ends = limb_paths(target.rough_body, PathCentre::Thickest).size();
  if (ends >= 5) {
    const double whole = best_start({AtlasKind::Body}, target, progress).residual;
    if (whole < 0.02 * target.length) return "adult";
  }
  std::pair<double, std::string> best{std::numeric_limits<double>::max(), "arm"};
  for (const auto& [kind, name] : {std::pair(AtlasKind::Arm, "arm"), std::pair(AtlasKind::Leg, "leg"),
                                   std::pair(AtlasKind::Hand, "hand"), std::pair(AtlasKind::Body, "adult")}) {
    if (kind == AtlasKind::Body && ends < 3) continue;
    const Fitted tried = best_start({kind}, target, progress);
    if (tried.body && tried.residual < best.first) best = {tried.residual, name};
  }
  return best.second;
}

}  // namespace limber
