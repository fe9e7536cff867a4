// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/smooth_weights.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {

constexpr double kCell = 0.75;  // upper limit on the edge of a cell (a block of voxels), as a share of the spread width
// Share of its weights that a cell full of tissue exchanges with its neighbours in one step. A larger share would make
// the weights oscillate.
constexpr double kAtOnce = 0.5;
// Upper limit on the share of its weights that a cell exchanges in one step. A cell that would exceed the limit
// exchanges proportionally less with each neighbour. Only cells that are partly air reach this limit.
constexpr float kMostAtOnce = 0.9f;
// A weight of the result that is at most this share of a voxel's full weight is dropped.
constexpr float kNothing = 1e-5f;

glm::ivec3 voxel_in_brick(int cell) { return {cell & 7, cell >> 3 & 7, cell >> 6}; }
int cell_in_brick(const glm::ivec3& v) { return v.x + 8 * v.y + 64 * v.z; }

}  // namespace

SmoothWeights::SmoothWeights(const TissueVoxels& tissue, const glm::dvec3& spacing)
    : tissue_(tissue),
      spacing_(spacing),
      slot_of_(tissue.bricks().size(), kNone) {}

void SmoothWeights::spread(const std::vector<int>& bricks, double width,
                           const std::function<InfluenceView(int)>& weights) {
  for (const int brick : spread_) slot_of_[brick] = kNone;
  spread_ = bricks;
  for (std::size_t slot = 0; slot < bricks.size(); ++slot) slot_of_[bricks[slot]] = static_cast<std::int32_t>(slot);
  choose_cells(width);
  find_cells(bricks);
  sum_weights(bricks, weights);
  if (is_uniform()) return;
  link_cells(bricks);
  take_steps(width);
}

// Chooses the edge length of a cell along each axis, in voxels. It is a power of two, so that each cell lies in one
// brick.
void SmoothWeights::choose_cells(double width) {
  for (int axis = 0; axis < 3; ++axis) {
    edge_[axis] = 1;
    while (edge_[axis] < kBrick && 2 * edge_[axis] * spacing_[axis] <= kCell * width) edge_[axis] *= 2;
  }
}

void SmoothWeights::find_cells(const std::vector<int>& bricks) {
  cell_of_.assign(bricks.size() * kVoxels, kNone);
  voxels_in_.clear();
  for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
    const TissueVoxels::Brick& brick = tissue_.bricks()[bricks[slot]];
    std::int32_t* const cell_of = &cell_of_[slot * kVoxels];
    tissue_.for_each(bricks[slot], bricks[slot] + 1, [&](std::int64_t, const glm::ivec3& v) {
      const glm::ivec3 in = v - brick.corner;
      if (cell_of[cell_in_brick(in)] != kNone) return;
      voxels_in_.push_back(0);
      flood(in, brick, cell_of, static_cast<std::int32_t>(voxels_in_.size()) - 1);
    });
  }
}

// Assigns voxels to the cell `cell`: all voxels of a block of `edge_` voxels that are connected to `voxel` inside the
// block.
void SmoothWeights::flood(const glm::ivec3& voxel, const TissueVoxels::Brick& brick, std::int32_t* cell_of,
                          std::int32_t cell) {
  const glm::ivec3 low = voxel / edge_ * edge_, high = low + edge_ - 1;
  std::array<glm::ivec3, kVoxels> open;
  int count = 0;
  const auto reach = [&](const glm::ivec3& v) {
    cell_of[cell_in_brick(v)] = cell;
    ++voxels_in_[cell];
    open[count++] = v;
  };
  reach(voxel);
  while (count > 0) {
    const glm::ivec3 v = open[--count];
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 w = v;
      const int axis = direction >> 1;
      w[axis] += direction & 1 ? 1 : -1;
      if (w[axis] < low[axis] || w[axis] > high[axis] || cell_of[cell_in_brick(w)] != kNone) continue;
      if (!(brick.mask[w.z] >> (w.x + 8 * w.y) & 1) || is_cut(brick.corner + v, direction)) continue;
      reach(w);
    }
  }
}

