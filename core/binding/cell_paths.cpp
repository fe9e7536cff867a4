// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/cell_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"

namespace limber {

namespace {
// The cells are divided into at most kMostDomains fixed domains; a domain contains the cells of a range of at least
// kLeastBricks bricks. Threads advance the fronts of different domains at the same time, by one step of path length.
// Paths from one domain into another are sent and accepted in a fixed order, so that the result does not depend on the
// number of threads.
constexpr std::int64_t kLeastBricks = 256, kMostDomains = 64;
// Width of a bucket of path lengths, as a share of the shortest edge of a cell. Paths in one bucket may be advanced in
// any order.
constexpr double kWidth = 0.5;

class CellFront {
 public:
  CellFront(const Grid& grid, const TissueVoxels& tissue, const HeatCells& cells, const std::vector<BoneReach>& reaches)
      : tissue_(tissue),
        cells_(cells),
        reaches_(reaches),
        spacing_(grid.spacing),
        width_(static_cast<float>(kWidth *
                                  std::min({cells.graph.spacing.x, cells.graph.spacing.y, cells.graph.spacing.z}))),
        samples_(1 << std::max({cells.shift.x, cells.shift.y, cells.shift.z})),
        paths_(cells.graph.size()),
        domain_of_(cells.graph.size()) {
    const auto bricks = std::ssize(tissue.bricks());
    domains_.resize(std::clamp<std::int64_t>(bricks / kLeastBricks, 1, kMostDomains));
    for (Domain& domain : domains_) domain.sent.resize(domains_.size());
    if (tissue.seams())
      for (const auto& brick : tissue.bricks()) near_seam_.push_back(tissue.seams()->is_near_brick(brick.corner));
  }

  std::vector<CellPath> run() {
    start();
    for (std::size_t bucket = 0; bucket < bucket_count(); ++bucket) {
      for (auto waiting = domains_waiting(bucket); !waiting.empty(); waiting = domains_waiting(bucket)) {
        parallel_for(std::ssize(waiting), 1, [&](std::int64_t begin, std::int64_t end) {
          for (std::int64_t k = begin; k < end; ++k) advance(*waiting[k], bucket);
        });
        parallel_for(std::ssize(domains_), 1, [&](std::int64_t begin, std::int64_t end) {
          for (std::int64_t to = begin; to < end; ++to)
            for (Domain* from : waiting) {
              for (const Step& step : from->sent[to]) accept(step, domains_[to], bucket);
              from->sent[to].clear();
            }
        });
      }
      for (Domain& domain : domains_) {
        domain.done = 0;
        if (bucket < domain.buckets.size()) domain.buckets[bucket] = {};
      }
    }
    return std::move(paths_);
  }

 private:
  struct Reached {
    std::int32_t cell;
    float length;  // length of the path, mm
  };
  struct Step {
    std::int32_t to;
    CellPath path;
  };
  struct Domain {
    std::vector<std::vector<Reached>> buckets;  // reached cells, in one bucket per range of path lengths
    std::size_t done = 0;                       // number of finished entries of the current bucket
    std::vector<std::vector<Step>> sent;        // steps that lead into other domains, by domain
  };

  // Starts a path at each side of a cell that touches a bone.
  void start() {
    const auto bricks = std::ssize(tissue_.bricks()), domains = std::ssize(domains_);
    parallel_for(domains, 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t d = begin; d < end; ++d)
        for (int colour = 0; colour < 2; ++colour) {
          const std::int32_t from = cells_.first[(d * bricks + domains - 1) / domains][colour],
                             to = cells_.first[((d + 1) * bricks + domains - 1) / domains][colour];
          std::fill(domain_of_.begin() + from, domain_of_.begin() + to, static_cast<std::uint8_t>(d));
          for (std::int32_t s = cells_.side_from[from]; s < cells_.side_from[to]; ++s) {
            const HeldSide& side = cells_.sides[s];
            CellPath path{glm::vec3(side.nearest), 0, 0, side.bone};
            path.length = path.to(cells_.centre[side.cell], spacing_);
            accept({side.cell, path}, domains_[d], 0);
          }
        }
    });
  }

  bool is_shorter(std::uint16_t bone, float length, std::int32_t to) const {
    const CellPath& known = paths_[to];
    return known.bone == kSoft || reaches_[bone](length) < reaches_[known.bone](known.length);
  }

