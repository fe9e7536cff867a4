// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/named_bones.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {
// If at least this share of the voxels of a connected component of bone is on one side of the body, the whole component
// belongs to this side. Its other voxels are nearer to a rig bone of the other side only because that rig bone reaches
// across the middle.
constexpr double kClearMajority = 0.85;
// Share of a bone's voxels that decide which rig bone the bone follows: those nearest to any of the rig bones.
constexpr double kAttached = 0.1;
constexpr std::int64_t kGrain = 65536;  // voxels of the graph per block of a parallel loop

class Assigning {
 public:
  Assigning(const BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
            const Armature& armature, const std::map<Label, LabelBones>& labels)
      : graph_(graph),
        volume_(volume),
        kinds_(kinds),
        armature_(armature),
        labels_(labels),
        world_from_voxel_(world_from_voxel(volume.grid)) {
    named_.bone.resize(graph.size());
    named_.group.resize(graph.size());
    named_.found_by.resize(graph.size());
    named_.candidates.resize(1);
  }

  NamedBones run() && {
    gather_sets();
    for (const Set& set : sets_) assign(set);
    spread_into_marrow();
    return std::move(named_);
  }

 private:
  // A set of voxels that may follow the same rig bones. A bone that must stay whole gets a set of its own if it may
  // follow several rig bones.
  struct Set {
    const LabelBones* bones;
    std::vector<std::int32_t> voxels;
  };

  void gather_sets() {
    using Key = std::tuple<std::vector<int>, std::vector<int>, bool, Label, bool>;
    std::map<Key, std::size_t> at;
    std::vector<int> set_of(65536, -1);
    for (const auto& [label, bones] : labels_) {
      const bool has_choice = std::max(bones.candidates[0].size(), bones.candidates[1].size()) > 1;
      const auto [found, is_new] =
          at.insert({{bones.candidates[0], bones.candidates[1], bones.has_sides,
                      bones.single && has_choice ? label : Label{0}, bones.found_by == FoundBy::Map},
                     sets_.size()});
      if (is_new) sets_.push_back({&bones, {}});
      set_of[label] = static_cast<int>(found->second);
    }
    std::vector<FoundBy> found_by(set_of.size(), FoundBy::Shape);
    for (const auto& [label, bones] : labels_) found_by[label] = bones.found_by;
    set_of_.resize(graph_.size());
    // counts[block][set]: number of the voxels in the block that belong to the set.
    std::vector<std::vector<std::int64_t>> counts((graph_.size() + kGrain - 1) / kGrain);
    parallel_for(graph_.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      std::vector<std::int64_t>& count = counts[begin / kGrain];
      count.resize(sets_.size());
      for (std::int64_t i = begin; i < end; ++i) {
        const Label label = volume_.at(graph_.voxel[i]);
        named_.bone[i] = -1;
        named_.group[i] = NamedBones::kUnnamed;
        named_.found_by[i] = found_by[label];
        set_of_[i] = set_of[label];
        if (set_of_[i] >= 0) ++count[set_of_[i]];
      }
    });
    list_voxels(counts);
  }

  // Lists the voxels of every set by their index in the graph.
  //   counts  in: for each block of voxels, the number of voxels in each set; out: the index in the set at which the
  //           block begins
  void list_voxels(std::vector<std::vector<std::int64_t>>& counts) {
    for (std::size_t k = 0; k < sets_.size(); ++k) {
      std::int64_t total = 0;
      for (std::vector<std::int64_t>& count : counts) total += std::exchange(count[k], total);
      sets_[k].voxels.resize(total);
    }
    parallel_for(graph_.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      std::vector<std::int64_t>& next = counts[begin / kGrain];
      for (std::int64_t i = begin; i < end; ++i)
        if (const int set = set_of_[i]; set >= 0) sets_[set].voxels[next[set]++] = static_cast<std::int32_t>(i);
    });
  }

  void assign(const Set& set) {
    const LabelBones& bones = *set.bones;
    if (!bones.has_sides) return follow(set.voxels, bones.candidates[0], bones.single);
    std::array<std::vector<std::int32_t>, 2> sides;
    for (const std::vector<std::int32_t>& piece : pieces_of(set)) {
      std::array<std::vector<std::int32_t>, 2> nearer;
      for (const std::int32_t i : piece)
        nearer[nearest(bones.side_bones[1], i).distance < nearest(bones.side_bones[0], i).distance].push_back(i);
      for (int side = 0; side < 2; ++side) {
        const bool has_all = double(nearer[side].size()) >= kClearMajority * double(piece.size());
        const bool has_none = double(nearer[1 - side].size()) >= kClearMajority * double(piece.size());
        const auto& own = has_all ? piece : nearer[side];
        if (!has_none) sides[side].insert(sides[side].end(), own.begin(), own.end());
      }
    }
    for (int side = 0; side < 2; ++side) follow(sides[side], bones.candidates[side], bones.single);
  }

  // Returns the connected components of a set of bone voxels.
  std::vector<std::vector<std::int32_t>> pieces_of(const Set& set) {
    std::vector<std::vector<std::int32_t>> pieces;
    std::vector<bool>& seen = seen_;
    seen.resize(graph_.size(), false);
    for (const std::int32_t start : set.voxels) {
      if (seen[start]) continue;
      std::vector<std::int32_t>& piece = pieces.emplace_back(1, start);
      seen[start] = true;
      for (std::size_t k = 0; k < piece.size(); ++k)
        for (const std::int32_t n : graph_.neighbour[piece[k]])
          if (n >= 0 && !seen[n] && set_of_[n] == set_of_[start]) seen[n] = true, piece.push_back(n);
    }
    return pieces;
  }

  void follow(const std::vector<std::int32_t>& voxels, const std::vector<int>& candidates, bool whole) {
    if (voxels.empty()) return;
    if (candidates.size() == 1 || whole) {
      const int bone = candidates.size() == 1 ? candidates[0] : bone_where_attached(voxels, candidates);
      for (const std::int32_t i : voxels) named_.bone[i] = bone;
    }
    const auto group = static_cast<std::int32_t>(named_.candidates.size());
    named_.candidates.push_back(candidates);
    for (const std::int32_t i : voxels) named_.group[i] = group;
  }

  struct Nearest {
    double distance;
    int bone;
  };
  Nearest nearest(const std::vector<int>& bones, std::int32_t i) const {
    const glm::dvec3 at = world_from_voxel_ * glm::dvec3(graph_.voxel[i]);
    Nearest best{std::numeric_limits<double>::max(), bones.front()};
    for (const int b : bones)
      if (const double d = distance_to_bone(armature_.bones[b], at); d < best.distance) best = {d, b};
    return best;
  }

  int bone_where_attached(const std::vector<std::int32_t>& voxels, const std::vector<int>& candidates) const {
    std::vector<Nearest> all;
    for (const std::int32_t i : voxels) all.push_back(nearest(candidates, i));
    const std::size_t attached = std::max<std::size_t>(1, static_cast<std::size_t>(kAttached * double(all.size())));
    std::nth_element(all.begin(), all.begin() + (attached - 1), all.end(), [](const Nearest& a, const Nearest& b) {
      return std::pair(a.distance, a.bone) < std::pair(b.distance, b.bone);
    });
    std::map<int, std::size_t> votes;
    for (std::size_t k = 0; k < attached; ++k) ++votes[all[k].bone];
    return std::max_element(votes.begin(), votes.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }

  // Assigns marrow and spongy bone without a name to the rig bones of named labels that they touch, by breadth-first
  // search.
  void spread_into_marrow() {
    // The search starts at the voxels that touch marrow without a name; all others have no voxel to spread to.
    std::vector<std::vector<std::int32_t>> starts((graph_.size() + kGrain - 1) / kGrain);
    parallel_for(graph_.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        if (named_.group[i] == NamedBones::kUnnamed) continue;
        const auto& around = graph_.neighbour[i];
        if (std::any_of(around.begin(), around.end(), [&](std::int32_t n) { return is_unnamed_marrow(n); }))
          starts[begin / kGrain].push_back(static_cast<std::int32_t>(i));
      }
    });
    std::vector<std::int32_t> front;
    for (const std::vector<std::int32_t>& some : starts) front.insert(front.end(), some.begin(), some.end());
    for (std::size_t k = 0; k < front.size(); ++k) {
      const std::int32_t from = front[k];
      for (const std::int32_t n : graph_.neighbour[from]) {
        if (!is_unnamed_marrow(n)) continue;
        named_.group[n] = named_.group[from];
        named_.bone[n] = named_.bone[from];
        named_.found_by[n] = FoundBy::Kind;
        front.push_back(n);
      }
    }
  }

  // Returns true for a voxel of marrow or spongy bone that follows no rig bone yet. `n` may also be kNotBone or
  // kOutside.
  bool is_unnamed_marrow(std::int32_t n) const {
    if (n < 0 || named_.group[n] != NamedBones::kUnnamed) return false;
    const TissueKind kind = kinds_[volume_.at(graph_.voxel[n])];
    return kind == TissueKind::Marrow || kind == TissueKind::CancellousBone;
  }

  const BoneGraph& graph_;
  const LabelVolume& volume_;
  const std::vector<TissueKind>& kinds_;
  const Armature& armature_;
  const std::map<Label, LabelBones>& labels_;
  AffineTransform world_from_voxel_;
  std::vector<Set> sets_;
  // Index in sets_ for each voxel of the graph; -1: the rig bones of the voxel's label are unknown.
  ZeroedVector<int> set_of_;
  std::vector<bool> seen_;
  NamedBones named_;
};
}  // namespace