// Computes the mean weights of each cell.
void SmoothWeights::sum_weights(const std::vector<int>& bricks, const std::function<InfluenceView(int)>& weights) {
  std::vector<Influence> all;
  std::vector<std::int32_t> cells;
  std::array<Influence, kVoxels> influences;
  std::vector<int> place_of;  // index of each bone in bones_; -1: none
  bones_.clear();
  for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
    const auto count = static_cast<std::size_t>(tissue_.bricks()[bricks[slot]].count());
    weights(bricks[slot]).unpack(count, influences.data());
    all.insert(all.end(), influences.begin(), influences.begin() + std::ptrdiff_t(count));
    tissue_.for_each(bricks[slot], bricks[slot] + 1, [&](std::int64_t, const glm::ivec3& v) {
      cells.push_back(cell_of_[slot * kVoxels + cell_in_brick(v & 7)]);
    });
  }
  for (const Influence& influence : all)
    for (int k = 0; k < 4; ++k) {
      if (influence.weight[k] == 0) continue;
      if (influence.bone[k] >= place_of.size()) place_of.resize(influence.bone[k] + 1, -1);
      if (int& place = place_of[influence.bone[k]]; place < 0) {
        place = static_cast<int>(bones_.size());
        bones_.push_back(influence.bone[k]);
      }
    }
  const std::size_t bones = bones_.size();
  weight_.assign(voxels_in_.size() * bones, 0);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (int k = 0; k < 4; ++k)
      if (all[i].weight[k] > 0) weight_[cells[i] * bones + place_of[all[i].bone[k]]] += all[i].weight[k];
  for (std::size_t cell = 0; cell < voxels_in_.size(); ++cell)
    for (std::size_t b = 0; b < bones; ++b) weight_[cell * bones + b] /= static_cast<float>(voxels_in_[cell]);
}

void SmoothWeights::link_cells(const std::vector<int>& bricks) {
  links_.clear();
  for (std::size_t slot = 0; slot < bricks.size(); ++slot) {
    const glm::ivec3 corner = tissue_.bricks()[bricks[slot]].corner;
    std::array<const std::int32_t*, 6> cells_beside{};
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 there = corner;
      there[direction >> 1] += direction & 1 ? kBrick : -kBrick;
      const bool in_grid =
          glm::all(glm::greaterThanEqual(there, glm::ivec3(0))) && glm::all(glm::lessThan(there, tissue_.grid_size()));
      const int brick = in_grid ? tissue_.brick_at(there) : -1;
      if (brick >= 0 && slot_of_[brick] != kNone)
        cells_beside[direction] = &cell_of_[std::size_t(slot_of_[brick]) * kVoxels];
    }
    const std::int32_t* const cells = &cell_of_[slot * kVoxels];
    for (int i = 0; i < kVoxels; ++i) {
      if (cells[i] == kNone) continue;
      const glm::ivec3 v = voxel_in_brick(i);
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        const int axis = direction >> 1;
        w[axis] += direction & 1 ? 1 : -1;
        const std::int32_t* const there = w[axis] >= 0 && w[axis] < kBrick ? cells : cells_beside[direction];
        const std::int32_t other = there ? there[cell_in_brick(w & 7)] : kNone;
        if (other == kNone || other == cells[i] || is_cut(corner + v, direction)) continue;
        links_.push_back({cells[i], other, direction, 1});
      }
    }
  }
  std::sort(links_.begin(), links_.end(), [](const Link& a, const Link& b) {
    return a.from != b.from ? a.from < b.from : a.direction != b.direction ? a.direction < b.direction : a.to < b.to;
  });
  std::size_t kept = 0;
  for (const Link& link : links_) {
    const auto is_same = [&](const Link& last) {
      return last.from == link.from && last.direction == link.direction && last.to == link.to;
    };
    if (kept > 0 && is_same(links_[kept - 1])) ++links_[kept - 1].faces;
    else links_[kept++] = link;
  }
  links_.resize(kept);
  std::array<std::int32_t, 6> none;
  none.fill(kNone);
  beside_.assign(voxels_in_.size(), none);
  first_link_.assign(voxels_in_.size() + 1, 0);
  std::vector<std::array<int, 6>> most(voxels_in_.size(), std::array<int, 6>{});
  for (const Link& link : links_) {
    ++first_link_[link.from + 1];
    if (link.faces <= most[link.from][link.direction]) continue;
    most[link.from][link.direction] = link.faces;
    beside_[link.from][link.direction] = link.to;
  }
  for (std::size_t cell = 0; cell < voxels_in_.size(); ++cell) first_link_[cell + 1] += first_link_[cell];
}

