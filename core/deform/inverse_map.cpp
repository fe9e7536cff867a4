// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/inverse_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/deform/claims.h"
#include "core/volume/label_pages.h"

namespace limber {

namespace {

// A range of the equidistant points on a straight row. Point 0 is the start of the row. The range is empty if first >
// last.
struct Steps {
  int first, last;
};
Steps within(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& point, const glm::dvec3& next) {
  // Points after the first kMost are left out. kSlack is a tolerance for rounding errors, in steps.
  constexpr double kMost = 1 << 20, kSlack = 1e-3;
  double first = 0, last = kMost;
  for (int axis = 0; axis < 3; ++axis) {
    const double step = next[axis] - point[axis];
    if (std::abs(step) < 1e-6) continue;
    const double a = (low[axis] - point[axis]) / step, b = (high[axis] - point[axis]) / step;
    first = std::max(first, std::min(a, b) - kSlack);
    last = std::min(last, std::max(a, b) + kSlack);
  }
  if (first > last) return {1, 0};
  const int whole = static_cast<int>(first);
  return {whole + (whole < first), static_cast<int>(last)};
}

// Returns the posed cell of one voxel of a brick.
//   place  position of the voxel in the brick, 0 to 7 on each axis
PosedCell cell_at(const PosedLattice::Corners& corners, const glm::ivec3& brick_corner, const glm::ivec3& place) {
  return PosedCell(&corners[PosedLattice::place(place.x, place.y, place.z)], PosedLattice::place(0, 1, 0),
                   PosedLattice::place(0, 0, 1), brick_corner + place);
}

// The posed cells of a brick that a pose bends. Neighbouring cells share corners, except near a seam, where each cell
// has its own.
class BentBrick {
 public:
  // Writes the brick's corners into `room`, unless each voxel has its own corners. `room` must outlive this object.
  BentBrick(const PosedLattice& lattice, std::int64_t brick, PosedLattice::Corners& room)
      : lowest_(lattice.tissue().bricks()[brick].corner) {
    if (lattice.is_split(brick))
      lattice.split_corners(brick, *(split_ = std::make_unique_for_overwrite<PosedLattice::SplitBrick>()));
    else shared_ = &lattice.corners(brick, room);
  }
  PosedCell at(const glm::ivec3& voxel) const {
    const glm::ivec3 v = voxel - lowest_;
    if (split_) return PosedCell(&(*split_)[8 * (v.x + 8 * (v.y + 8 * v.z))], 2, 4, voxel);
    return cell_at(*shared_, lowest_, v);
  }

 private:
  glm::ivec3 lowest_;
  std::unique_ptr<PosedLattice::SplitBrick> split_;
  const PosedLattice::Corners* shared_ = nullptr;
};

// A brick whose cells all move as one rigid body. The inverse of their bone's motion gives the cell and the rest point
// directly. Only near a cell's border, where the rounding of corners to fixed point matters, are cells rasterized one
// by one.
class RigidBrick {
 public:
  // Writes the brick's corners into `room` once cells must be rasterized one by one. `room` must outlive this object.
  RigidBrick(const PosedLattice& lattice, std::int64_t brick, PosedLattice::Corners& room)
      : lattice_(lattice),
        brick_(brick),
        room_(room),
        cells_(lattice.tissue().bricks()[brick]),
        rest_from_posed_(lattice.rest_from_posed(lattice.only_bone(brick))) {
    // Rounding a corner to fixed point moves it by at most half of the smallest fixed-point step. The slack is twice
    // this error, converted to rest coordinates, so that it also covers other rounding errors.
    const glm::dmat3& m = rest_from_posed_.linear;
    for (int row = 0; row < 3; ++row)
      slack_ = std::max(slack_, (std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row])) / kFixedOne + 1e-9);
  }

  // Returns true if rounding errors (slack_) are small relative to a cell. They are not small if output voxels are
  // several thousand times larger than the volume's voxels.
  bool is_precise() const { return slack_ < 0.1; }

