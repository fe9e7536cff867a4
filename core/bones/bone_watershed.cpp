// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_watershed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <queue>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {

// Two basins are merged if the height of the pass between them is above this share of the lower summit: the pass is
// then only a variation of height along one bone. On a whole arm whose true bones are known, 0.9 puts 0.4 % of the bone
// voxels into a basin of another bone, and 0.7 puts 2.4 %. Splitting one bone too often does no harm, because its
// pieces find the same rig bone.
constexpr double kMergeRatio = 0.9;
constexpr std::int64_t kBricks = 64;  // bricks (8^3 voxels each) per block of a parallel loop
// A variation of depth counts as an effect of rounding to voxels only up to this share of the summit's depth. The limit
// is relative to the summit because a finger bone is only two voxels deep.
constexpr double kWiggleShare = 0.2;

std::array<glm::ivec3, 26> offsets_26() {
  std::array<glm::ivec3, 26> offsets;
  int count = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (x || y || z) offsets[count++] = {x, y, z};
  return offsets;
}
const std::array<glm::ivec3, 26> kOffsets = offsets_26();

// Decides which pairs of bone labels are different bones that merely touch. Two labels of plain bone ("Right humerus",
// "Right ulna") are different bones, unless one is inside the other, as marrow is inside its shell. A label is inside
// if more than half of its faces touch bone.
class LabelWalls {
 public:
  LabelWalls(const LabelVolume& volume, const TissueVoxels& tissue, const std::vector<TissueKind>& kinds)
      : plain_(kinds.size(), 0) {
    int plain_labels = 0;
    for (size_t label = 0; label < kinds.size(); ++label)
      plain_labels += plain_[label] = kinds[label] == TissueKind::Bone;
    if (plain_labels < 2) {
      std::fill(plain_.begin(), plain_.end(), 0);
      return;
    }
    std::vector<std::int64_t> faces(kinds.size()), bone_faces(kinds.size());
    std::mutex adding;
    parallel_for(std::ssize(tissue.bricks()), kBricks, [&](std::int64_t begin, std::int64_t end) {
      // For each label of plain bone: number of its voxels' faces; number of those that touch bone.
      std::map<Label, std::array<std::int64_t, 2>> some;
      tissue.for_each(begin, end, [&](std::int64_t, const glm::ivec3& v) {
        const Label label = volume.at(v);
        if (!plain_[label]) return;
        for (int axis = 0; axis < 3; ++axis)
          for (int side = -1; side <= 1; side += 2) {
            glm::ivec3 w = v;
            w[axis] += side;
            const Label other = volume.at_or_air(w);
            if (other == label) continue;
            auto& [all, of_bone] = some[label];
            ++all;
            of_bone += is_bone(kinds[other]);
          }
      });
      const std::lock_guard lock(adding);
      for (const auto& [label, counts] : some) {
        faces[label] += counts[0];
        bone_faces[label] += counts[1];
      }
    });
    for (size_t label = 0; label < kinds.size(); ++label)
      if (2 * bone_faces[label] > faces[label]) plain_[label] = 0;
  }
  bool may_part(Label label) const { return plain_[label]; }
  bool between(Label a, Label b) const { return a != b && plain_[a] && plain_[b]; }

 private:
  std::vector<std::uint8_t> plain_;  // for each label, 1: plain bone that is not inside another bone
};

}  // namespace

void BoneGraph::resize(std::int64_t count) {
  place.resize(count);
  voxel.resize(count);
  neighbour.resize(count);
  want_large_pages(neighbour.data(), count * static_cast<std::int64_t>(sizeof(neighbour[0])));
}

