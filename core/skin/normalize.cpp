// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/normalize.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace limber {

namespace {

enum class Part { Locked, Group, Other };

struct Entry {
  int bone, weight;
  Part part;
};

// The weights of one voxel while they are redistributed. There is room for the voxel's up to four weights and for
// weights that an edit adds.
struct Entries {
  std::array<Entry, 9> entry;
  int count = 0;

  void add(int bone, int weight, Part part) { entry[count++] = {bone, weight, part}; }
  int sum(Part part) const {
    int all = 0;
    for (int i = 0; i < count; ++i)
      if (entry[i].part == part) all += entry[i].weight;
    return all;
  }
  Entry* largest(Part part) {
    Entry* best = nullptr;
    for (int i = 0; i < count; ++i)
      if (entry[i].part == part && (!best || entry[i].weight > best->weight)) best = &entry[i];
    return best;
  }
  void scale(Part part, int total) {
    std::array<double, 9> share;
    std::array<int, 9> out;
    int n = 0;
    for (int i = 0; i < count; ++i)
      if (entry[i].part == part) share[n++] = entry[i].weight;
    distribute(std::span(share.data(), n), total, std::span(out.data(), n));
    n = 0;
    for (int i = 0; i < count; ++i)
      if (entry[i].part == part) entry[i].weight = out[n++];
  }
  void drop_empty() {
    const auto end = std::remove_if(entry.begin(), entry.begin() + count, [](const Entry& e) { return e.weight == 0; });
    count = static_cast<int>(end - entry.begin());
  }
  int number(Part part) const {
    int all = 0;
    for (int i = 0; i < count; ++i) all += entry[i].part == part;
    return all;
  }
  // Returns the index of the smallest entry of one kind (locked, painted group or other); -1 if there is none. If
  // several are equally small, returns the last of them.
  int smallest(Part part) const {
    int best = -1;
    for (int i = 0; i < count; ++i)
      if (entry[i].part == part && (best < 0 || entry[i].weight <= entry[best].weight)) best = i;
    return best;
  }
  void remove(int i) {
    for (--count; i < count; ++i) entry[i] = entry[i + 1];
  }
  // Removes entry i and gives its weight away. The weight goes to the entries of the same kind (painted group or other)
  // if they have weight, else to the largest entry of the opposite kind.
  void give_up(int i) {
    const Entry gone = entry[i];
    remove(i);
    if (sum(gone.part) > 0) scale(gone.part, sum(gone.part) + gone.weight);
    else if (Entry* fallback_bone = largest(gone.part == Part::Other ? Part::Group : Part::Other))
      fallback_bone->weight += gone.weight;
  }
  Influence influence() const {
    Influence made;
    for (int i = 0; i < count; ++i) {
      made.bone[i] = static_cast<std::uint16_t>(entry[i].bone);
      made.weight[i] = static_cast<std::uint16_t>(entry[i].weight);
    }
    sort_influence(made);
    return made;
  }
};

Entries entries_of(const Influence& influence, const BoneSet& locked, std::span<const int> group) {
  Entries entries;
  for (int i = 0; i < 4; ++i) {
    if (influence.weight[i] == 0) continue;
    const int bone = influence.bone[i];
    const bool grouped = std::find(group.begin(), group.end(), bone) != group.end();
    entries.add(bone, influence.weight[i], locked[bone] ? Part::Locked : grouped ? Part::Group : Part::Other);
  }
  return entries;
}

// Replaces the influence and reports whether it has changed. A different order of the same weights is no change.
WeightChange changed_to(Influence& influence, const Influence& next) {
  Influence before = influence;
  sort_influence(before);
  if (next == before) return {};
  influence = next;
  return {true, -1};
}

// Makes an array of four numbers from one 64-bit value. If the numbers were written one by one, a following 64-bit read
// would stall.
std::array<std::uint16_t, 4> four(std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
  if constexpr (std::endian::native == std::endian::little)
    return std::bit_cast<std::array<std::uint16_t, 4>>(a | b << 16 | c << 32 | d << 48);
  else return std::bit_cast<std::array<std::uint16_t, 4>>(a << 48 | b << 32 | c << 16 | d);
}

// Returns an influence in which `bone` has the weight `weight`, and `other` has the remaining weight.
Influence pair_of(int bone, int weight, int other) {
  const int rest = kFullWeight - weight;
  const bool first = weight > rest || (weight == rest && bone < other);
  const int most = first ? weight : rest, least = first ? rest : weight;
  Influence made;
  made.bone = four(first ? bone : other, least == 0 ? 0 : first ? other : bone, 0, 0);
  made.weight = four(most, least, 0, 0);
  return made;
}

int largest_locked(Entries& entries) {
  const Entry* locked = entries.largest(Part::Locked);
  return locked ? locked->bone : -1;
}

}  // namespace