  // Calls claim(rest voxel, CellClaim) for every voxel of `range` whose centre lies in one of the cells.
  template <class Claim>
  void rasterize(const VoxelRange& range, const Claim& claim) {
    const glm::dvec3 low = glm::dvec3(cells_.corner) - 0.5, step = rest_from_posed_.linear[0],
                     ratio = lattice_.output().ratio;
    const double posed_per_rest = ratio.x * ratio.y * ratio.z;
    for (int z = range.low.z; z <= range.high.z; ++z)
      for (int y = range.low.y; y <= range.high.y; ++y) {
        const glm::dvec3 row = rest_from_posed_ * glm::dvec3(range.low.x, y, z) - low;
        const Steps steps = within(glm::dvec3(-slack_), glm::dvec3(TissueVoxels::kBrick + slack_), row, row + step);
        for (int i = steps.first, last = std::min(steps.last, range.high.x - range.low.x); i <= last; ++i) {
          const glm::ivec3 voxel(range.low.x + i, y, z);
          const glm::dvec3 place = row + double(i) * step;  // position in cells, relative to the brick's lowest corner
          if (std::min({place.x, place.y, place.z}) < -slack_) continue;
          // The conversion rounds positive numbers down; std::floor would be a function call.
          const glm::ivec3 least = glm::ivec3(place + (1 - slack_)) - 1, most(place + slack_);
          if (least != most) ask(least, most, voxel, claim);
          else if (has(most)) claim(cells_.corner + most, CellClaim{voxel, low + place, posed_per_rest});
        }
      }
  }

 private:
  // Rasterizes the cells `least` to `most` for one output voxel. The voxel's centre is so near a border between these
  // cells that only the rounded corners decide which cell contains it.
  template <class Claim>
  void ask(const glm::ivec3& least, const glm::ivec3& most, const glm::ivec3& voxel, const Claim& claim) {
    if (!corners_) corners_ = &lattice_.corners(brick_, room_);
    for (int k = least.z; k <= most.z; ++k)
      for (int j = least.y; j <= most.y; ++j)
        for (int i = least.x; i <= most.x; ++i)
          if (const glm::ivec3 cell(i, j, k); has(cell))
            cell_at(*corners_, cells_.corner, cell).rasterize({voxel, voxel}, [&](const CellClaim& exact) {
              claim(cells_.corner + cell, exact);
            });
  }

  bool has(const glm::ivec3& cell) const {
    return ((cell.x | cell.y | cell.z) & ~7) == 0 && (cells_.mask[cell.z] >> (cell.x + 8 * cell.y) & 1);
  }

  const PosedLattice& lattice_;
  std::int64_t brick_;
  PosedLattice::Corners& room_;
  const TissueVoxels::Brick& cells_;
  const AffineTransform& rest_from_posed_;
  double slack_ = 0;  // width of the zone around a cell's border that rounding can affect, voxels at rest
  const PosedLattice::Corners* corners_ = nullptr;  // the brick's posed corners; null until they are needed
};

// Rasterizes the cells of a brick except those in `without`. If `without` is empty, does nothing and returns false.
bool rasterize_some(const PosedLattice& lattice, std::int64_t brick, const std::array<std::uint64_t, 8>& without,
                    const VoxelRange& range, PosedLattice::Corners& room, Claims& claims) {
  if (std::all_of(without.begin(), without.end(), [](std::uint64_t slice) { return slice == 0; })) return false;
  const TissueVoxels::Brick& cells = lattice.tissue().bricks()[brick];
  if (without == cells.mask) return true;
  const BentBrick bent(lattice, brick, room);
  const Grid& grid = lattice.volume().grid;
  lattice.tissue().for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
    const glm::ivec3 v = voxel - cells.corner;
    if (without[v.z] >> (v.x + 8 * v.y) & 1) return;
    bent.at(voxel).rasterize(range, [&](const CellClaim& cell) {
      claims.claim(static_cast<std::uint32_t>(grid.index(voxel)), voxel, cell);
    });
  });
  return true;
}

VoxelRange voxels_of(const FixedBox& box) { return {(box.low + (kFixedOne - 1)) >> 16, box.high >> 16}; }

}  // namespace

void InverseMap::reset(const VoxelRange& new_range) {
  const glm::ivec3 old_size = range.high - range.low + 1, size = new_range.high - new_range.low + 1;
  const size_t rows = size_t(size.y) * size.z, voxels = size.x * rows;
  range = new_range;
  lost.clear();
  if (has_volume_ratio) posed_per_rest.resize(voxels);
  if (size == old_size && row_used.size() == rows) {
    for (size_t row = 0; row < rows; ++row) {
      if (!row_used[row]) continue;
      std::fill_n(cell.begin() + row * size.x, size.x, kNoCell);
      std::fill_n(bone.begin() + row * size.x, size.x, kNoBone);
      std::fill_n(flags.begin() + row * size.x, size.x, std::uint8_t{0});
      row_used[row] = 0;
    }
    return;
  }
  rest.resize(voxels);
  cell.assign(voxels, kNoCell);
  bone.assign(voxels, kNoBone);
  flags.assign(voxels, 0);
  row_used.assign(rows, 0);
}

