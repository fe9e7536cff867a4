// SPDX-License-Identifier: AGPL-3.0-or-later
// Changes the weights of one voxel and normalizes them: they stay whole numbers whose sum is exactly kFullWeight.
//
// The weight that a bone gains is taken from the other unlocked bones in proportion to their weights. The weight that a
// bone loses is given to them in the same proportion. The weight of a locked bone never changes. A voxel has at most
// four bones, so a fifth bone replaces the unlocked bone with the smallest weight. When a bone loses weight and no
// other unlocked bone has any, its fallback bone takes the weight: the nearest unlocked bone along the bone tree (its
// parent, else a child, else a bone further away), else the bone with the most weight nearby. If no bone can take the
// weight, nothing changes, and the result names the locked bone that prevents the change.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

using BoneSet = std::vector<std::uint8_t>;  // one byte for each bone, not 0 if the bone is in the set; empty: no bones

enum class Normalize {
  Unlocked,  // painted bones get the requested weight, and the other unlocked bones make room
  All,       // painted bones and other unlocked bones are scaled together so that their sum fits
  // For painting on a weight layer: the layer's other bones keep their weights, and the weights below the layer make
  // room (see shares_as_weights in weight_layers.h). For all other edits this equals Unlocked.
  WhenComposed,
};

struct WeightChange {
  bool changed = false;
  int blocked_by = -1;  // locked bone that prevented the change; -1: none
};

class WeightRules {
 public:
  // Makes the rules for a body.
  //   armature  its bones have the same order as those of the weights
  //   locked    the locked bones; may be empty
  //   nearby    the bone that gets the remaining weight if every bone connected to a voxel's bones in the bone tree is
  //             locked; callers give the bone with the most weight near the voxel; -1: none
  WeightRules(const Armature& armature, BoneSet locked, Normalize normalize = Normalize::Unlocked, int nearby = -1);

  bool is_locked(int bone) const { return locked_[bone] != 0; }
  // Returns the sum of this voxel's unlocked weights, [0, kFullWeight].
  int room(const Influence& influence) const;
  // Returns true if locks cannot affect setting `bone` in this voxel: neither `bone` nor any bone of the voxel is
  // locked.
  bool is_free(const Influence& influence, int bone) const {
    if (is_free_everywhere()) return true;
    bool free = normalize_ != Normalize::All && !locked_[bone];
    for (int i = 0; i < 4; ++i) free = free && (influence.weight[i] == 0 || !locked_[influence.bone[i]]);
    return free;
  }
  // Returns true if locks cannot affect setting any bone in any voxel.
  bool is_free_everywhere() const { return normalize_ != Normalize::All && !any_locked_; }
  // Returns the bone that takes over the weight that `bone` loses. This is never a bone of `group`. Returns -1 if every
  // other bone is locked.
  int fallback_bone(int bone, std::span<const int> group = {}) const;

  // Sets the weight of `bone` to `weight`, [0, kFullWeight], as far as locked bones leave room.
  WeightChange set(Influence& influence, int bone, int weight) const;
  // Sets the sum of the unlocked weights of several bones to `weight`. The bones keep their proportions. If they had no
  // weight, the first unlocked bone of the group gets all of it. The group must not be empty and must not contain a
  // bone twice.
  WeightChange set(Influence& influence, std::span<const int> group, int weight) const;
  // Returns the sum of the weights of `bones`, [0, kFullWeight].
  static int sum_of(const Influence& influence, std::span<const int> bones);

  // Moves all unlocked weights towards `target`, by the share `amount` [0, 1] of their difference from it. The target
  // may have any number of weights with any sum, none of them negative. Locked bones in the target are ignored, and a
  // target without unlocked bones changes nothing.
  WeightChange blend(Influence& influence, std::span<const std::pair<int, double>> target, double amount) const;

  // Divides the sum of two bones' weights anew: `bone` gets `weight`, and `other` gets what remains of the sum.
  WeightChange divide(Influence& influence, int bone, int other, int weight) const;

  // Removes the smallest unlocked weights until the voxel has at most `most` bones, [1, 4]. Locked bones stay, even if
  // there are more than `most` of them.
  WeightChange limit(Influence& influence, int most) const;
  // Removes unlocked weights below `least` (in 1/65535), unless this would remove all of them.
  WeightChange prune(Influence& influence, int least) const;
  // Rounds unlocked weights to multiples of kFullWeight / steps. The largest weight takes the remainder.
  WeightChange quantize_to(Influence& influence, int steps) const;
  // Changes the bone's weight w to out_low + (out_high - out_low) ((w - in_low) / (in_high - in_low))^(1 / gamma). All
  // weights in this formula are in [0, 1].
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
  // Two values for each bone: its parent (-1: a root), and the nearest other unlocked bone of the bone tree (-1: none).
  std::vector<int> parent_, heir_;
  std::vector<std::vector<int>> children_;
};

// Sorts an influence by descending weight, then by bone index. Sets the bone to 0 where the weight is 0.
void sort_influence(Influence& influence);

// Computes whole numbers in proportion to `share` whose sum is exactly `total`. No share may be negative, and at least
// one must be positive.
void distribute(std::span<const double> share, int total, std::span<int> out);

// Returns the message that a bone is locked, such as "Forearm is locked".
std::string lock_message(const Armature& armature, int bone);

}  // namespace limber