void sort_influence(Influence& influence) {
  const auto [a, b, c, d] = influence.weight;
  if (a > b && (b > c || (b == 0 && c == 0)) && (c > d || (c == 0 && d == 0))) {
    influence.bone =
        four(influence.bone[0], b ? influence.bone[1] : 0, c ? influence.bone[2] : 0, d ? influence.bone[3] : 0);
    return;
  }
  std::array<std::uint32_t, 4> key;
  for (int i = 0; i < 4; ++i) key[i] = std::uint32_t{influence.weight[i]} << 16 | (0xffffu - influence.bone[i]);
  const auto order = [&](int i, int k) {
    const std::uint32_t more = std::max(key[i], key[k]), less = std::min(key[i], key[k]);
    key[i] = more;
    key[k] = less;
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
  const auto bone = [&](int i) { return key[i] >> 16 ? 0xffffu - (key[i] & 0xffffu) : 0; };
  influence.weight = four(key[0] >> 16, key[1] >> 16, key[2] >> 16, key[3] >> 16);
  influence.bone = four(bone(0), bone(1), bone(2), bone(3));
}

// Each share is scaled and rounded, and the largest share takes the remainder. If rounding up makes the sum exceed the
// total, all shares are rounded down instead.
void distribute(std::span<const double> share, int total, std::span<int> out) {
  double sum = 0;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < share.size(); ++i) {
    sum += share[i];
    if (share[i] > share[largest]) largest = i;
  }
  if (!(sum > 0)) throw std::logic_error("distribute: the shares sum to zero");
  const double factor = total / sum;
  for (const double half : {0.5, 0.0}) {
    int left = total;
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (i == largest) continue;
      out[i] = static_cast<int>(share[i] * factor + half);
      left -= out[i];
    }
    out[largest] = left;
    if (left >= 0) return;
  }
}

std::string lock_message(const Armature& armature, int bone) { return armature.bones.at(bone).name + " is locked"; }

WeightRules::WeightRules(const Armature& armature, BoneSet locked, Normalize normalize, int nearby)
    : locked_(std::move(locked)),
      normalize_(normalize),
      nearby_(nearby),
      children_(armature.bones.size()) {
  const std::size_t count = armature.bones.size();
  if (locked_.empty()) locked_.assign(count, 0);
  if (locked_.size() != count) throw std::logic_error("WeightRules: the locks belong to another rig");
  any_locked_ = std::any_of(locked_.begin(), locked_.end(), [](auto l) { return l != 0; });
  for (std::size_t b = 0; b < count; ++b) {
    parent_.push_back(armature.bones[b].parent);
    if (parent_[b] >= 0) children_[parent_[b]].push_back(static_cast<int>(b));
  }
  for (std::size_t b = 0; b < count; ++b) heir_.push_back(nearest_relative(static_cast<int>(b), {}, false));
}

// Searches along the bone tree, the nearest bones first. Of two equally near bones, the one on the parent's side comes
// first.
int WeightRules::nearest_relative(int bone, std::span<const int> group, bool locked) const {
  std::vector<int> front{bone};
  std::vector<int> from{-1};
  for (std::size_t i = 0; i < front.size(); ++i) {
    const int b = front[i];
    const bool grouped = std::find(group.begin(), group.end(), b) != group.end();
    if (b != bone && !grouped && (locked_[b] != 0) == locked) return b;
    const auto go = [&](int next) {
      if (next < 0 || next == from[i]) return;
      front.push_back(next);
      from.push_back(b);
    };
    go(parent_[b]);
    for (const int child : children_[b]) go(child);
  }
  return -1;
}

int WeightRules::fallback_bone(int bone, std::span<const int> group) const {
  const bool other = group.empty() || (group.size() == 1 && group[0] == bone);
  const int found = other ? heir_[bone] : nearest_relative(bone, group, false);
  if (found >= 0) return found;
  const bool free = nearby_ >= 0 && nearby_ != bone && !locked_[nearby_] &&
                    std::find(group.begin(), group.end(), nearby_) == group.end();
  return free ? nearby_ : -1;
}