NamedBones assign_named_bones(const BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
                              const Armature& armature, const std::map<Label, LabelBones>& labels) {
  return Assigning(graph, volume, kinds, armature, labels).run();
}

Unsettled unsettled_part(const BoneGraph& whole, const NamedBones& named) {
  Unsettled part;
  std::vector<std::vector<std::int32_t>> from((whole.size() + kGrain - 1) / kGrain);
  parallel_for(whole.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (named.bone[i] < 0) from[begin / kGrain].push_back(static_cast<std::int32_t>(i));
  });
  for (const std::vector<std::int32_t>& some : from) part.from.insert(part.from.end(), some.begin(), some.end());
  if (part.from.empty()) return part;
  std::vector<std::int32_t> number(whole.size(), kNotBone);
  for (std::size_t k = 0; k < part.from.size(); ++k) number[part.from[k]] = static_cast<std::int32_t>(k);
  const bool is_all = part.from.size() == static_cast<std::size_t>(whole.size());
  const auto count = std::ssize(part.from);
  part.graph.resize(count);
  parallel_for(count, 4096, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k) {
      const std::int32_t i = part.from[k];
      part.graph.place[k] = whole.place[i];
      part.graph.voxel[k] = whole.voxel[i];
      auto& around = part.graph.neighbour[k] = whole.neighbour[i];
      for (std::int32_t& n : around)
        if (n >= 0) n = named.group[n] != named.group[i] ? kNotBone : is_all ? n : number[n];
    }
  });
  return part;
}

}  // namespace limber
