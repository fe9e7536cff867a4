// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/deforming_region.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/volume/distance_transform.h"

namespace limber {

namespace {

constexpr int kCell = 4;  // edge of a cell (cube of voxels that deform or move rigidly together), voxels
// A voxel counts as moving rigidly if bones with one common motion have at least this share of its weight.
constexpr double kWhole = 0.98;
// Contact is tested at no more than this many positions between two given positions of the path.
constexpr int kMostBetween = 32;
// Number of straight pieces by which the length of a cell's way between two given positions is estimated.
constexpr int kChords = 8;
// An object that is still not clear of the body when it is this far from its target position counts as blocked, mm.
constexpr double kLongestWay = 1000;

bool alike(const RigidTransform& a, const RigidTransform& b) {
  const double turn = std::abs(glm::dot(a.rotation, b.rotation));
  return turn > 1 - 1e-14 && glm::length(a.translation - b.translation) < 1e-6;
}

std::vector<int> first_alike_on_path(const BonePath& path, const std::vector<double>& places) {
  std::vector<std::vector<RigidTransform>> ways;
  for (double t : places) ways.push_back(path(t));
  std::vector<int> first(ways[0].size());
  for (int i = 0; i < std::ssize(first); ++i) {
    first[i] = i;
    for (int k = 0; k < i && first[i] == i; ++k)
      if (first[k] == k &&
          std::all_of(ways.begin(), ways.end(), [&](const auto& motions) { return alike(motions[i], motions[k]); }))
        first[i] = k;
  }
  return first;
}

// The motion that has the largest share of a voxel's weight (as the index of the first bone with this motion), and that
// share, [0, 1].
struct Main {
  int motion;
  double share;
};
Main main_motion(const Influence& influence, const std::vector<int>& moves_as) {
  if (influence.weight[0] == kFullWeight) return {moves_as[influence.bone[0]], 1};
  std::array<std::pair<int, int>, 4> sums{};
  int count = 0;
  for (int i = 0; i < 4 && influence.weight[i]; ++i) {
    const int motion = moves_as[influence.bone[i]];
    int at = 0;
    while (at < count && sums[at].first != motion) ++at;
    if (at == count) sums[count++] = {motion, 0};
    sums[at].second += influence.weight[i];
  }
  const auto best = std::max_element(sums.begin(), sums.begin() + count,
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return {best->first, best->second / double(kFullWeight)};
}

bool has_any(const std::vector<std::uint8_t>& set) {
  return std::any_of(set.begin(), set.end(), [](std::uint8_t in) { return in != 0; });
}

// The grid of cells (cubes of 4^3 voxels) that covers all tissue, with a border one cell wide.
class Cells {
 public:
  Cells(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
        const std::vector<int>& moves_as)
      : grid_(volume.grid),
        tissue_(tissue) {
    box_.lowest = glm::ivec3(-1);
    box_.size = tissue.brick_grid() * (TissueVoxels::kBrick / kCell) + 2;
    motion_.assign(box_.voxel_count(), kAir);
    mixed_.assign(box_.voxel_count(), 0);
    for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
      auto influence = weights.chunk(brick).begin();
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
        const Main main = main_motion(*influence++, moves_as);
        const std::int64_t at = box_.index(v / kCell);
        if (motion_[at] == kAir) motion_[at] = main.motion;
        if (main.share < kWhole || motion_[at] != main.motion) mixed_[at] = 1;
      });
    }
    mark_borders();
  }

  const std::vector<std::uint8_t>& mixed() const { return mixed_; }
  glm::dvec3 spacing() const { return grid_.spacing * double(kCell); }

  // Returns the squared distance of each cell to the nearest cell of the set `seeds`, mm2.
  std::vector<float> squared_distance_to(const std::vector<std::uint8_t>& seeds, Progress& progress) const {
    return squared_distance(box_, seeds, spacing(), progress);
  }