int WeightRules::room(const Influence& influence) const {
  int room = kFullWeight;
  for (int i = 0; i < 4; ++i)
    if (influence.weight[i] && locked_[influence.bone[i]]) room -= influence.weight[i];
  return room;
}

int WeightRules::sum_of(const Influence& influence, std::span<const int> bones) {
  int sum = 0;
  for (int i = 0; i < 4; ++i)
    if (influence.weight[i] && std::find(bones.begin(), bones.end(), int{influence.bone[i]}) != bones.end())
      sum += influence.weight[i];
  return sum;
}

WeightChange WeightRules::set(Influence& influence, int bone, int weight) const {
  if (is_free(influence, bone)) return set_freely(influence, bone, weight);
  return set(influence, std::span(&bone, 1), weight);
}

// A fast version of set() for the most frequent case: one painted bone, and no locked bones in this voxel. Its result
// is exactly that of set().
WeightChange WeightRules::set_freely(Influence& influence, int bone, int weight) const {
  if (influence.weight[2] == 0) {
    const bool first = influence.bone[0] == bone, second = influence.bone[1] == bone && influence.weight[1] != 0;
    if (first || second || influence.weight[1] == 0) {
      const int before = first    ? influence.weight[0]
                         : second ? influence.weight[1]
                                  : 0,
                now = std::clamp(weight, 0, kFullWeight);
      if (now == before) return {};
      int other = influence.bone[first ? 1 : 0];
      if (before == kFullWeight) {
        other = fallback_bone(bone);
        if (other < 0) return {false, nearest_relative(bone, {}, true)};
      }
      influence = pair_of(bone, now, other);
      return {true, -1};
    }
  }
  // The code below has almost no branches, since the processor could not predict them. simd_weights.h does the same
  // computation for several voxels at once.
  const Influence unsorted = influence;
  sort_influence(influence);
  int count = 0, found = 0;
  for (int i = 0; i < 4; ++i) {
    count += influence.weight[i] != 0;
    found |= (influence.bone[i] == bone) << i;
  }
  found &= (1 << count) - 1;
  int slot = found ? std::countr_zero(static_cast<unsigned>(found)) : count;
  const int before = found ? influence.weight[slot] : 0;
  const int now = std::clamp(weight, 0, kFullWeight), others = kFullWeight - now;
  if (now == before) {
    influence = unsorted;
    return {};
  }
  if (others == 0) {
    influence = rigid_influence(bone);
    return {true, -1};
  }
  slot = std::min(slot, 3);  // if the voxel has four other bones, the new bone replaces the smallest
  std::array<int, 4> shared, weights;
  int sum = 0, most = -1;
  for (int i = 0; i < 4; ++i) {
    weights[i] = i == slot ? 0 : influence.weight[i];
    sum += weights[i];
    most = std::max(most, weights[i] << 2 | (3 - i));
  }
  const int largest = 3 - (most & 3);
  weights[largest] = 0;
  const double factor = others / double(sum);
  for (const double half : {0.5, 0.0}) {
    int left = others;
    for (int i = 0; i < 4; ++i) {
      shared[i] = static_cast<int>(weights[i] * factor + half);
      left -= shared[i];
    }
    shared[largest] = left;
    if (left >= 0) break;
  }
  shared[slot] = now;
  influence.bone[slot] = static_cast<std::uint16_t>(bone);
  influence.weight = four(shared[0], shared[1], shared[2], shared[3]);
  sort_influence(influence);
  return {true, -1};
}