namespace {
// The bone voxels of a volume as bit masks of its bricks (blocks of 8^3 voxels). Counting bits gives the index of a
// voxel in the graph.
class BoneMasks {
 public:
  //   bone  labels of bone tissue
  BoneMasks(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& bone)
      : grid_(volume.grid),
        tissue_(tissue),
        bricks_(tissue.bricks().size()) {
    parallel_for(std::ssize(bricks_), kBricks, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t b = begin; b < end; ++b) {
        bricks_[b] = {tissue.bricks()[b].corner, 0, {}};
        auto& [corner, first, mask, below] = bricks_[b];
        tissue.for_each_of(b, volume, bone, [&](std::int64_t, const glm::ivec3& v) {
          mask[v.z & 7] |= std::uint64_t{1} << ((v.x & 7) + 8 * (v.y & 7));
        });
        for (int z = 1; z < TissueVoxels::kBrick; ++z)
          below[z] = static_cast<std::uint16_t>(below[z - 1] + std::popcount(mask[z - 1]));
      }
    });
    for (TissueVoxels::Brick& brick : bricks_) brick.first = std::exchange(size_, size_ + brick.count());
  }

  std::int64_t size() const { return size_; }
  std::int64_t first_of(std::int64_t brick) const { return bricks_[brick].first; }

  // Returns the 26 neighbours of a voxel in the order of kOffsets.
  std::array<std::int32_t, 26> neighbours_of(const glm::ivec3& voxel) const {
    std::array<std::int32_t, 27> block;
    for (int row = 0; row < 9; ++row) find_row(voxel + glm::ivec3(0, row % 3 - 1, row / 3 - 1), &block[3 * row]);
    std::array<std::int32_t, 26> neighbours;
    std::copy_n(block.begin(), 13, neighbours.begin());
    std::copy_n(block.begin() + 14, 13, neighbours.begin() + 13);  // the voxel itself is left out
    return neighbours;
  }

 private:
  // Writes to `found` the indices in the graph of three voxels in a row along x, with `middle` in the middle; kNotBone
  // or kOutside for a voxel that is not in the graph.
  void find_row(const glm::ivec3& middle, std::int32_t* found) const {
    const int x = middle.x & 7, z = middle.z & 7, lowest = x - 1 + 8 * (middle.y & 7);
    if (x == 0 || x == 7 || !grid_.contains(middle) || middle.x + 1 == grid_.size.x) {
      for (int k = 0; k < 3; ++k) found[k] = find(middle + glm::ivec3(k - 1, 0, 0));
      return;
    }
    const int at = tissue_.brick_at(middle);
    const std::uint64_t mask = at < 0 ? 0 : bricks_[at].mask[z], three = mask >> lowest & 7;
    if (three == 0) return static_cast<void>(std::fill_n(found, 3, kNotBone));
    const std::uint64_t lower = mask & ((std::uint64_t{1} << lowest) - 1);
    auto next = static_cast<std::int32_t>(bricks_[at].first + bricks_[at].below[z] + std::popcount(lower));
    for (int k = 0; k < 3; ++k) found[k] = three >> k & 1 ? next++ : kNotBone;
  }
  std::int32_t find(const glm::ivec3& voxel) const {
    if (!grid_.contains(voxel)) return kOutside;
    const int at = tissue_.brick_at(voxel);
    return at < 0 ? kNotBone : static_cast<std::int32_t>(TissueVoxels::index_in(bricks_[at], voxel & 7));
  }

  const Grid& grid_;
  const TissueVoxels& tissue_;
  std::vector<TissueVoxels::Brick> bricks_;
  std::int64_t size_ = 0;
};
}  // namespace

BoneGraph gather_bone(const LabelVolume& volume, const TissueVoxels& tissue, const std::vector<TissueKind>& kinds) {
  LabelSet bone(kinds.size());
  std::transform(kinds.begin(), kinds.end(), bone.begin(), is_bone);
  const BoneMasks masks(volume, tissue, bone);
  BoneGraph graph;
  graph.resize(masks.size());
  const LabelWalls walls(volume, tissue, kinds);
  const auto part = [&](const glm::ivec3& v, std::array<std::int32_t, 26>& neighbours) {
    for (int k = 0; k < 26; ++k)
      if (neighbours[k] >= 0 && walls.between(volume.at(v), volume.at(v + kOffsets[k]))) neighbours[k] = kNotBone;
  };
  parallel_for(std::ssize(tissue.bricks()), kBricks, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b) {
      std::int64_t i = masks.first_of(b);
      tissue.for_each_of(b, volume, bone, [&](std::int64_t place, const glm::ivec3& v) {
        graph.place[i] = place;
        graph.voxel[i] = v;
        graph.neighbour[i] = masks.neighbours_of(v);
        if (walls.may_part(volume.at(v))) part(v, graph.neighbour[i]);
        ++i;
      });
    }
  });
  return graph;
}

