// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/hand_fit.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

namespace limber {

namespace {

// The bones of one hand in the rig, and the settings for fitting the hand.
struct HandFit {
  // Bone indices of the hand and of the first phalanges of the middle, the index and the little finger.
  int hand = 0, knuckle = 0, index = 0, little = 0;
  FitStage stage;
  double palm = 0;  // distance from the wrist to the middle knuckle, mm
};

std::optional<HandFit> hand_fit(const Mannequin& m, int hand) {
  const Armature& rig = m.atlas().rig;
  const std::string side = rig.bones[hand].name.substr(0, rig.bones[hand].name.size() - 4);
  const auto knuckle = rig.find(side + "MiddleProximal"), index = rig.find(side + "IndexProximal"),
             little = rig.find(side + "LittleProximal");
  if (!knuckle || !index || !little) return std::nullopt;
  HandFit fit{.hand = hand, .knuckle = *knuckle, .index = *index, .little = *little};
  fit.palm = glm::distance(m.joint(hand), m.joint(*knuckle));
  fit.stage = {.iterations = 14,
               .wide = 0.2 * fit.palm,
               .narrow = 0.04 * fit.palm,
               .turns = branch_of(rig, hand),
               .stretches = false,
               .bone_share = 0.6,
               .stride = 3};
  fit.stage.points = fit.stage.turns;
  fit.stage.around = m.joint(*knuckle), fit.stage.reach = 1.6 * fit.palm;
  return fit;
}

// Gives the joints of `hand` the mirrored rotations of the joints of `other`, the other hand.
void bend_alike(Mannequin& m, int hand, int other) {
  const Armature& rig = m.atlas().rig;
  const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  const std::vector<std::uint8_t> below = branch_of(rig, hand);
  // The rig lists the bones of both hands in the same order.
  for (int b = hand; b < m.bone_count(); ++b)
    if (below[b]) {
      const int there = other + b - hand;
      m.turn[b] = m.turn[rig.bones[b].parent] * mirror *
                  (glm::transpose(m.turn[rig.bones[there].parent]) * m.turn[there]) * mirror;
    }
  m.settle();
}

// Returns the body with open hands that have the scale of its arms and legs. A fit to the wrong fingers bends and
// shrinks a hand, so a new fit starts from open hands.
Mannequin with_fresh_hands(const Mannequin& m) {
  Mannequin fresh = m;
  const Armature& rig = m.atlas().rig;
  double size = 0;
  int limbs = 0;
  for (int b = 0; b < m.bone_count(); ++b)
    if (ends_with_any(rig.bones[b].name, {"UpperArm", "Forearm", "Thigh", "Shank"}))
      size += m.along[m.group_of(b)], ++limbs;
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

}  // namespace

void try_hands(Mannequin& m, const FitTarget& target, const FitSurface* bone) {
  const Armature& rig = m.atlas().rig;
  std::vector<std::pair<int, double>> hands;  // bone index of each hand, and the hand's residual, mm^2
  const auto keep_better = [&](Mannequin& best, double& least, Mannequin tried, const HandFit& hand, double share) {
    fit(tried, &*target.skin, bone, hand.stage);
    const double off = residual(tried, &*target.skin, bone, 0.25 * hand.palm, hand.stage);
    if (off < least * share) least = off, best = std::move(tried);
  };
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    if (!rig.bones[b].name.ends_with("Hand")) continue;
    const auto hand = hand_fit(m, b);
    if (!hand) continue;
    const glm::dvec3 along = glm::normalize(m.joint(hand->knuckle) - m.joint(b)),
                     normal = glm::normalize(glm::cross(along, m.joint(hand->index) - m.joint(hand->little)));
    Mannequin best = m;
    double least = 1e300;
    for (double twist : {0.0, -0.7, 0.7, -1.6, 1.6, 3.14})
      for (double aside : {0.0, -0.25, 0.25}) {
        if (std::abs(twist) > 1 && aside != 0) continue;
        Mannequin tried = m;
        tried.turn_branch(b, glm::mat3_cast(glm::angleAxis(twist, along) * glm::angleAxis(aside, normal)));
        // A rotated hand is used only if its residual is at least 3 % lower than that of the best hand so far.
        keep_better(best, least, tried, *hand, twist == 0 && aside == 0 ? 1 : 0.97);
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

Mannequin with_turned_hands(const Mannequin& m, double twist, const FitTarget& target) {
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
    turned.turn_branch(b, glm::mat3_cast(glm::angleAxis(
                              left ? -twist : twist, glm::normalize(turned.joint(hand->knuckle) - turned.joint(b)))));
    fit(turned, &*target.skin, nullptr, stage);
  }
  // Only the arms may change in this fit, so the position and the sizes of the rest of the body are restored.
  turned.root = m.root;
  std::vector<std::uint8_t> of_arm(m.group_count(), 0);
  for (int b = 0; b < m.bone_count(); ++b)
    of_arm[m.group_of(b)] |= ends_with_any(rig.bones[b].name, {"Forearm", "Hand"}) ||
                             (is_digit(rig.bones[b].name) && rig.bones[b].name != "Jaw");
  for (int g = 0; g < m.group_count(); ++g)
    if (!of_arm[g]) turned.along[g] = m.along[g], turned.across[g] = m.across[g];
  turned.settle();
  return turned;
}

double hands_near(const Mannequin& m, const FitTarget& target) {
  const std::vector<double> share = share_near(m, *target.skin, false, 2.5 + target.cell);
  double sum = 0;
  int digits = 0;
  for (int b = 0; b < m.bone_count(); ++b)
    if (is_digit(m.atlas().rig.bones[b].name) && m.atlas().rig.bones[b].name != "Jaw" && share[b] >= 0)
      sum += share[b], ++digits;
  return digits ? sum / digits : 1;
}

}  // namespace limber