WeightChange WeightRules::set(Influence& influence, std::span<const int> group, int weight) const {
  const auto painted = std::find_if(group.begin(), group.end(), [&](int b) { return !locked_[b]; });
  if (painted == group.end()) return {false, group.front()};
  Entries entries = entries_of(influence, locked_, group);
  const int room = kFullWeight - entries.sum(Part::Locked), before = entries.sum(Part::Group),
            others = entries.sum(Part::Other);
  int now = std::clamp(weight, 0, room);
  if (normalize_ == Normalize::All && now > 0 && others > 0) {
    // If the other bones kept their weights, the sum would be `now` + `others`. Both are scaled so that the sum becomes
    // `room`, the weight that unlocked bones share.
    now = static_cast<int>(std::lround(double(now) / (now + others) * room));
  }
  if (now == before) return {false, weight > room ? largest_locked(entries) : -1};

  if (others == 0) {
    const int to = fallback_bone(*painted, group);
    if (to < 0) return {false, nearest_relative(*painted, group, true)};
    entries.add(to, room - now, Part::Other);
  } else {
    if (before == 0 && entries.count == 4) {
      // The voxel has four bones already, so the painted bone replaces the unlocked bone with the smallest weight. If
      // that was the only unlocked bone, the painted bone gets all the unlocked weight.
      entries.remove(entries.smallest(Part::Other));
      if (entries.number(Part::Other) == 0) now = room;
    }
    if (entries.number(Part::Other) > 0) entries.scale(Part::Other, room - now);
  }
  if (before == 0) entries.add(*painted, now, Part::Group);
  else entries.scale(Part::Group, now);
  entries.drop_empty();
  if (entries.count > 4) {
    // After the fallback bone was added, the voxel has five bones, so the smallest unlocked entry is removed.
    const int painted_least = entries.smallest(Part::Group), fallback_bone = entries.smallest(Part::Other);
    entries.give_up(entries.entry[fallback_bone].weight < entries.entry[painted_least].weight ? fallback_bone
                                                                                              : painted_least);
  }
  return changed_to(influence, entries.influence());
}

// A fast version of blend() for a voxel without locked bones and a target with exactly the voxel's bones in the voxel's
// order. Returns false in all other cases, which blend() must handle.
bool WeightRules::blend_own(Influence& influence, std::span<const std::pair<int, double>> target, double amount) const {
  if (any_locked_ || target.size() > 4 || !(amount > 0)) return false;
  const std::size_t count = target.size();
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (influence.weight[i] == 0 || influence.bone[i] != target[i].first || !(target[i].second > 0)) return false;
    sum += target[i].second;
  }
  if (count == 0 || (count < 4 && influence.weight[count] != 0)) return false;
  std::array<std::pair<int, double>, 4> mixed{};
  for (std::size_t i = 0; i < count; ++i)
    mixed[i] = {influence.bone[i], (1 - amount) * influence.weight[i] + amount * target[i].second / sum * kFullWeight};
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t k = i; k > 0 && (mixed[k].second > mixed[k - 1].second ||
                                      (mixed[k].second == mixed[k - 1].second && mixed[k].first < mixed[k - 1].first));
         --k)
      std::swap(mixed[k], mixed[k - 1]);
  std::array<double, 4> share{};
  std::array<int, 4> out{};
  for (std::size_t i = 0; i < count; ++i) share[i] = mixed[i].second;
  distribute(std::span(share.data(), count), kFullWeight, std::span(out.data(), count));
  influence.bone = four(mixed[0].first, mixed[1].first, mixed[2].first, mixed[3].first);
  influence.weight = four(out[0], out[1], out[2], out[3]);
  sort_influence(influence);
  return true;
}

WeightChange WeightRules::blend(Influence& influence, std::span<const std::pair<int, double>> target,
                                double amount) const {
  if (Influence made = influence; blend_own(made, target, amount)) return changed_to(influence, made);
  Entries entries = entries_of(influence, locked_, {});
  const int room = entries.sum(Part::Other), slots = 4 - entries.number(Part::Locked);
  if (room == 0) return {false, largest_locked(entries)};
  double sum = 0;
  for (const auto& [bone, share] : target)
    if (!locked_[bone]) sum += share;
  if (!(sum > 0) || !(amount > 0)) return {};

  // An array on the stack suffices for most voxels. Only a few targets have so many bones that a vector is needed.
  std::array<std::pair<int, double>, 32> few;
  std::vector<std::pair<int, double>> many;
  std::pair<int, double>* mixed = few.data();
  if (target.size() + 4 > few.size()) {
    many.resize(target.size() + 4);
    mixed = many.data();
  }
  int count = 0;
  for (int i = 0; i < entries.count; ++i)
    if (entries.entry[i].part == Part::Other)
      mixed[count++] = {entries.entry[i].bone, (1 - amount) * entries.entry[i].weight};
  for (const auto& [bone, share] : target) {
    if (locked_[bone] || !(share > 0)) continue;
    const double value = amount * share / sum * room;
    const auto found = std::find_if(mixed, mixed + count, [b = bone](const auto& m) { return m.first == b; });
    if (found != mixed + count) found->second += value;
    else mixed[count++] = {bone, value};
  }
  const int most = std::min(slots, count);
  std::partial_sort(mixed, mixed + most, mixed + count, [](const auto& a, const auto& b) {
    return a.second > b.second || (a.second == b.second && a.first < b.first);
  });
  std::array<double, 4> share{};
  std::array<int, 4> out{};
  for (int i = 0; i < most; ++i) share[i] = mixed[i].second;
  distribute(std::span(share.data(), most), room, std::span(out.data(), most));
  Entries next;
  for (int i = 0; i < entries.count; ++i)
    if (entries.entry[i].part == Part::Locked) next.entry[next.count++] = entries.entry[i];
  for (int i = 0; i < most; ++i)
    if (out[i] > 0) next.add(mixed[i].first, out[i], Part::Other);
  return changed_to(influence, next.influence());
}