namespace {
// Computes the distance of voxels to the nearest border of their bone by propagation: each voxel passes its nearest
// border position on to its neighbours, the nearest voxels first.
class DepthFront {
 public:
  DepthFront(const BoneGraph& graph, const glm::dvec3& spacing, std::vector<float>& depth)
      : graph_(graph),
        spacing_(spacing),
        depth_(depth),
        offset_(graph.size(), glm::ivec3(0)) {}

  // Lowers the depth of a voxel to the distance from its neighbours that are not of the same bone. Returns true if the
  // depth changed.
  bool start(std::int32_t i) {
    bool starts = false;
    for (int k = 0; k < 26; ++k) starts |= graph_.neighbour[i][k] == kNotBone && take(i, kOffsets[k]);
    return starts;
  }
  void spread(const std::vector<std::int32_t>& from) {
    std::vector<Entry> entries;
    for (const std::int32_t i : from) entries.push_back({depth_[i], i});
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front(std::greater<>(), std::move(entries));
    while (!front.empty()) {
      const auto [distance, i] = front.top();
      front.pop();
      if (distance > depth_[i]) continue;
      for (int k = 0; k < 26; ++k)
        if (const std::int32_t n = graph_.neighbour[i][k]; n >= 0 && take(n, offset_[i] - kOffsets[k]))
          front.push({depth_[n], n});
    }
  }

 private:
  using Entry = std::pair<float, std::int32_t>;

  bool take(std::int32_t i, const glm::ivec3& to_border) {
    const glm::dvec3 way = glm::dvec3(to_border) * spacing_;
    const double squared = glm::dot(way, way), known = depth_[i];
    if (squared >= known * known) return false;
    const float distance = static_cast<float>(std::sqrt(squared));
    if (distance >= depth_[i]) return false;
    depth_[i] = distance;
    offset_[i] = to_border;
    return true;
  }

  const BoneGraph& graph_;
  const glm::dvec3 spacing_;
  std::vector<float>& depth_;
  std::vector<glm::ivec3> offset_;  // offset, in voxels, from each voxel of the graph to its nearest border
};
}  // namespace

void lower_depth(const BoneGraph& graph, const glm::dvec3& spacing, const std::vector<std::int32_t>& at_borders,
                 std::vector<float>& depth) {
  DepthFront front(graph, spacing, depth);
  std::vector<std::int32_t> from;
  for (const std::int32_t i : at_borders)
    if (front.start(i)) from.push_back(i);
  front.spread(from);
}

std::vector<float> bone_depth(const BoneGraph& graph, const glm::dvec3& spacing) {
  std::vector<float> depth(graph.size(), std::numeric_limits<float>::max());
  DepthFront front(graph, spacing, depth);
  std::vector<std::uint8_t> starts(graph.size());
  parallel_for(graph.size(), 4096, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) starts[i] = front.start(static_cast<std::int32_t>(i));
  });
  std::vector<std::int32_t> from;
  for (std::int32_t i = 0; i < graph.size(); ++i)
    if (starts[i]) from.push_back(i);
  front.spread(from);
  for (float& d : depth)
    if (d == std::numeric_limits<float>::max()) d = 0;
  return depth;
}

