// SPDX-License-Identifier: AGPL-3.0-or-later
// Shortest ways through tissue, spread as a front from voxel to voxel through faces. Each voxel remembers the corner
// its way last came round (at first the voxel it started from) and the length of the way to there; the rest is
// straight. Where the voxel before it on that straight line is air, or a seam is near, the way bends, and the voxel the front came from is
// the new corner. So lengths are straight distances wherever one can see the start, at the cost of a few visits a voxel.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueFront {
 public:
  // References are kept.
  TissueFront(const LabelVolume& volume, const TissueVoxels& tissue)
      : volume_(volume), tissue_(tissue), corner_(tissue.size()), to_corner_(tissue.size()) {}

  void start(std::int64_t place, const glm::ivec3& voxel) {
    corner_[place] = glm::i16vec3(voxel);
    to_corner_[place] = 0;
    front_.push_back({static_cast<std::int32_t>(place), glm::i16vec3(voxel)});
  }

  // shorter(from, to, way): whether a way of that many mm to place `to`, coming from place `from`, is better than what
  // `to` has; if so the caller notes it and the front goes on from there.
  template <class Shorter>
  void spread(const Shorter& shorter) {
    std::vector<std::pair<std::int32_t, glm::i16vec3>> next;
    const Seams* seams = tissue_.seams();
    while (!front_.empty()) {
      next.clear();
      for (const auto& [place, voxel] : front_)
        for (int direction = 0; direction < 6; ++direction) {
          glm::ivec3 w(voxel);
          w[direction >> 1] += direction & 1 ? 1 : -1;
          if (volume_.at_or_air(w) == 0 || (seams && seams->is_cut_towards(glm::ivec3(voxel), direction))) continue;
          glm::ivec3 corner(corner_[place]);
          if (corner == w) continue;
          float before = to_corner_[place];
          const glm::ivec3 back = w - step_towards(w - corner);
          if (volume_.at(back) == 0 || (seams && seams->touches(w))) {
            before += straight(corner, glm::ivec3(voxel));
            corner = glm::ivec3(voxel);
          }
          const std::int64_t there = tissue_.index_of(w);
          if (!shorter(std::int64_t{place}, there, before + straight(corner, w))) continue;
          corner_[there] = glm::i16vec3(corner);
          to_corner_[there] = before;
          next.push_back({static_cast<std::int32_t>(there), glm::i16vec3(w)});
        }
      front_.swap(next);
    }
  }

 private:
  // The step to one of the 26 neighbours that is nearest to a direction.
  static glm::ivec3 step_towards(const glm::ivec3& way) {
    const glm::ivec3 size = glm::abs(way);
    const int longest = std::max({size.x, size.y, size.z});
    const auto step = [&](int along) { return 2 * std::abs(along) < longest ? 0 : along < 0 ? -1 : 1; };
    return {step(way.x), step(way.y), step(way.z)};
  }

  float straight(const glm::ivec3& a, const glm::ivec3& b) const {
    const glm::vec3 way = glm::vec3(b - a) * glm::vec3(volume_.grid.spacing);
    return std::sqrt(glm::dot(way, way));
  }

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  std::vector<glm::i16vec3> corner_;
  std::vector<float> to_corner_;
  std::vector<std::pair<std::int32_t, glm::i16vec3>> front_;
};

}  // namespace limber