  // Finds the cells that the pose brings near to other cells that were far away at rest and move with another bone.
  // Tests the path positions `places` in order. At each position places[k] that brings further cells near, calls
  // visit(k, cells), where `cells` marks these cells.
  template <class Visit>
  void brought_near(const BonePath& path, const std::vector<double>& places, double near_mm, const Visit& visit) const {
    std::vector<std::uint8_t> before(box_.voxel_count(), 0), near;
    const AffineTransform world = world_from_voxel(grid_);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto motions = path(places[k]);
      near.assign(box_.voxel_count(), 0);
      std::unordered_map<std::uint64_t, Bin> bins;
      for_each_cell([&](const glm::ivec3& cell, std::int64_t at) {
        if (motion_[at] == kAir) return;
        const glm::dvec3 rest = world * ((glm::dvec3(cell) + 0.5) * double(kCell) - 0.5),
                         posed = motions[motion_[at]] * rest;
        const glm::ivec3 place(glm::floor(posed / near_mm));
        Bin& bin = bins.try_emplace(key(place), Bin{place, motion_[at], {}}).first->second;
        if (bin.motion != motion_[at]) bin.motion = kSeveral;
        bin.cells.push_back({at, rest, posed});
      });
      // Two cells that are closer at rest than this (mm) belong to one limb, so they never count as brought near.
      const double far = 3 * std::max({near_mm, spacing().x, spacing().y, spacing().z});
      for (const auto& [own_key, bin] : bins)
        for (int i = 0; i < 27; ++i) {
          const auto found = bins.find(key(bin.place + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1));
          if (found == bins.end() || (bin.motion != kSeveral && found->second.motion == bin.motion)) continue;
          for (const Placed& mine : bin.cells)
            near[mine.at] =
                near[mine.at] ||
                (!before[mine.at] &&
                 std::any_of(found->second.cells.begin(), found->second.cells.end(), [&](const Placed& other) {
                   return motion_[other.at] != motion_[mine.at] && glm::distance(mine.posed, other.posed) < near_mm &&
                          glm::distance(mine.rest, other.rest) > far;
                 }));
        }
      if (!has_any(near)) continue;
      visit(k, near);
      for (std::size_t at = 0; at < near.size(); ++at) before[at] |= near[at];
    }
  }

  // Returns the positions on the path at which contact is tested: the given `places`, and so many between them that no
  // cell moves further than near_mm from one to the next, as far as kMostBetween allows. Otherwise parts could pass
  // each other unnoticed.
  std::vector<double> tested_places(const BonePath& path, const std::vector<double>& places, double near_mm) const {
    // The bounding box of each motion's cells at rest, mm.
    std::unordered_map<int, std::pair<glm::dvec3, glm::dvec3>> boxes;
    const AffineTransform world = world_from_voxel(grid_);
    for_each_cell([&](const glm::ivec3& cell, std::int64_t at) {
      if (motion_[at] == kAir) return;
      const glm::dvec3 rest = world * ((glm::dvec3(cell) + 0.5) * double(kCell) - 0.5);
      auto& [low, high] = boxes.try_emplace(motion_[at], rest, rest).first->second;
      low = glm::min(low, rest);
      high = glm::max(high, rest);
    });
    std::vector<double> tested;
    double from = 0;
    for (const double to : places) {
      double mm = 0;  // length of the longest way of a cell from one place to the next
      auto before = path(from);
      for (int chord = 1; chord <= kChords; ++chord) {
        auto after = path(from + (to - from) * chord / kChords);
        double furthest = 0;
        for (const auto& [motion, box] : boxes)
          for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 p(corner & 1 ? box.first.x : box.second.x, corner & 2 ? box.first.y : box.second.y,
                               corner & 4 ? box.first.z : box.second.z);
            furthest = std::max(furthest, glm::distance(before[motion] * p, after[motion] * p));
          }
        mm += furthest;
        before.swap(after);
      }
      const int parts = std::clamp(int(std::ceil(mm / near_mm)), 1, kMostBetween);
      for (int part = 1; part < parts; ++part) tested.push_back(from + (to - from) * part / parts);
      tested.push_back(to);
      from = to;
    }
    return tested;
  }

  // Finds the direction in which an object leaves the body after the shortest distance. The body is posed by `motions`.
  // Marks the cells within near_mm of the object's surface along this way in `pressed`.
  ObjectClearance in_way(const std::vector<RigidTransform>& motions, const ObjectSweep& sweep, double near_mm,
                         std::vector<std::uint8_t>& pressed) const {
    const AffineTransform world = world_from_voxel(grid_);
    std::unordered_map<std::uint64_t, Bin> bins;
    glm::dvec3 low(INFINITY), high(-INFINITY);  // bounding box of the posed cells' centres, mm
    for_each_cell([&](const glm::ivec3& cell, std::int64_t at) {
      if (motion_[at] == kAir) return;
      const glm::dvec3 rest = world * ((glm::dvec3(cell) + 0.5) * double(kCell) - 0.5),
                       posed = motions[motion_[at]] * rest;
      low = glm::min(low, posed);
      high = glm::max(high, posed);
      const glm::ivec3 place(glm::floor(posed / near_mm));
      bins.try_emplace(key(place), Bin{place, motion_[at], {}}).first->second.cells.push_back({at, rest, posed});
    });
    // Calls visit(cell) for the cells near the object when it is `away` mm from its target position. Returns false if
    // there are none.
    const auto visit_near = [&](const std::vector<glm::dvec3>& way, double away, const auto& visit) {
      bool any = false;
      for (std::size_t p = 0; p < sweep.point.size(); ++p) {
        const glm::dvec3 point = sweep.point[p] + away * way[p];
        if (glm::any(glm::lessThan(point, low - near_mm)) || glm::any(glm::greaterThan(point, high + near_mm)))
          continue;
        const glm::ivec3 place(glm::floor(point / near_mm));
        for (int i = 0; i < 27; ++i) {
          const auto found = bins.find(key(place + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1));
          if (found == bins.end()) continue;
          for (const Placed& cell : found->second.cells)
            if (glm::distance(cell.posed, point) < near_mm) {
              any = true;
              if (!visit(cell.at)) return true;
            }
        }
      }
      return any;
    };
    ObjectClearance soonest{0, INFINITY, false};
    for (std::size_t w = 0; w < sweep.ways.size(); ++w) {
      double away = 0;
      while (away < std::min(soonest.mm, kLongestWay) &&
             visit_near(sweep.ways[w], away, [](std::int64_t) { return false; }))
        away += near_mm / 2;
      if (away < std::min(soonest.mm, kLongestWay)) soonest = {w, away};
    }
    if (soonest.mm < INFINITY)
      for (double away = -sweep.deepest_mm; away < soonest.mm; away += near_mm / 2)
        visit_near(sweep.ways[soonest.way], away, [&](std::int64_t at) { return pressed[at] = 1, true; });
    return soonest;
  }

  // Returns value(cell) for the 8 cells of each brick (cube of 8^3 voxels).
  template <class Value>
  std::vector<std::array<float, 8>> by_brick(const Value& value) const {
    std::vector<std::array<float, 8>> values(tissue_.bricks().size());
    for (size_t b = 0; b < values.size(); ++b)
      for (int c = 0; c < 8; ++c)
        values[b][c] = value(box_.index(tissue_.bricks()[b].corner / kCell + glm::ivec3(c & 1, c >> 1 & 1, c >> 2)));
    return values;
  }

  // Returns the mask of the tissue voxels in the cells for which passes() is true.
  template <class Passes>
  TissueMask mask(const Passes& passes) const {
    TissueMask mask(tissue_.bricks().size(), std::array<std::uint64_t, 8>{});
    for (size_t b = 0; b < mask.size(); ++b) {
      const TissueVoxels::Brick& brick = tissue_.bricks()[b];
      for (int c = 0; c < 8; ++c) {
        const glm::ivec3 step(c & 1, c >> 1 & 1, c >> 2);
        if (!passes(box_.index(brick.corner / kCell + step))) continue;
        const std::uint64_t columns = 0x0f0f0f0fULL << (kCell * step.x + 8 * kCell * step.y);
        for (int z = 0; z < kCell; ++z) mask[b][kCell * step.z + z] |= brick.mask[kCell * step.z + z] & columns;
      }
    }
    return mask;
  }

 private:
  static constexpr int kAir = -1, kSeveral = -2;
  struct Placed {
    std::int64_t at;
    glm::dvec3 rest, posed;
  };
  struct Bin {
    glm::ivec3 place;
    int motion;  // index of the motion that all cells in the bin follow; kSeveral: different motions
    std::vector<Placed> cells;
  };

  static std::uint64_t key(const glm::ivec3& bin) {
    const auto part = [](int v) { return std::uint64_t(v + (1 << 20)) & 0x1fffff; };
    return part(bin.x) | part(bin.y) << 21 | part(bin.z) << 42;
  }

  template <class Body>
  void for_each_cell(const Body& body) const {
    for (int z = 0; z < box_.size.z; ++z)
      for (int y = 0; y < box_.size.y; ++y)
        for (int x = 0; x < box_.size.x; ++x) {
          const glm::ivec3 cell = box_.lowest + glm::ivec3(x, y, z);
          body(cell, box_.index(cell));
        }
  }

  // Marks neighbouring cells that follow different motions as bending, even if every voxel in them follows one motion
  // with full weight.
  void mark_borders() {
    for_each_cell([&](const glm::ivec3& cell, std::int64_t at) {
      if (motion_[at] == kAir) return;
      for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 next = cell;
        ++next[axis];
        const std::int64_t there = box_.index(next);
        if (motion_[there] != kAir && motion_[there] != motion_[at]) mixed_[at] = mixed_[there] = 1;
      }
    });
  }

  const Grid& grid_;
  const TissueVoxels& tissue_;
  VoxelBox box_;
  std::vector<int> motion_;
  std::vector<std::uint8_t> mixed_;
};

}  // namespace

