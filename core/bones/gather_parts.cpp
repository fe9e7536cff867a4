// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/gather_parts.h"

#include <algorithm>
#include <mutex>
#include <ranges>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr std::int64_t kGrain = 65536;  // voxels per block of a parallel loop

// Connected groups of voxels with the same rig bone. The root of a group is its voxel with the lowest index.
class BonePieces {
 public:
  BonePieces(const BoneGraph& graph, const ZeroedVector<int>& bone) : parent_(graph.size()) {
    // Each block joins its own voxels. Pairs of voxels in two blocks are joined afterwards, in the order of the voxels.
    using Pair = std::pair<std::int32_t, std::int32_t>;
    std::vector<std::vector<Pair>> across((graph.size() + kGrain - 1) / kGrain);
    parallel_for(graph.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) parent_[i] = static_cast<std::int32_t>(i);
      for (std::int64_t k = begin; k < end; ++k) {
        const auto i = static_cast<std::int32_t>(k);
        for (const std::int32_t n : graph.neighbour[i]) {
          if (n <= i || bone[n] != bone[i]) continue;
          if (n < end) join(i, n);
          else across[begin / kGrain].push_back({i, n});
        }
      }
    });
    for (const std::vector<Pair>& pairs : across)
      for (const auto& [i, n] : pairs) join(i, n);
  }

  std::int32_t root(std::int32_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }

 private:
  std::int32_t shorten(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = shorten(a);
    b = shorten(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  ZeroedVector<std::int32_t> parent_;
};

// Number of voxels and sum of positions of a piece, or of the part of a piece in one block.
struct PieceSum {
  std::int64_t voxels = 0;
  glm::i64vec3 place{0};  // sum of the voxels' positions in the grid

  void add(const PieceSum& other) {
    voxels += other.voxels;
    place += other.place;
  }
};

}  // namespace

void gather_parts(const BoneGraph& graph, const Hugging& hugging, const ZeroedVector<int>& bone, BoneParts& result) {
  const BonePieces pieces(graph, bone);
  std::map<std::int32_t, PieceSum> sums;  // sums of each piece; key: the piece's root
  std::mutex adding;
  parallel_for(graph.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::map<std::int32_t, PieceSum> some;
    for (std::int64_t i = begin; i < end; ++i) {
      PieceSum& sum = some[pieces.root(static_cast<std::int32_t>(i))];
      ++sum.voxels;
      sum.place += glm::i64vec3(graph.voxel[i]);
    }
    const std::lock_guard lock(adding);
    for (const auto& [root, sum] : some) sums[root].add(sum);
  });

  std::map<int, std::int32_t> largest;  // the largest piece of each rig bone
  for (const auto& [root, sum] : sums)
    if (const auto [at, is_new] = largest.insert({bone[root], root}); !is_new && sum.voxels > sums[at->second].voxels)
      at->second = root;

  // Once there are this many parts, pieces join their bone's largest part: part numbers have 16 bits.
  constexpr int kMostParts = 60'000;
  std::map<std::int32_t, int> part_of_piece;
  for (const auto& [root, sum] : sums) {
    const std::int32_t home = largest.at(bone[root]);
    const bool is_small = 100 * sum.voxels < sums[home].voxels || std::ssize(result.parts) >= kMostParts;
    const std::int32_t kept = is_small ? home : root;
    const auto [at, is_new] = part_of_piece.insert({kept, static_cast<int>(result.parts.size())});
    if (is_new) result.parts.push_back({bone[root], 0, glm::dvec3(0)});
    BoneParts::Part& part = result.parts[at->second];
    part.voxel_count += sum.voxels;
    part.centre += glm::dvec3(sum.place);
    part_of_piece[root] = at->second;
  }
  for (BoneParts::Part& part : result.parts) part.centre = hugging.world(part.centre / double(part.voxel_count));

  parallel_for(graph.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::int32_t piece = -1;
    int part = -1;
    for (std::int64_t i = begin; i < end; ++i) {
      const std::int32_t root = pieces.root(static_cast<std::int32_t>(i));
      if (root != piece) piece = root, part = part_of_piece.at(root);
      result.part_of[graph.place[i]] = static_cast<std::uint16_t>(1 + part);
    }
  });
}

std::vector<BoneParts::Identity> identities_of(const BoneGraph& graph, const LabelVolume& volume,
                                               const NamedBones& named, const std::map<Label, LabelBones>& labels) {
  using Identities = std::map<std::pair<Label, int>, BoneParts::Identity>;
  std::vector<Identities> of_blocks((graph.size() + kGrain - 1) / kGrain);
  parallel_for(graph.size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Identities& some = of_blocks[begin / kGrain];
    // Entry of the previous voxel. It is kept because the next voxel usually has the same entry.
    BoneParts::Identity* identity = nullptr;
    for (std::int64_t i = begin; i < end; ++i) {
      const Label label = volume.at(graph.voxel[i]);
      const int bone = named.bone[i];
      if (!identity || identity->label != label || identity->bone != bone) {
        const auto name = labels.find(label);
        const bool is_substitute = name != labels.end() && name->second.is_substitute;
        identity = &some.insert({{label, bone}, {label, bone, {}, is_substitute, 0}}).first->second;
      }
      identity->found_by = named.found_by[i];
      ++identity->voxel_count;
    }
  });
  Identities found;
  for (const Identities& some : of_blocks)
    for (const auto& [key, identity] : some) {
      const auto [at, is_new] = found.insert({key, identity});
      if (is_new) continue;
      at->second.found_by = identity.found_by;
      at->second.voxel_count += identity.voxel_count;
    }
  const auto all = std::views::values(found);
  return {all.begin(), all.end()};
}

}  // namespace limber