namespace {
// Returns the indices of `height` (no value is negative) in descending order of height; equal heights keep their order.
// Uses a radix sort on the bits of the floats, which increase with their values, eleven bits at a time.
std::vector<std::int32_t> highest_first(const std::vector<float>& height) {
  constexpr int kBits = 11;
  std::vector<std::int32_t> order(height.size()), next(height.size());
  std::iota(order.begin(), order.end(), 0);
  for (int shift = 0; shift < 32; shift += kBits) {
    const auto digit = [&](std::int32_t i) {
      return ~std::bit_cast<std::uint32_t>(height[i]) >> shift & ((1u << kBits) - 1);
    };
    std::array<std::int64_t, (1 << kBits) + 1> first{};
    for (const std::int32_t i : order) ++first[digit(i) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (const std::int32_t i : order) next[first[digit(i)]++] = i;
    order.swap(next);
  }
  return order;
}
}  // namespace

std::vector<std::int32_t> flood(const BoneGraph& graph, const std::vector<float>& height, double wiggle) {
  const std::vector<std::int32_t> order = highest_first(height);
  struct Ground {
    float height;
    std::int32_t basin;
  };
  std::vector<Ground> ground(graph.size());
  for (std::int64_t i = 0; i < graph.size(); ++i) ground[i] = {height[i], -1};
  std::vector<std::int32_t> parent;
  std::vector<float> summit;
  auto root = [&](std::int32_t b) {
    while (parent[b] != b) b = parent[b] = parent[parent[b]];
    return b;
  };
  constexpr std::size_t kAhead = 8;  // number of voxels between the prefetch of a voxel's memory and its use
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k + kAhead < order.size()) {
      const std::array<std::int32_t, 26>& ahead = graph.neighbour[order[k + kAhead]];
      __builtin_prefetch(&ahead.front());
      __builtin_prefetch(&ahead.back());
    }
    const std::int32_t i = order[k];
    Ground& here = ground[i];
    std::int32_t best = -1;
    float best_height = -1;
    for (std::int32_t n : graph.neighbour[i])
      if (n >= 0 && ground[n].basin >= 0 && ground[n].height > best_height) best = n, best_height = ground[n].height;
    if (best < 0) {
      here.basin = static_cast<std::int32_t>(parent.size());
      parent.push_back(here.basin);
      summit.push_back(here.height);
      continue;
    }
    here.basin = root(ground[best].basin);
    for (std::int32_t n : graph.neighbour[i]) {
      if (n < 0 || ground[n].basin < 0) continue;
      std::int32_t a = root(here.basin), b = root(ground[n].basin);
      if (a == b) continue;
      if (summit[b] > summit[a] || (summit[b] == summit[a] && b < a)) std::swap(a, b);
      const float pass = std::min(here.height, ground[n].height);
      if (pass >= kMergeRatio * summit[b] || summit[b] - pass <= std::min(wiggle, kWiggleShare * summit[b]))
        parent[b] = a;
    }
  }
  std::vector<std::int32_t> number(parent.size(), -1);
  std::int32_t count = 0;
  std::vector<std::int32_t> basin;
  basin.reserve(ground.size());
  for (const Ground& here : ground) {
    std::int32_t& its_number = number[root(here.basin)];
    if (its_number < 0) its_number = count++;
    basin.push_back(its_number);
  }
  return basin;
}

void join_specks(const BoneGraph& graph, std::int64_t fewest, std::vector<std::int32_t>& basin) {
  std::vector<std::int64_t> count;
  for (std::int32_t b : basin) {
    if (b >= std::ssize(count)) count.resize(b + 1);
    ++count[b];
  }
  std::map<std::int32_t, std::map<std::int32_t, int>> around;
  for (std::int64_t i = 0; i < graph.size(); ++i) {
    if (count[basin[i]] >= fewest) continue;
    for (std::int32_t n : graph.neighbour[i])
      if (n >= 0 && basin[n] != basin[i]) ++around[basin[i]][basin[n]];
  }
  std::vector<std::int32_t> into(count.size());
  std::iota(into.begin(), into.end(), 0);
  auto end_of = [&](std::int32_t b) {
    while (into[b] != b) b = into[b] = into[into[b]];
    return b;
  };
  for (const auto& [speck, neighbours] : around) {
    const auto most =
        std::max_element(neighbours.begin(), neighbours.end(), [](auto& a, auto& b) { return a.second < b.second; });
    into[end_of(speck)] = end_of(most->first);
  }
  std::vector<std::int32_t> number(count.size(), -1);
  std::int32_t next = 0;
  for (std::int32_t& b : basin) {
    b = end_of(b);
    if (number[b] < 0) number[b] = next++;
    b = number[b];
  }
}

std::vector<std::vector<std::int32_t>> members_of(const std::vector<std::int32_t>& basin) {
  std::vector<std::vector<std::int32_t>> members;
  for (size_t i = 0; i < basin.size(); ++i) {
    if (basin[i] >= std::ssize(members)) members.resize(basin[i] + 1);
    members[basin[i]].push_back(static_cast<std::int32_t>(i));
  }
  return members;
}

}  // namespace limber