bool DeformingRegion::empty() const {
  return std::all_of(free.begin(), free.end(),
                     [](const auto& brick) { return brick == std::array<std::uint64_t, 8>{}; });
}

float DeformingRegion::free_from_at(const TissueVoxels& tissue, const glm::ivec3& voxel) const {
  const glm::ivec3 cell = (voxel & (TissueVoxels::kBrick - 1)) / kCell;
  return free_from[tissue.brick_at(voxel)][cell.x + 2 * cell.y + 4 * cell.z];
}

DeformingRegion moving_tissue(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                              const BonePath& path, const MovingSettings& settings, Progress& progress) {
  DeformingRegion result;
  result.moves_as = first_alike_on_path(path, settings.places);
  const Cells cells(volume, tissue, weights, result.moves_as);
  const std::vector<float> to_bending = cells.squared_distance_to(cells.mixed(), progress);
  const auto squared = [](double mm) { return float(mm * mm); };
  // Two cells that are near each other at a tested path position may have touched since the previous tested position.
  // So their tissue may deform (is free) from the previous position on.
  std::vector<float> to_near(to_bending.size(), INFINITY), free_from(to_bending.size(), INFINITY);
  for (std::size_t at = 0; at < free_from.size(); ++at)
    if (to_bending[at] <= squared(settings.margin_mm)) free_from[at] = 0;
  if (settings.contact && has_any(cells.mixed())) {
    const std::vector<double> places = cells.tested_places(path, settings.places, settings.near_mm);
    cells.brought_near(path, places, settings.near_mm, [&](std::size_t k, const std::vector<std::uint8_t>& near) {
      const std::vector<float> distance = cells.squared_distance_to(near, progress);
      for (std::size_t at = 0; at < distance.size(); ++at) {
        to_near[at] = std::min(to_near[at], distance[at]);
        if (distance[at] <= squared(settings.give_mm))
          free_from[at] = std::min(free_from[at], k ? float(places[k - 1]) : 0.0f);
      }
    });
  }
  for (const ObjectSweep& sweep : settings.sweeps)
    for (std::size_t k = 0; k < settings.pressed_at.size(); ++k) {
      std::vector<std::uint8_t> pressed(to_bending.size(), 0);
      const ObjectClearance clearance = cells.in_way(path(settings.pressed_at[k]), sweep, settings.near_mm, pressed);
      if (k == 0) result.clearances.push_back(clearance);
      if (!has_any(pressed)) continue;
      result.clearances.back().presses = true;
      const std::vector<float> distance = cells.squared_distance_to(pressed, progress);
      for (std::size_t at = 0; at < distance.size(); ++at) {
        to_near[at] = std::min(to_near[at], distance[at]);
        if (distance[at] <= squared(settings.give_mm)) free_from[at] = 0;
      }
    }
  result.free = cells.mask([&](std::int64_t at) { return free_from[at] < INFINITY; });
  result.free_from = cells.by_brick([&](std::int64_t at) { return free_from[at]; });
  result.meshed = cells.mask([&](std::int64_t at) {
    return to_bending[at] <= squared(settings.margin_mm + settings.rim_mm) ||
           to_near[at] <= squared(settings.give_mm + settings.rim_mm);
  });
  return result;
}

SkinWeights with_rigid_rest(const SkinWeights& weights, const TissueVoxels& tissue, const DeformingRegion& moving) {
  SkinWeights rigid = weights;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    const TissueVoxels::Brick& cells = tissue.bricks()[brick];
    if (moving.free[brick] == cells.mask) continue;
    SkinWeights::Influences chunk = weights.chunk(brick);
    auto influence = chunk.begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - cells.corner;
      Influence& mine = *influence++;
      const bool is_whole = mine.weight[0] == kFullWeight;
      if (!is_whole && !(moving.free[brick][v.z] >> (v.x + 8 * v.y) & 1))
        mine = rigid_influence(main_motion(mine, moving.moves_as).motion);
    });
    rigid.set_chunk(brick, std::move(chunk));
  }
  return rigid;
}

}  // namespace limber