void SmoothWeights::take_steps(double width) {
  const glm::dvec3 edge = glm::dvec3(edge_) * spacing_;
  // Averaging over cells and interpolating between cells spreads the weights too. The steps only have to add the
  // missing spread.
  glm::dvec3 spread_by_cells(0);
  for (int axis = 0; axis < 3; ++axis)
    if (edge_[axis] > 1) spread_by_cells[axis] = edge[axis] * edge[axis] / 4;
  const double largest = std::max({spread_by_cells.x, spread_by_cells.y, spread_by_cells.z});
  const double time = std::max(width * width - largest, 0.0) / 2;
  const double once = kAtOnce / (2 * (1 / (edge.x * edge.x) + 1 / (edge.y * edge.y) + 1 / (edge.z * edge.z)));
  const int steps = static_cast<int>(std::ceil(time / once));
  if (steps == 0) return;
  const double step = time / steps;

  const glm::dvec3 faces_of_full(double(edge_.y) * edge_.z, double(edge_.x) * edge_.z, double(edge_.x) * edge_.y);
  const double full = double(edge_.x) * edge_.y * edge_.z;
  std::vector<float> rate(links_.size()), all(voxels_in_.size(), 0);
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const Link& link = links_[l];
    const int axis = link.direction >> 1;
    const double joined = link.faces / faces_of_full[axis], holds = voxels_in_[link.from] / full;
    rate[l] = static_cast<float>(step / (edge[axis] * edge[axis]) * joined / holds);
    all[link.from] += rate[l];
  }
  for (std::size_t l = 0; l < links_.size(); ++l)
    if (const float sum = all[links_[l].from]; sum > kMostAtOnce) rate[l] *= kMostAtOnce / sum;

  const std::size_t bones = bones_.size();
  next_.resize(weight_.size());
  for (int s = 0; s < steps; ++s) {
    for (std::size_t cell = 0; cell < voxels_in_.size(); ++cell) {
      float* const next = &next_[cell * bones];
      const float stays = 1 - std::min(all[cell], kMostAtOnce);
      for (std::size_t b = 0; b < bones; ++b) next[b] = stays * weight_[cell * bones + b];
      for (std::int32_t l = first_link_[cell]; l < first_link_[cell + 1]; ++l) {
        const float* const from = &weight_[links_[l].to * bones];
        for (std::size_t b = 0; b < bones; ++b) next[b] += rate[l] * from[b];
      }
    }
    weight_.swap(next_);
  }
}

// Returns the eight cells whose centres surround a point of the cell `cell`. Where there is no such cell, its nearest
// existing neighbour takes its place.
//   towards  0 or 1 along each axis: the side of the cell's centre on which the point lies
std::array<std::int32_t, 8> SmoothWeights::corners_around(std::int32_t cell, const glm::ivec3& towards) const {
  std::array<std::int32_t, 8> corner;
  corner[0] = cell;
  for (int i = 1; i < 8; ++i) {
    corner[i] = kNone;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(i >> axis & 1)) continue;
      const std::int32_t before = corner[i & ~(1 << axis)], found = beside_[before][2 * axis + towards[axis]];
      if (found != kNone) {
        corner[i] = found;
        break;
      }
      corner[i] = before;
    }
  }
  return corner;
}

void SmoothWeights::at(int brick, int cell, WeightSum& sum) const {
  const std::size_t bones = bones_.size();
  const std::int32_t own = cell_of_[std::size_t(slot_of_[brick]) * kVoxels + cell];
  const auto add = [&](std::size_t b, float weight) {
    if (weight > kNothing * kFullWeight) sum.emplace_back(bones_[b], weight);
  };
  if (edge_ == glm::ivec3(1)) {
    for (std::size_t b = 0; b < bones; ++b) add(b, weight_[own * bones + b]);
    return;
  }
  // Offset of the voxel from the centre of its cell, in cell edge lengths.
  const glm::ivec3 in = voxel_in_brick(cell) & (edge_ - 1);
  const glm::vec3 off = (glm::vec3(in) + 0.5f) / glm::vec3(edge_) - 0.5f, share = glm::abs(off);
  const auto corner = corners_around(own, {off.x > 0, off.y > 0, off.z > 0});
  std::array<float, 8> part;
  for (int i = 0; i < 8; ++i)
    part[i] = (i & 1 ? share.x : 1 - share.x) * (i & 2 ? share.y : 1 - share.y) * (i & 4 ? share.z : 1 - share.z);
  for (std::size_t b = 0; b < bones; ++b) {
    float weight = 0;
    for (int i = 0; i < 8; ++i) weight += part[i] * weight_[corner[i] * bones + b];
    add(b, weight);
  }
}

}  // namespace limber