WeightChange WeightRules::divide(Influence& influence, int bone, int other, int weight) const {
  const std::array<int, 2> both{bone, other};
  const int total = sum_of(influence, both), now = std::clamp(weight, 0, total);
  if (total == 0 || sum_of(influence, std::span(&bone, 1)) == now) return {};
  for (const int b : both)
    if (locked_[b]) return {false, b};
  Entries entries;
  for (const Entries before = entries_of(influence, locked_, both);
       const Entry& e : std::span(before.entry.data(), before.count))
    if (e.part != Part::Group) entries.add(e.bone, e.weight, e.part);
  entries.add(bone, now, Part::Group);
  entries.add(other, total - now, Part::Group);
  entries.drop_empty();
  if (entries.count > 4) entries.give_up(entries.smallest(entries.number(Part::Other) > 0 ? Part::Other : Part::Group));
  return changed_to(influence, entries.influence());
}

WeightChange WeightRules::limit(Influence& influence, int most) const {
  Entries entries = entries_of(influence, locked_, {});
  int unlocked = entries.number(Part::Other);
  int blocked = -1;
  while (entries.count > most) {
    if (unlocked < 2) {
      blocked = largest_locked(entries);
      break;
    }
    entries.give_up(entries.smallest(Part::Other));
    --unlocked;
  }
  WeightChange change = changed_to(influence, entries.influence());
  change.blocked_by = blocked;
  return change;
}

WeightChange WeightRules::prune(Influence& influence, int least) const {
  Entries entries = entries_of(influence, locked_, {});
  const int room = entries.sum(Part::Other);
  const Entry* largest = entries.largest(Part::Other);
  if (!largest || largest->weight < least) return {};
  for (int i = 0; i < entries.count; ++i)
    if (entries.entry[i].part == Part::Other && entries.entry[i].weight < least) entries.entry[i].weight = 0;
  entries.drop_empty();
  entries.scale(Part::Other, room);
  return changed_to(influence, entries.influence());
}

WeightChange WeightRules::quantize_to(Influence& influence, int steps) const {
  Entries entries = entries_of(influence, locked_, {});
  Entry* largest = entries.largest(Part::Other);
  if (!largest) return {false, largest_locked(entries)};
  int left = entries.sum(Part::Other);
  for (int i = 0; i < entries.count; ++i) {
    Entry& e = entries.entry[i];
    if (e.part != Part::Other || &e == largest) continue;
    const auto whole = std::lround(double(e.weight) * steps / kFullWeight);
    e.weight = std::min(left, static_cast<int>(std::lround(double(whole) * kFullWeight / steps)));
    left -= e.weight;
  }
  largest->weight = left;
  entries.drop_empty();
  return changed_to(influence, entries.influence());
}

WeightChange WeightRules::levels(Influence& influence, int bone, const Levels& l) const {
  const double from = influence.of(bone), span = l.in_high - l.in_low;
  const double at = span > 0 ? std::clamp((from - l.in_low) / span, 0.0, 1.0) : from < l.in_low ? 0.0 : 1.0;
  const double to = l.out_low + (l.out_high - l.out_low) * std::pow(at, 1 / l.gamma);
  return set(influence, bone, static_cast<int>(std::lround(std::clamp(to, 0.0, 1.0) * kFullWeight)));
}

}  // namespace limber
