// SPDX-License-Identifier: AGPL-3.0-or-later
// How the weights of one voxel change, in whole numbers whose sum stays exactly kFullWeight.
//
// What a bone gains is taken from the unlocked others in proportion to their weights, and what it loses is given to
// them in the same way. A locked bone's weight never changes by one bit. A fifth bone takes the place of the smallest
// unlocked one. A bone that gives up the only unlocked weight leaves it to its heir: the nearest unlocked bone of the
// rig (its parent, else a child, else further along the tree), else the bone with the most weight nearby. Where nothing
// is unlocked nothing changes, and one learns which lock it was.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

using BoneSet = std::vector<std::uint8_t>;  // a byte per bone, not 0 for those that belong to the set; empty: none

enum class Normalize {
  Unlocked,      // the painted bones get what was asked for, the unlocked others make room
  All,           // the painted bones make room too: all unlocked weights are scaled alike until they fit
  WhenComposed,  // of a layer: its other bones stay as they are, what lies below it makes room (shares_as_weights in
                 // weight_layers.h, where the others are locked); elsewhere as Unlocked
};

struct WeightChange {
  bool changed = false;
  int blocked_by = -1;  // the locked bone in the way; -1 where none is
};

class WeightRules {
 public:
  // The armature's bones in the order of the weights'; locked may be empty.
  //   nearby  takes what no relative may: the bone with the most weight around; -1 for none
  WeightRules(const Armature& armature, BoneSet locked, Normalize normalize = Normalize::Unlocked, int nearby = -1);

  bool is_locked(int bone) const { return locked_[bone] != 0; }
  // What locks leave, [0, kFullWeight].
  int room(const Influence& influence) const;
  // Nothing is locked in it, and `bone` may be set there without regard to what others ask for.
  bool is_free(const Influence& influence, int bone) const {
    if (is_free_everywhere()) return true;
    bool free = normalize_ != Normalize::All && !locked_[bone];
    for (int i = 0; i < 4; ++i) free = free && (influence.weight[i] == 0 || !locked_[influence.bone[i]]);
    return free;
  }
  // In every voxel.
  bool is_free_everywhere() const { return normalize_ != Normalize::All && !any_locked_; }
  // -1 where every other bone is locked. Not one of `group`.
  int fallback_bone(int bone, std::span<const int> group = {}) const;

  // The weight of `bone` becomes `weight`, in 1/65535, [0, kFullWeight] (as far as locks leave room).
  WeightChange set(Influence& influence, int bone, int weight) const;
  // The same for several bones as one: their unlocked weights together become `weight`, shared as they were, or all to
  // the first unlocked of the group where they had none. At least one bone, none twice.
  WeightChange set(Influence& influence, std::span<const int> group, int weight) const;
  // What `bones` have together, [0, kFullWeight].
  static int sum_of(const Influence& influence, std::span<const int> bones);

  // All unlocked weights go to `target` (not negative, any sum, any length; locked bones in it do not count) by
  // `amount` [0, 1]. Where the target has nothing unlocked nothing changes.
  WeightChange blend(Influence& influence, std::span<const std::pair<int, double>> target, double amount) const;

  // What two bones have together is divided anew: `bone` gets `weight` of it, [0, what they have], `other` the rest.
  WeightChange divide(Influence& influence, int bone, int other, int weight) const;

  // At most `most` bones [1, 4]: the smallest unlocked go first. Locked bones stay even where they are more.
  WeightChange limit(Influence& influence, int most) const;
  // Unlocked weights below `least` (1/65535) go, except where all would.
  WeightChange prune(Influence& influence, int least) const;
  // Unlocked weights to whole steps of kFullWeight / steps, the rounding left over going to the largest.
  WeightChange quantize_to(Influence& influence, int steps) const;
  // The bone's weight w becomes out_low + (out_high - out_low) ((w - in_low) / (in_high - in_low))^(1 / gamma), all [0,
  // 1].
  struct Levels {
    double in_low = 0, in_high = 1, gamma = 1, out_low = 0, out_high = 1;
  };
  WeightChange levels(Influence& influence, int bone, const Levels& levels) const;

 private:
  bool blend_own(Influence& influence, std::span<const std::pair<int, double>> target, double amount) const;
  WeightChange set_freely(Influence& influence, int bone, int weight) const;
  int nearest_relative(int bone, std::span<const int> group, bool locked) const;

  BoneSet locked_;
  bool any_locked_ = false;
  Normalize normalize_;
  int nearby_;
  std::vector<int> parent_, heir_;  // #bones, -1 for none
  std::vector<std::vector<int>> children_;
};

// By falling weight, then by bone; bone 0 where there is no weight.
void sort_influence(Influence& influence);

// Whole numbers in proportion to `share` (not negative, not all zero) that sum to exactly `total`.
void distribute(std::span<const double> share, int total, std::span<int> out);

// "Forearm is locked"
std::string lock_message(const Armature& armature, int bone);

}  // namespace limber
