// SPDX-License-Identifier: AGPL-3.0-or-later
// Shortest ways through tissue, spread as a front from voxel to voxel through faces, the shortest first. Each voxel
// remembers the corner its way last came round (at first the voxel it started from) and the length of the way to there;
// the rest is straight. Where the voxel before it on that straight line is air, or a seam is near, the way bends, and the
// voxel the front came from is the new corner. So lengths are straight distances wherever one can see the start, and most
// voxels are visited once.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueFront {
 public:
  // References are kept.
  TissueFront(const LabelVolume& volume, const TissueVoxels& tissue)
      : grid_(volume.grid), tissue_(tissue), ways_(tissue.size()),
        width_(static_cast<float>(kWidth * std::min({grid_.spacing.x, grid_.spacing.y, grid_.spacing.z}))), buckets_(1) {}

  void start(std::int64_t place, const glm::ivec3& voxel) {
    ways_[place] = {glm::i16vec3(voxel), 0, 0};
    buckets_[0].push_back({static_cast<std::int32_t>(place), 0, glm::i16vec3(voxel)});
  }

  // Lets the front go on until no way is shorter any more.
  //   is_shorter  (from, to, way) -> whether a way of that many mm to place `to`, coming from place `from`, is better
  //               than what `to` has. Where it is not, no longer way may be.
  //   take        (from, to, way): notes such a way; the front goes on from there
  template <class IsShorter, class Take>
  void spread(const IsShorter& is_shorter, const Take& take) {
    const std::vector<bool> is_near_seam = bricks_near_seams();
    const Seams* seams = tissue_.seams();
    for (std::size_t bucket = 0; bucket < buckets_.size(); ++bucket) {
      for (std::size_t i = 0; i < buckets_[bucket].size(); ++i) {
        const auto [place, way_here, small_voxel] = buckets_[bucket][i];
        const Way here = ways_[place];
        if (way_here > here.length) continue;  // a shorter one came later
        const glm::ivec3 voxel(small_voxel), corner(here.corner);
        const float before = here.to_corner;
        const int brick_here = tissue_.brick_at(voxel);
        for (int direction = 0; direction < 6; ++direction) {
          const glm::ivec3 w = voxel + kSteps[direction];
          const std::int64_t there = place_of(w, voxel, brick_here);
          if (there < 0 || corner == w) continue;
          // A bent way is longer.
          float way = before + straight(corner, w);
          if (!is_shorter(std::int64_t{place}, there, way)) continue;
          const bool near_seam = seams && is_near_seam[tissue_.brick_at(w)];
          if (near_seam && seams->is_cut_towards(voxel, direction)) continue;
          const bool bends = !tissue_.holds(w - step_towards(w - corner)) || (near_seam && seams->touches(w));
          const float to_bend = before + straight(corner, voxel);
          if (bends) {
            way = to_bend + straight(voxel, w);
            if (!is_shorter(std::int64_t{place}, there, way)) continue;
          }
          take(std::int64_t{place}, there, way);
          ways_[there] = bends ? Way{small_voxel, to_bend, way} : Way{here.corner, before, way};
          add({static_cast<std::int32_t>(there), way, glm::i16vec3(w)}, bucket);
        }
      }
      buckets_[bucket] = {};
    }
    buckets_.assign(1, {});
  }

 private:
  static constexpr glm::ivec3 kSteps[] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  static constexpr double kWidth = 0.5;  // of the shortest voxel edge: ways that differ by less may come in any order

  // The shortest known to a voxel, mm: to the corner that it last came round, and all of it.
  struct Way {
    glm::i16vec3 corner{0};
    float to_corner = 0, length = 0;
  };
  struct Reached {
    std::int32_t place;
    float way;  // mm
    glm::i16vec3 voxel;
  };

  void add(const Reached& reached, std::size_t present) {
    const std::size_t bucket = std::max(present, static_cast<std::size_t>(reached.way / width_));
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].push_back(reached);
  }

  // Of a voxel beside another one, which lies in a brick; -1 for air and outside of the grid.
  std::int64_t place_of(const glm::ivec3& voxel, const glm::ivec3& beside, int brick) const {
    const glm::ivec3 differs = voxel ^ beside;
    const bool is_in_brick = ((differs.x | differs.y | differs.z) & ~(TissueVoxels::kBrick - 1)) == 0;
    if (!is_in_brick) {
      if (!grid_.contains(voxel)) return -1;
      brick = tissue_.brick_at(voxel);
      if (brick < 0) return -1;
    }
    return TissueVoxels::index_in(tissue_.bricks()[brick], voxel & 7);
  }

  std::vector<bool> bricks_near_seams() const {
    std::vector<bool> near;
    if (!tissue_.seams()) return near;
    near.reserve(tissue_.bricks().size());
    for (const auto& brick : tissue_.bricks()) near.push_back(tissue_.seams()->is_near_brick(brick.corner));
    return near;
  }

  // The step to one of the 26 neighbours that is nearest to a direction.
  static glm::ivec3 step_towards(const glm::ivec3& way) {
    const glm::ivec3 size = glm::abs(way);
    const int longest = std::max({size.x, size.y, size.z});
    const auto step = [&](int along) { return 2 * std::abs(along) < longest ? 0 : along < 0 ? -1 : 1; };
    return {step(way.x), step(way.y), step(way.z)};
  }

  float straight(const glm::ivec3& a, const glm::ivec3& b) const {
    const glm::vec3 way = glm::vec3(b - a) * spacing_;
    return std::sqrt(glm::dot(way, way));
  }

  const Grid& grid_;
  const glm::vec3 spacing_{grid_.spacing};
  const TissueVoxels& tissue_;
  std::vector<Way> ways_;  // by place
  float width_;
  std::vector<std::vector<Reached>> buckets_;  // by length of the way
};

}  // namespace limber