  void advance(Domain& domain, std::size_t bucket) {
    const CellGraph& graph = cells_.graph;
    for (; domain.done < domain.buckets[bucket].size(); ++domain.done) {
      const auto [cell, length] = domain.buckets[bucket][domain.done];
      const CellPath here = paths_[cell];
      if (length > here.length) continue;  // a shorter path to this cell was found later
      for (std::int32_t k = graph.first[cell]; k < graph.first[cell + 1]; ++k) {
        const std::int32_t to = graph.neighbour[k];
        const bool is_own = &domains_[domain_of_[to]] == &domain;
        CellPath path = here;
        path.length = here.to(cells_.centre[to], spacing_);
        // The length of the straight path is a lower limit: a path that must bend is longer.
        if (is_own && !is_shorter(here.bone, path.length, to)) continue;
        if (!is_straight(here.corner, cells_.centre[to])) {
          path.corner = cells_.centre[cell];
          path.to_corner = here.length;
          path.length = path.to(cells_.centre[to], spacing_);
        }
        if (is_own) accept({to, path}, domain, bucket);
        else domain.sent[domain_of_[to]].push_back({to, path});
      }
    }
  }

  // Returns true if the last part of the straight line from `corner` to `centre`, one cell long, runs through tissue
  // and touches no seam.
  bool is_straight(const glm::vec3& corner, const glm::vec3& centre) const {
    const glm::vec3 way = corner - centre, size = glm::abs(way);
    const float longest = std::max({size.x, size.y, size.z});
    const glm::vec3 step = way / longest;
    for (int k = 1; k <= samples_ && static_cast<float>(k) < longest; ++k) {
      const glm::ivec3 voxel(glm::floor(centre + static_cast<float>(k) * step + 0.5f));
      const int brick = tissue_.brick_at(voxel);
      if (brick < 0 || !tissue_.holds(voxel)) return false;
      if (!near_seam_.empty() && near_seam_[brick] && tissue_.seams()->touches(voxel)) return false;
    }
    return true;
  }

  void accept(const Step& step, Domain& domain, std::size_t present) {
    if (!is_shorter(step.path.bone, step.path.length, step.to)) return;
    paths_[step.to] = step.path;
    const std::size_t bucket = std::max(present, static_cast<std::size_t>(step.path.length / width_));
    if (bucket >= domain.buckets.size()) domain.buckets.resize(bucket + 1);
    domain.buckets[bucket].push_back({step.to, step.path.length});
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

  const TissueVoxels& tissue_;
  const HeatCells& cells_;
  const std::vector<BoneReach>& reaches_;
  const glm::vec3 spacing_;
  const float width_;
  const int samples_;  // number of voxels of a straight line that are examined: the longest edge of a block
  std::vector<CellPath> paths_;
  std::vector<std::uint8_t> domain_of_;  // domain of each cell
  std::vector<bool> near_seam_;          // whether a seam is near each brick; empty: the volume has no seams
  std::vector<Domain> domains_;
};
}  // namespace

std::vector<CellPath> paths_to_cells(const Grid& grid, const TissueVoxels& tissue, const HeatCells& cells,
                                     const std::vector<BoneReach>& reaches) {
  return CellFront(grid, tissue, cells, reaches).run();
}

void PathsToVoxels::list(std::int32_t cell, std::vector<CellPath>& found) const {
  found.clear();
  const CellPath& own = paths_[cell];
  if (own.bone == kSoft) return;
  found.push_back(own);
  for (std::int32_t s = cells_.side_from[cell]; s < cells_.side_from[cell + 1]; ++s)
    found.push_back({glm::vec3(cells_.sides[s].nearest), 0, 0, cells_.sides[s].bone});
  const CellGraph& graph = cells_.graph;
  for (std::int32_t k = graph.first[cell]; k < graph.first[cell + 1]; ++k)
    if (const CellPath& path = paths_[graph.neighbour[k]]; path.bone != own.bone && path.bone != kSoft)
      found.push_back(path);
}

PathsToVoxels::Nearest PathsToVoxels::nearest(const std::vector<CellPath>& listed, const glm::ivec3& voxel) const {
  Nearest nearest{kSoft, std::numeric_limits<float>::infinity()};
  for (const CellPath& path : listed)
    if (const float distance = reaches_[path.bone](path.to(glm::vec3(voxel), spacing_)); distance < nearest.distance)
      nearest = {path.bone, distance};
  nearest.distance = reaches_[nearest.bone].held_from(nearest.distance);
  nearest.bone = hinges_.bone_at(glm::vec3(world_ * glm::dvec3(voxel)), nearest.bone, nearest.distance);
  return nearest;
}

}  // namespace limber