void rasterize_cells(InverseMap& map, const PosedLattice& lattice, const std::vector<std::int64_t>& bricks,
                     const std::vector<int>& priority, const TissueDepth* depth, const TissueMask* without) {
  const TissueVoxels& tissue = lattice.tissue();
  const Grid& grid = lattice.volume().grid;
  Claims claims(map, lattice.volume(), priority, depth);
  PosedLattice::Corners room;
  for (std::int64_t brick : bricks) {
    const VoxelRange reach = intersect(voxels_of(lattice.bounds(brick)), map.range);
    if (reach.empty()) continue;
    if (without && rasterize_some(lattice, brick, (*without)[brick], reach, room, claims)) continue;
    if (lattice.is_still(brick)) {
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
        const glm::ivec3 at = voxel - lattice.output().base;
        if (reach.contains(at))
          claims.claim(static_cast<std::uint32_t>(grid.index(voxel)), voxel, {at, glm::dvec3(voxel), 1});
      });
      continue;
    }
    const auto claim = [&](const glm::ivec3& voxel, const CellClaim& cell) {
      claims.claim(static_cast<std::uint32_t>(grid.index(voxel)), voxel, cell);
    };
    if (lattice.only_bone(brick) >= 0)
      if (RigidBrick cells(lattice, brick, room); cells.is_precise()) {
        cells.rasterize(reach, claim);
        continue;
      }
    const BentBrick bent(lattice, brick, room);
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      bent.at(voxel).rasterize(reach, [&](const CellClaim& cell) { claim(voxel, cell); });
    });
  }
}

RigidBones::RigidBones(const PosedLattice& lattice, const SkinWeights& weights, const LabelSet& is_bone,
                       const std::vector<RigidTransform>& posed_from_rest)
    : lattice_(&lattice),
      weights_(&weights),
      is_bone_(&is_bone) {
  const Grid& grid = lattice.volume().grid;
  const AffineTransform world = world_from_voxel(grid), voxel = voxel_from_world(grid);
  auto shift = [&](const RigidTransform& move) {
    const glm::dmat3 turn = glm::mat3_cast(move.rotation) - glm::dmat3(1);
    return AffineTransform{voxel.linear * turn * world.linear, voxel.linear * (turn * world.offset + move.translation)};
  };
  for (const RigidTransform& posed : posed_from_rest) {
    posed_shift_.push_back(shift(posed));
    rest_shift_.push_back(shift(inverse(posed)));
  }
  find_pieces();
}

void RigidBones::find_pieces() {
  const TissueVoxels& tissue = lattice_->tissue();
  const LabelVolume& volume = lattice_->volume();
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    std::map<int, VoxelRange> ranges;
    const auto& chunk = weights_->chunk(brick);
    const std::int64_t first = tissue.bricks()[brick].first;
    tissue.for_each_of(brick, volume, *is_bone_, [&](std::int64_t place, const glm::ivec3& v) {
      const int bone = chunk[place - first].bone[0];
      auto [range, is_new] = ranges.try_emplace(bone, VoxelRange{v, v});
      range->second = {glm::min(range->second.low, v), glm::max(range->second.high, v)};
    });
    for (const auto& [bone, range] : ranges) {
      const VoxelRange reach{range.low - 1, range.high + 1};
      const auto [low, high] = posed_box(bone, range);
      const auto [lowest, highest] = posed_box(bone, reach);
      pieces_.push_back({bone,
                         brick,
                         reach,
                         {glm::ivec3(glm::floor(lowest)), glm::ivec3(glm::ceil(highest))},
                         {glm::ivec3(glm::ceil(low)), glm::ivec3(glm::floor(high))}});
    }
  }
}

// Returns the posed bounding box of a box of voxels.
std::pair<glm::dvec3, glm::dvec3> RigidBones::posed_box(int bone, const VoxelRange& voxels) const {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 rest(i & 1 ? voxels.high.x + 0.5 : voxels.low.x - 0.5,
                          i & 2 ? voxels.high.y + 0.5 : voxels.low.y - 0.5,
                          i & 4 ? voxels.high.z + 0.5 : voxels.low.z - 0.5);
    const glm::dvec3 posed = lattice_->output().from_rest(rest + posed_shift_[bone] * rest);
    low = glm::min(low, posed);
    high = glm::max(high, posed);
  }
  return {low, high};
}

glm::dvec3 RigidBones::rest_point(int bone, const glm::dvec3& posed) const {
  const glm::dvec3 at = lattice_->output().to_rest(posed);
  return at + rest_shift_[bone] * at;
}

double RigidBones::residual(int bone, const glm::dvec3& rest, const glm::dvec3& posed) const {
  const glm::dvec3 off = rest + posed_shift_[bone] * rest - lattice_->output().to_rest(posed);
  return glm::length(off * lattice_->volume().grid.spacing);
}

