// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds shortest paths through tissue. A front spreads from voxel to voxel through faces, the shortest paths first.
// Each voxel stores the last corner of its path (at first the voxel where the path started) and the length of the path
// up to this corner; from the corner to the voxel the path is straight. If the previous voxel on that straight line is
// air, or a seam is near, the path bends, and the voxel from which the front came becomes the corner. As a result,
// lengths are straight distances wherever the start is visible, and most voxels are visited once.
//
// The tissue is divided into fixed domains, each a set of bricks. Threads advance the fronts of different domains at
// the same time, by one step of length. Paths from one domain into another are sent and accepted in a fixed order, so
// that the paths do not depend on the number of threads. (In the code below, "way" is a path or its length.)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/zeroed_vector.h"
#include "core/platform/memory_pages.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueFront {
 public:
  static constexpr std::uint16_t kNoSource = 0xFFFF;

  // Keeps references to its arguments.
  TissueFront(const LabelVolume& volume, const TissueVoxels& tissue)
      : grid_(volume.grid),
        tissue_(tissue),
        ways_(tissue.size()),
        width_(static_cast<float>(kWidth * std::min({grid_.spacing.x, grid_.spacing.y, grid_.spacing.z}))),
        domains_(std::clamp<std::size_t>(tissue.bricks().size() / kLeastBricks, 1, kMostDomains)) {
    want_large_pages(ways_.data(), tissue.size() * static_cast<std::int64_t>(sizeof(Way)));
    for (Domain& domain : domains_) domain.sent.resize(domains_.size());
  }

  // Starts paths at a voxel.
  //   place   the voxel's index in the list of tissue voxels
  //   source  a number that is stored with these paths, such as the index of a bone
  void start(std::int64_t place, const glm::ivec3& voxel, std::uint16_t source) {
    ways_[place] = {glm::i16vec3(voxel), source, 0, 0};
    add(domains_[domain_of(tissue_.brick_at(voxel))], {static_cast<std::int32_t>(place), 0, glm::i16vec3(voxel)}, 0);
  }

  // Starts paths at all voxels that have a source, on several threads.
  //   source_of  a function (place, voxel) -> the source of the paths that start there; kNoSource: no path starts there
  template <class SourceOf>
  void start_all(const SourceOf& source_of) {
    const auto bricks = std::ssize(tissue_.bricks()), domains = std::ssize(domains_);
    parallel_for(domains, 1, [&](std::int64_t begin, std::int64_t end) {
      tissue_.for_each((begin * bricks + domains - 1) / domains, (end * bricks + domains - 1) / domains,
                       [&](std::int64_t place, const glm::ivec3& voxel) {
                         if (const std::uint16_t source = source_of(place, voxel); source != kNoSource)
                           start(place, voxel, source);
                       });
    });
  }

  // Spreads the front until no path gets shorter. is_shorter and take are called from several threads, for different
  // voxels.
  //   is_shorter  a function (source, to, way) that returns true if a path of length `way` (mm) to voxel `to` is better
  //               than the best known path to `to`. It returns false for a path of equal length. If it returns false,
  //               it must also return false for any longer path.
  //   take        a function (source, to, way) that stores such a path; the front spreads further from there
  //   reached     #tissue voxels: the array that is_shorter reads. It is only prefetched into the cache.
  template <class IsShorter, class Take>
  void spread(std::span<const float> reached, const IsShorter& is_shorter, const Take& take) {
    const std::vector<bool> near_seam = bricks_near_seams();
    for (std::size_t bucket = 0; bucket < bucket_count(); ++bucket) {
      for (std::vector<Domain*> waiting = domains_waiting(bucket); !waiting.empty();
           waiting = domains_waiting(bucket)) {
        parallel_for(std::ssize(waiting), 1, [&](std::int64_t begin, std::int64_t end) {
          for (std::int64_t k = begin; k < end; ++k) advance(*waiting[k], bucket, near_seam, reached, is_shorter, take);
        });
        parallel_for(std::ssize(domains_), 1, [&](std::int64_t begin, std::int64_t end) {
          for (std::int64_t to = begin; to < end; ++to)
            for (Domain* from : waiting) {
              for (const Step& step : from->sent[to]) accept(step, domains_[to], bucket, is_shorter, take);
              from->sent[to].clear();
            }
        });
      }
      for (Domain& domain : domains_) {
        domain.done = 0;
        if (bucket < domain.buckets.size()) domain.finish(bucket);
      }
    }
    for (Domain& domain : domains_) domain.buckets.clear(), domain.spare.clear();
  }

 private:
  static constexpr glm::ivec3 kSteps[] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  // Width of a bucket, as a share of the shortest voxel edge. Reached voxels are sorted into buckets by the length of
  // their paths. Paths in one bucket may be advanced in any order.
  static constexpr double kWidth = 0.5;
  static constexpr std::size_t kLeastBricks = 256, kMostDomains = 64;
  // Number of entries by which the prefetch of a voxel's memory is ahead of the current entry of the bucket.
  static constexpr std::size_t kAhead = 12;

  // The shortest known path to a voxel: its last corner, its source, its length up to the corner, and its whole length
  // (both lengths in mm).
  struct Way {
    glm::i16vec3 corner;
    std::uint16_t source;
    float to_corner, length;
  };
  struct Reached {
    std::int32_t place;
    float way;  // length of the path, mm
    glm::i16vec3 voxel;
  };
  struct Step {
    std::int32_t to;
    glm::i16vec3 voxel;
    Way way;
  };
  struct Domain {
    // Clears a finished bucket. Its memory is kept for later buckets, since only few buckets are open at the same time.
    // The first bucket's memory is freed, since it may be far larger.
    void finish(std::size_t bucket) {
      std::vector<Reached> done_with = std::move(buckets[bucket]);
      done_with.clear();
      if (bucket > 0 && done_with.capacity() > 0) spare.push_back(std::move(done_with));
    }
    std::vector<Reached>& open(std::size_t bucket) {
      if (bucket >= buckets.size()) buckets.resize(bucket + 1);
      if (buckets[bucket].capacity() == 0 && !spare.empty()) {
        buckets[bucket] = std::move(spare.back());
        spare.pop_back();
      }
      return buckets[bucket];
    }

    std::vector<std::vector<Reached>> buckets;  // reached voxels, in one bucket per range of path lengths
    std::vector<std::vector<Reached>> spare;    // empty buckets for reuse
    std::size_t done = 0;                       // number of finished entries of the current bucket
    std::vector<std::vector<Step>> sent;        // steps that lead into other domains, by domain
  };

  template <class IsShorter, class Take>
  void advance(Domain& domain, std::size_t bucket, const std::vector<bool>& is_near_seam,
               std::span<const float> reached, const IsShorter& is_shorter, const Take& take) {
    const Seams* seams = tissue_.seams();
    for (; domain.done < domain.buckets[bucket].size(); ++domain.done) {
      if (const std::size_t ahead = domain.done + kAhead; ahead < domain.buckets[bucket].size())
        fetch(domain.buckets[bucket][ahead].place, reached);
      const auto [place, way_here, small_voxel] = domain.buckets[bucket][domain.done];
      const Way here = ways_[place];
      if (way_here > here.length) continue;  // a shorter path to this voxel was found later
      const glm::ivec3 voxel(small_voxel), corner(here.corner);
      const float before = here.to_corner;
      const int brick_here = tissue_.brick_at(voxel);
      const Neighbours around = neighbours_of(voxel, brick_here, place);
      const std::array<float, 6> straight_on = straight_to_neighbours(corner, voxel);
      for (int direction = 0; direction < 6; ++direction) {
        const auto [brick, there] = around[direction];
        if (there < 0) continue;
        Domain& beyond = brick == brick_here ? domain : domains_[domain_of(brick)];
        const bool is_own = &beyond == &domain;
        // The length of the straight path is a lower limit: a path that must bend is longer.
        float way = before + straight_on[direction];
        // A path never goes back to its own corner. For a voxel in another domain, no more than this can be tested
        // here.
        if (is_own ? !is_shorter(here.source, std::int64_t{there}, way) : straight_on[direction] == 0) continue;
        const bool near_seam = seams && is_near_seam[brick];
        if (near_seam && seams->is_cut_towards(voxel, direction)) continue;
        const glm::ivec3 w = voxel + kSteps[direction];
        const bool bends = !tissue_.holds(w - step_towards(w - corner)) || (near_seam && seams->touches(w));
        const float to_bend = before + straight(corner, voxel);
        if (bends) way = to_bend + straight(voxel, w);
        const Step step{
            there, glm::i16vec3(w),
            bends ? Way{small_voxel, here.source, to_bend, way} : Way{here.corner, here.source, before, way}};
        if (is_own) accept(step, domain, bucket, is_shorter, take);
        else domain.sent[&beyond - domains_.data()].push_back(step);
      }
    }
  }

  template <class IsShorter, class Take>
  void accept(const Step& step, Domain& domain, std::size_t bucket, const IsShorter& is_shorter, const Take& take) {
    if (!is_shorter(step.way.source, std::int64_t{step.to}, step.way.length)) return;
    take(step.way.source, std::int64_t{step.to}, step.way.length);
    ways_[step.to] = step.way;
    add(domain, {step.to, step.way.length, step.voxel}, bucket);
  }

  // Prefetches the memory that is needed to advance from a voxel: its path and the values of its neighbours. The
  // neighbours above and below are about one slice of a full brick away in memory. The function is always inlined,
  // since compilers remove a separate function that seems to have no effect.
  [[gnu::always_inline]] void fetch(std::int32_t place, std::span<const float> reached) const {
    constexpr int kSlice = TissueVoxels::kBrick * TissueVoxels::kBrick;
    __builtin_prefetch(&ways_[place]);
    __builtin_prefetch(&reached[place]);
    __builtin_prefetch(&reached[std::max(place - kSlice, 0)]);
    __builtin_prefetch(&reached[std::min<std::int64_t>(std::int64_t{place} + kSlice, std::ssize(reached) - 1)]);
  }

  void add(Domain& domain, const Reached& reached, std::size_t present) {
    domain.open(std::max(present, static_cast<std::size_t>(reached.way / width_))).push_back(reached);
  }

  std::size_t bucket_count() const {
    std::size_t most = 0;
    for (const Domain& domain : domains_) most = std::max(most, domain.buckets.size());
    return most;
  }
  // Returns the domains that still have unfinished entries in a bucket.
  std::vector<Domain*> domains_waiting(std::size_t bucket) {
    std::vector<Domain*> waiting;
    for (Domain& domain : domains_)
      if (bucket < domain.buckets.size() && domain.done < domain.buckets[bucket].size()) waiting.push_back(&domain);
    return waiting;
  }

  std::size_t domain_of(std::int64_t brick) const { return brick * domains_.size() / tissue_.bricks().size(); }

  // A neighbour of a voxel: its brick, and its index in the list of tissue voxels (-1: air, or outside the grid).
  struct Neighbour {
    std::int32_t brick, place;
  };
  using Neighbours = std::array<Neighbour, 6>;

  // Returns the neighbours of a voxel in the directions kSteps. The indices of neighbours in the voxel's own row and
  // slice are found by counting the tissue voxels in between.
  //   brick, place  the voxel's brick, and its index in the list of tissue voxels
  Neighbours neighbours_of(const glm::ivec3& voxel, int brick, std::int32_t place) const {
    constexpr int kLast = TissueVoxels::kBrick - 1;
    const TissueVoxels::Brick& here = tissue_.bricks()[brick];
    const glm::ivec3 in = voxel & kLast;
    const int bit = in.x + TissueVoxels::kBrick * in.y;
    const std::uint64_t slice = here.mask[in.z];
    const auto holds = [&](int at) { return (slice >> at & 1) != 0; };
    const auto in_slice = [&](int direction) {
      return Neighbour{brick, static_cast<std::int32_t>(
                                  TissueVoxels::index_in(here, {in.x, in.y, direction & 1 ? in.z + 1 : in.z - 1}))};
    };
    return {in.x > 0 ? Neighbour{brick, holds(bit - 1) ? place - 1 : -1} : beyond_brick(voxel, 0),
            in.x < kLast ? Neighbour{brick, holds(bit + 1) ? place + 1 : -1} : beyond_brick(voxel, 1),
            in.y > 0 ? Neighbour{brick, holds(bit - 8) ? place - bits_in_byte(slice >> (bit - 8)) : -1}
                     : beyond_brick(voxel, 2),
            in.y < kLast ? Neighbour{brick, holds(bit + 8) ? place + bits_in_byte(slice >> bit) : -1}
                         : beyond_brick(voxel, 3),
            in.z > 0 ? in_slice(4) : beyond_brick(voxel, 4),
            in.z < kLast ? in_slice(5) : beyond_brick(voxel, 5)};
  }
  Neighbour beyond_brick(const glm::ivec3& voxel, int direction) const {
    const glm::ivec3 w = voxel + kSteps[direction];
    if (!grid_.contains(w)) return {-1, -1};
    const int brick = tissue_.brick_at(w);
    if (brick < 0) return {-1, -1};
    return {brick, static_cast<std::int32_t>(TissueVoxels::index_in(tissue_.bricks()[brick], w & 7))};
  }
  // Returns the number of bits that are set in the lowest byte of a word.
  static int bits_in_byte(std::uint64_t word) {
    std::uint32_t byte = word & 0xff;
    byte -= byte >> 1 & 0x55;
    byte = (byte & 0x33) + (byte >> 2 & 0x33);
    return static_cast<int>((byte + (byte >> 4)) & 0xf);
  }

  std::vector<bool> bricks_near_seams() const {
    std::vector<bool> near;
    if (!tissue_.seams()) return near;
    near.reserve(tissue_.bricks().size());
    for (const auto& brick : tissue_.bricks()) near.push_back(tissue_.seams()->is_near_brick(brick.corner));
    return near;
  }

  // Returns the step to that one of the 26 neighbours whose direction is nearest to `way`.
  static glm::ivec3 step_towards(const glm::ivec3& way) {
    const glm::ivec3 size = glm::abs(way);
    const int longest = std::max({size.x, size.y, size.z});
    const auto step = [&](int along) { return 2 * std::abs(along) < longest ? 0 : along < 0 ? -1 : 1; };
    return {step(way.x), step(way.y), step(way.z)};
  }

  // Returns the length, mm, of the straight path from a corner to each of the six neighbours of a voxel.
  std::array<float, 6> straight_to_neighbours(const glm::ivec3& corner, const glm::ivec3& voxel) const {
    const auto squared = [&](const glm::ivec3& way) {
      const glm::vec3 length = glm::vec3(way) * spacing_;
      return length * length;
    };
    const glm::ivec3 way = voxel - corner;
    const glm::vec3 here = squared(way), lower = squared(way - 1), higher = squared(way + 1);
    return {std::sqrt(lower.x + here.y + here.z), std::sqrt(higher.x + here.y + here.z),
            std::sqrt(here.x + lower.y + here.z), std::sqrt(here.x + higher.y + here.z),
            std::sqrt(here.x + here.y + lower.z), std::sqrt(here.x + here.y + higher.z)};
  }
  float straight(const glm::ivec3& a, const glm::ivec3& b) const {
    const glm::vec3 way = glm::vec3(b - a) * spacing_;
    return std::sqrt(glm::dot(way, way));
  }

  const Grid& grid_;
  const glm::vec3 spacing_{grid_.spacing};
  const TissueVoxels& tissue_;
  ZeroedVector<Way> ways_;  // shortest known path to each tissue voxel
  float width_;
  std::vector<Domain> domains_;
};

}  // namespace limber
