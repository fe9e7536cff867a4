// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/found_joints.h"

#include <algorithm>
#include <cmath>

#include "core/autorig/hand_fit.h"
#include "core/autorig/joint_landmarks.h"

namespace limber {

namespace {

// Returns the confidence in the joint at the head of each bone, [0, 1]: the geometric mean of the shares of the bone's
// and of its parent's points that are near the volume's surface.
std::vector<double> shares_near(const Fitted& fitted, const FitTarget& target) {
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

// Limits by which strangeness() compares the shapes of two surfaces, mm. Up to the distance `same` the shapes count as
// equal; from `same` + `other` on, as entirely different. `of_cell` is the distance that is caused by voxels alone, as
// a share of a cell's size.
struct Likeness {
  double same, other, of_cell;
};

std::vector<double> strangeness(const Mannequin& m, const std::vector<AtlasPoint>& points, const FitSurface& surface,
                                const Likeness& like, const FitTarget& target) {
  const Armature& rig = m.atlas().rig;
  std::vector<std::vector<double>> off(m.bone_count());
  const double reach = 0.05 * target.length;
  for (const AtlasPoint& point : points) {
    const glm::dvec3 here = m.carried(point.bone, point.place);
    const int n = surface.tree.nearest(here, m.turn_at(point.bone, point.place) * point.normal, reach);
    if (beyond(target.cuts, here) > 0) continue;
    off[point.bone].push_back(n < 0 ? reach
                                    : std::abs(glm::dot(surface.points[n].normal, here - surface.points[n].place)));
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
    result.push_back(both.empty()
                         ? 1
                         : std::clamp((both[both.size() / 2] - like.same * scale - like.of_cell * target.cell) /
                                          (like.other * scale),
                                      0.0, 1.0));
  }
  return result;
}

// Returns for each bone how much the shape of the body differs from the atlas's, [0, 1]. The difference is measured on
// the skin and, if bone tissue is known, also on the bones; the smaller value is used, so that fat over the bones does
// not matter.
std::vector<double> strangeness(const Fitted& fitted, const FitTarget& target) {
  const Mannequin& m = *fitted.body;
  std::vector<double> result =
      strangeness(m, m.atlas().skin, *target.skin, {.same = 0.8, .other = 0.8, .of_cell = 0.08}, target);
  if (!target.bone || fitted.is_rods || fitted.is_capsules) return result;
  const std::vector<double> bones =
      strangeness(m, m.atlas().bone, *target.bone, {.same = 0.5, .other = 0.4, .of_cell = 0.15}, target);
  for (size_t b = 0; b < result.size(); ++b) result[b] = std::min(result[b], bones[b]);
  return result;
}

// Returns how much the shape of the whole body differs from the atlas's, [0, 1]: the mean over all bones except fingers
// and jaw. If voxels are too coarse to compare shapes, returns 1.
double whole_strangeness(const Fitted& fitted, const std::vector<double>& strange, const FitTarget& target) {
  // Cell sizes for the comparison of shapes, mm in a body of the atlas's size: up to kFine the comparison is exact,
  // from kCoarse on it is impossible.
  constexpr double kFine = 5, kCoarse = 9;
  double sum = 0;
  int bones = 0;
  for (size_t b = 0; b < strange.size(); ++b)
    if (!is_digit(fitted.atlas->rig.bones[b].name)) sum += strange[b], ++bones;
  const double size = std::exp(fitted.body->along[0]);
  return std::max(bones ? sum / bones : 1.0, std::clamp((target.cell / size - kFine) / (kCoarse - kFine), 0.0, 1.0));
}

// Sets the errors of joints for a body whose shape comes from the rig alone. The skin shows the direction and the ends
// of limbs, but not where along a limb the joints are. A limb that does not coincide with any skin may be anywhere
// around its root.
void doubt_capsules(FoundJoints& found, const std::vector<double>& near, const Mannequin& m, const FitTarget& target) {
  // Parts of a joint's error: kOfWhole of the tissue's diagonal, kOfBone of a bone's length, and up to kLost of a
  // bone's length in a limb that does not coincide with the skin. A limb coincides with it if the confidence is at
  // least kEnough.
  constexpr double kOfWhole = 0.02, kOfBone = 0.2, kLost = 0.75, kEnough = 0.8;
  const Armature& rig = m.atlas().rig;
  std::vector<double> lost(rig.bones.size(), 0);
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    const int parent = rig.bones[b].parent;
    const double length = parent < 0 ? glm::distance(m.joint(b), m.carried(b, rig.bones[b].tail))
                                     : glm::distance(m.joint(b), m.joint(parent));
    if (parent >= 0) lost[b] = lost[parent] + kLost * length * std::clamp((kEnough - near[b]) / kEnough, 0.0, 1.0);
    found.how[b].error = kOfWhole * target.length + kOfBone * length + lost[b];
  }
}

}  // namespace

std::vector<std::uint8_t> seen_bones(const Fitted& fitted, const FitTarget& target) {
  constexpr double kLeast = 0.3;  // a bone is seen if at least this share of its skin points is not cut off
  const Mannequin& m = *fitted.body;
  std::vector<double> all(m.bone_count(), 0), inside(all);
  for (const AtlasPoint& point : m.atlas().skin)
    ++all[point.bone], inside[point.bone] += beyond(target.cuts, m.carried(point.bone, point.place)) <= 0;
  // Number of the connected group of seen bones that each bone belongs to; -1: the bone is not seen. The number is the
  // index of the root, or of the unseen parent of the group's topmost bone.
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

FoundJoints found_joints(const Fitted& fitted, const FitTarget& target) {
  using How = JointFit::How;
  // On segmented adults, 9 of 10 joints had smaller errors than these, mm. kLeastError applies to a body of the atlas's
  // shape; in a body of another shape, one of the other values is added. kHipsBySkin is large because even rig authors
  // place hips 5 cm apart if only skin is known.
  constexpr double kLeastError = 4, kByBone = 14, kCollarByBone = 28, kFingerByBone = 14, kBySkin = 22,
                   kShoulderBySkin = 26, kCollarBySkin = 36, kHipsBySkin = 58, kByGirth = 12, kHandByGirth = 15,
                   kNeckByGirth = 22, kByBall = 9, kByAxis = 16;
  const Mannequin& m = *fitted.body;
  const Armature& rig = m.atlas().rig;
  const bool by_bone = target.bone && !fitted.is_rods && !fitted.is_capsules;
  const std::vector<double> near = shares_near(fitted, target);
  const std::vector<double> strange = strangeness(fitted, target);
  // The shape of the whole body is taken into account for every joint. A body of another build has its joints in other
  // positions, even if the surface at a single bone looks alike, as it always does at thin bones.
  const double whole = whole_strangeness(fitted, strange, target);
  FoundJoints found;
  for (int b = 0; b < m.bone_count(); ++b) {
    const std::string& name = rig.bones[b].name;
    const bool rod = fitted.is_rods &&
                     (fitted.is_capsules || ends_with_any(name, {"UpperArm", "Forearm", "Thigh", "Shank", "Foot"}));
    const double by_skin = ends_with_any(name, {"Thigh", "Hips", "Neck", "Spine"}) ? kHipsBySkin
                           : name.ends_with("UpperArm")                            ? kShoulderBySkin
                                                                                   : kBySkin;
    const bool collar = name.ends_with("Clavicle");
    const double other = by_bone  ? (collar           ? kCollarByBone
                                     : is_digit(name) ? kFingerByBone
                                                      : kByBone)
                         : collar ? kCollarBySkin
                                  : by_skin;
    found.places.push_back(m.joint(b));
    found.how.push_back({.how = rod       ? How::BoneAxis
                                : by_bone ? How::BoneSurface
                                          : How::Skin,
                         .confidence = rod ? 0.9 : near[b],
                         .error = rod ? kByAxis : kLeastError + std::max(strange[b], whole) * other});
  }
  const auto take = [&](const JointLandmark& mark, How how, double weight, double error) {
    const double off = glm::distance(found.places[mark.bone], mark.place);
    found.places[mark.bone] = glm::mix(found.places[mark.bone], mark.place, weight);
    JointFit& joint = found.how[mark.bone];
    joint.error = std::min(joint.error, glm::mix(joint.error, error, weight));
    // If the girth landmark (from the limb's cross-sections) and the fit to the skin disagree, the joint may be at
    // either position or between them. So the error increases with their distance.
    if (how == How::Girth && joint.how == How::Skin)
      joint.error = std::max({joint.error, (1 - weight) * off, 4 * weight * (1 - weight) * weight * off});
    if (weight > 0.5) joint.how = how;
  };
  // Returns the weight of a girth landmark, [0, 1]. It falls with the distance of the landmark from the fitted joint: 1
  // up to kSlides, 0 from kNever on, as shares of the length of the bone above. The fit to the skin is off along a limb
  // by up to a tenth of this length, rarely more, so a farther landmark does not belong to this joint. In a fit to rods
  // the distance is ignored, because that fit does not locate the hand.
  const auto believable = [&](const JointLandmark& mark) {
    constexpr double kSlides = 0.12, kNever = 0.24;
    const int above = rig.bones[mark.bone].parent;
    if (above < 0 || fitted.is_rods || rig.bones[mark.bone].name == "Neck") return 1.0;
    const double apart =
        glm::distance(m.joint(mark.bone), mark.place) / glm::distance(m.joint(above), m.joint(mark.bone));
    return std::clamp((kNever - apart) / (kNever - kSlides), 0.0, 1.0);
  };
  for (const JointLandmark& mark : girth_landmarks(m, target.body)) {
    const std::string& name = rig.bones[mark.bone].name;
    // Weight of a girth landmark (the narrowest cross-section of a limb). If the bones' surface is known, elbow and
    // wrist need no such landmark. At the knee, bones show the middle of the condyles and skin the gap below them; the
    // knee of a rig is halfway between.
    const double share = name == "Neck"   ? 1
                         : by_bone        ? (name.ends_with("Shank") ? 0.5 : 0)
                         : fitted.is_rods ? double(name.ends_with("Hand"))
                                          : 1;
    // In a bent limb the flesh folds, so the narrowest cross-section is further down. kBent: error that a bend of 90
    // degrees adds, mm. kHardlyBent: sine of the largest bend that adds no error.
    constexpr double kBent = 45, kHardlyBent = 0.09;
    const double bent = kBent * std::max(0.0, std::sin(mark.bend) - kHardlyBent);
    take(mark, How::Girth, share * strange[mark.bone] * believable(mark),
         (name == "Neck"           ? kNeckByGirth
          : name.ends_with("Hand") ? kHandByGirth
                                   : kByGirth) +
             bent);
  }
  // Error of a wrist whose hand touches other tissue, mm, in a body of another shape. The skin around such a wrist has
  // no narrowest cross-section, so the joint may be off along the limb.
  constexpr double kHandSlides = 38;
  for (int b = 0; b < m.bone_count(); ++b)
    if (found.how[b].how == How::Skin && rig.bones[b].name.ends_with("Hand"))
      found.how[b].error = std::max(found.how[b].error, kLeastError + strange[b] * kHandSlides);
  if (by_bone)
    for (const JointLandmark& mark : ball_landmarks(m, *target.bone))
      take(mark, How::Ball, strange[mark.bone], kByBall);
  // If little of the surface fits, no joint is certain, whatever evidence it was found by. Where a joint's confidence
  // is below kFew, kFewOfLimb or kFewOfHand, its error is at least the missing confidence times kFarOff or kLimbFarOff
  // mm. The limits differ because the limb bones of different bodies are much alike, while trunk bones are not. A ball
  // joint gets the lowest limit, because its shape alone identifies it.
  constexpr double kFew = 0.35, kFewOfLimb = 0.62, kFewOfHand = 0.7, kFarOff = 100, kLimbFarOff = 300;
  // If the fit's residual exceeds kUnlike (share of the tissue's diagonal), every joint gets at least an error of
  // kWrong times the excess, and far more if the excess is above kSteep. Measured residuals: at most 0.011 on whole
  // bodies of other shapes, 0.015 on parts of bodies with joints 11 mm off, 0.019 with joints 50 mm off, and more on
  // limbs that were fitted the wrong way round.
  constexpr double kUnlike = 0.013, kWrong = 6, kSteep = 0.004;
  const double unlike = std::max(0.0, (fitted.is_rods ? 0 : fitted.residual) / target.length - kUnlike);
  const double wrong = kWrong * unlike * target.length * (1 + unlike * unlike / (kSteep * kSteep));
  const auto doubt = [&](int b) {
    const std::string& name = rig.bones[b].name;
    const bool in_limb = by_bone && ends_with_any(name, {"UpperArm", "Forearm", "Hand", "Thigh", "Shank", "Foot"});
    const double few = !in_limb || found.how[b].how == How::Ball ? kFew
                       : name.ends_with("Hand")                  ? kFewOfHand
                                                                 : kFewOfLimb;
    return (in_limb ? kLimbFarOff : kFarOff) * std::max(0.0, few - near[b]);
  };
  // Fingers far from the skin may belong to a hand that was fitted with the wrong rotation. If less than kHandShare of
  // the fingers' points is near the skin, the missing share times kHandFarOff mm is added to the error of every finger
  // joint.
  constexpr double kHandShare = 0.85, kHandFarOff = 120;
  if (!fitted.is_capsules) {
    const double lost = kHandFarOff * std::max(0.0, kHandShare - hands_near(m, target));
    for (int b = 0; b < m.bone_count(); ++b)
      if (is_digit(rig.bones[b].name) && rig.bones[b].name != "Jaw") found.how[b].error += lost;
  }
  if (fitted.is_capsules) doubt_capsules(found, near, m, target);
  // An error of this size, mm, halves a joint's confidence. It is about the thickness of a joint.
  constexpr double kJoint = 40;
  for (int b = 0; b < m.bone_count(); ++b) {
    JointFit& joint = found.how[b];
    if (joint.how != How::BoneAxis) joint.error = std::max(joint.error, doubt(b));
    joint.error = std::max(joint.error, wrong);
    joint.confidence *= 1 / (1 + joint.error / kJoint);
  }
  return found;
}

void take_named(FoundJoints& found, const Armature& rig, const std::vector<NamedJoint>& named, double size) {
  // The joints below a named joint follow its shift, shortened by this share of the tissue's diagonal. They do not
  // follow a shift smaller than this share, which only means that the joint's position between the same two bones is
  // defined differently.
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

void doubt_cut_limbs(const Fitted& fitted, const FitTarget& target, FoundJoints& found,
                     std::vector<std::string>& warnings) {
  // A joint within kNear of a cut plane (share of the tissue's diagonal) becomes uncertain, unless its error is at most
  // kStrange mm, as in a body of the atlas's shape.
  constexpr double kNear = 0.05, kStrange = 5;
  // Error of a joint in a cut plane, mm, and increase of the error per mm beyond the plane.
  constexpr double kLeast = 36, kGrowth = 0.33;
  constexpr double kSureBall = 12;  // a ball joint with a smaller error stays certain near a cut, mm
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
      joint = {
          .how = JointFit::How::Unseen, .confidence = 0, .error = std::max(joint.error, kLeast + kGrowth * from_cut)};
      // Each unseen bone between a joint and the seen bones increases the joint's error, because the bone may have
      // another rotation.
      if (parent >= 0 && !seen[parent])
        joint.error = std::max(
            joint.error, found.how[parent].error + kGrowth * glm::distance(found.places[parent], found.places[b]));
      if (!is_digit(rig.bones[b].name)) list(unseen, b);
    } else if (out > -kNear * target.length && joint.error > kStrange &&
               !(joint.how == JointFit::How::Ball && joint.error < kSureBall)) {
      near_cut[b] = 1;
      joint.confidence *= 0.4;
      joint.error = std::max(joint.error, kLeast);
      if (!is_digit(rig.bones[b].name)) list(doubted, b);
    }
  }
  // A joint next to an uncertain joint is uncertain too: its error is at least a share of the neighbour's error, of
  // which at most kMaxErrorMm counts, and its confidence is multiplied by kLessConfidence.
  constexpr double kShareOfNeighboursError = 0.35, kMaxErrorMm = 100, kLessConfidence = 0.6;
  const std::vector<JointFit> own = found.how;
  const auto is_doubted = [&](int b) {
    return !is_digit(rig.bones[b].name) && (own[b].how == JointFit::How::Unseen || near_cut[b]);
  };
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (is_doubted(b) || own[b].how == JointFit::How::Unseen || own[b].how == JointFit::How::NamedBones ||
        own[b].error <= kStrange)
      continue;
    double beside = 0;
    for (int c = 0; c < std::ssize(rig.bones); ++c)
      if ((rig.bones[c].parent == b || rig.bones[b].parent == c) && is_doubted(c))
        beside = std::max(beside, own[c].error);
    if (beside == 0) continue;
    found.how[b].error = std::max(own[b].error, kShareOfNeighboursError * std::min(kMaxErrorMm, beside));
    found.how[b].confidence *= kLessConfidence;
  }
  // Error of a joint as a share of its distance from the limb's free end. It applies to a single limb that is cut off
  // at its upper end, because such a limb may be longer or shorter than it looks.
  constexpr double kLimbLengthUncertainty = 0.13;
  const auto upper = std::find_if(rig.bones.begin(), rig.bones.end(),
                                  [](const Bone& bone) { return bone.name == "UpperArm" || bone.name == "Thigh"; });
  if (upper != rig.bones.end() && is_doubted(static_cast<int>(upper - rig.bones.begin()))) {
    std::vector<double> from_end(rig.bones.size(), 0);
    for (int b = static_cast<int>(std::ssize(rig.bones)); b-- > 0;) {
      if (from_end[b] == 0) from_end[b] = glm::distance(rig.bones[b].head, rig.bones[b].tail);
      if (const int parent = rig.bones[b].parent; parent >= 0)
        from_end[parent] =
            std::max(from_end[parent], from_end[b] + glm::distance(found.places[parent], found.places[b]));
      if (own[b].error > kStrange)
        found.how[b].error = std::max(found.how[b].error, kLimbLengthUncertainty * from_end[b]);
    }
  }
  if (!unseen.empty())
    warnings.push_back("the tissue is cut off; these joints beyond the cut are positioned by body proportions only: " +
                       unseen);
  if (!doubted.empty())
    warnings.push_back("the tissue is cut off close to these joints, so their positions may be far off: " + doubted);
}

}  // namespace limber