int RigidBones::owner(const glm::ivec3& voxel) const {
  if (!lattice_->volume().grid.contains(voxel) || !(*is_bone_)[lattice_->volume().at(voxel)]) return -1;
  const TissueVoxels& tissue = lattice_->tissue();
  const int brick = tissue.brick_at(voxel);
  return weights_->chunk(brick)[tissue.index_of(voxel) - tissue.bricks()[brick].first].bone[0];
}

TiledLabels RigidBones::numbered() const {
  const LabelVolume& volume = lattice_->volume();
  TiledLabels result(volume.grid);
  const TissueVoxels& tissue = lattice_->tissue();
  for (std::int64_t last = -1; const Piece& piece : pieces_) {
    if (piece.brick == last) continue;
    last = piece.brick;
    const auto& chunk = weights_->chunk(last);
    const std::int64_t first = tissue.bricks()[last].first;
    tissue.for_each_of(last, volume, *is_bone_, [&](std::int64_t place, const glm::ivec3& v) {
      result.at(v) = static_cast<Label>(chunk[place - first].bone[0] + 1);
    });
  }
  return result;
}

RowSet RigidBones::rest_rows() const {
  const glm::ivec3 size = lattice_->volume().grid.size;
  RowSet rows(std::int64_t{size.y} * size.z);
  for (const Piece& piece : pieces_)
    for (int z = std::max(0, piece.rest.low.z); z <= std::min(size.z - 1, piece.rest.high.z); ++z)
      for (int y = std::max(0, piece.rest.low.y); y <= std::min(size.y - 1, piece.rest.high.y); ++y)
        rows[y + std::int64_t{size.y} * z] = 1;
  return rows;
}

bool RigidBones::has(int bone, const glm::dvec3& rest, const LabelSampler& sampler, bool nearest) const {
  const glm::ivec3 voxel(glm::floor(rest + 0.5));
  const Label label = nearest ? sampler.nearest(rest) : sampler.tissue(rest);
  if (!(*is_bone_)[label]) return false;
  if (const int own = owner(voxel); own >= 0) return own == bone;

  // The rest point's voxel is not bone. If a seam touches this voxel, bone voxels next to it may lie on the other side
  // of the seam, so they do not count.
  if (const Seams* seams = lattice_->tissue().seams();
      seams && lattice_->volume().grid.contains(voxel) && seams->touches(voxel))
    return false;
  // The interpolated label is bone although the voxel that contains the point is not. So the point belongs to the rig
  // bone of the nearest bone voxel among the 26 neighbours.
  double least = INFINITY;
  int found = -1;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const glm::ivec3 v = voxel + glm::ivec3(i, j, k);
        const glm::dvec3 off = (glm::dvec3(v) - rest) * lattice_->volume().grid.spacing;
        const double squared_distance = glm::dot(off, off);
        if (squared_distance >= least) continue;
        if (const int own = owner(v); own >= 0) {
          least = squared_distance;
          found = own;
        }
      }
  return found == bone;
}

void RigidBones::paint(InverseMap& map, const std::vector<std::int64_t>& pieces, const LabelSampler& sampler,
                       bool nearest, const TissueDepth* depth) const {
  for (std::int64_t piece : pieces) {
    const int bone = pieces_[piece].bone;
    const VoxelRange range = intersect(pieces_[piece].posed, map.range);
    const glm::dvec3 low = glm::dvec3(pieces_[piece].rest.low) - 0.5, high = glm::dvec3(pieces_[piece].rest.high) + 0.5;
    for (int z = range.low.z; z <= range.high.z; ++z)
      for (int y = range.low.y; y <= range.high.y; ++y) {
        const auto [first, last] =
            within(low, high, rest_point(bone, {range.low.x, y, z}), rest_point(bone, {range.low.x + 1, y, z}));
        for (int x = range.low.x + first; x <= std::min(range.high.x, range.low.x + last); ++x) {
          const glm::dvec3 rest = rest_point(bone, {x, y, z});
          if (glm::any(glm::lessThan(rest, low)) || glm::any(glm::greaterThan(rest, high))) continue;
          const std::int64_t at = map.index({x, y, z});
          const int holder = map.bone[at];
          if (holder == bone || !has(bone, rest, sampler, nearest)) continue;
          if (holder != InverseMap::kNoBone) {
            map.flags[at] |= InverseMap::kBoneOverlap;
            const double mine = depth ? (*depth)(rest) : 0, theirs = depth ? (*depth)(map.rest[at]) : 0;
            if (mine < theirs || (mine == theirs && bone > holder)) continue;
          }
          map.use_row({x, y, z});
          map.bone[at] = static_cast<std::uint16_t>(bone);
          map.rest[at] = rest;
          if (map.has_volume_ratio) map.posed_per_rest[at] = 1;
        }
      }
  }
}

}  // namespace limber
