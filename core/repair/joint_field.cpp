// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/joint_field.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/deform/cell_nodes.h"
#include "core/volume/distance_transform.h"

namespace limber {

namespace {

// Wanted edge length of a cell, mm: a blend over 20 mm then spans two cells.
constexpr double kCellEdge = 8;
// Distance from a bone, mm, over which the mask rises from 0 to 1, so that soft tissue near bone keeps the bone's
// weights, as heat weights do.
constexpr double kBoneFade = 8;
// Distances from the joint, as shares of a bone's length, at which the mask begins to fall and at which it becomes 0.
constexpr double kReachBegin = 0.6, kReachEnd = 0.95;
// In a voxel, the mask rises from 0 to 1 as the weight of the joint's own bones and their neighbours rises from
// kOtherPart to kOwnPart.
constexpr double kOtherPart = 0.3, kOwnPart = 0.8;
constexpr int kGrain = 16;  // bricks per block of a parallel loop

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

glm::ivec3 corner_of(int i) { return {i & 1, i >> 1 & 1, i >> 2}; }

// Returns the distances, mm, up to which the field may reach along the parent bone and along the moving bone. If one
// bone is much shorter than the other, such as a collarbone, half of the other's length counts instead.
std::array<double, 2> reach_of(const Armature& armature, int bone) {
  const Bone& child = armature.bones[bone];
  const double below = glm::distance(child.head, child.tail),
               above = glm::distance(child.head, armature.bones[child.parent].head);
  return {std::max(above, below / 2), std::max(below, above / 2)};
}

}  // namespace

JointField::JointField(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion,
                       Progress& progress) {
  progress.update("joint", 0);
  find_shares(body, weights, motion);
  fade_by_bone(body, progress);
  make_cells(body, weights, motion);
  if (pieces_.empty())
    throw Error("no soft tissue moves at this joint", body.armature.bones[motion.bone].name,
                "choose another bone, or compute weights first");
  make_shapes(body);
  find_initial(body);
  find_rows();
}

void JointField::find_shares(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion) {
  std::vector<std::uint8_t> moves(body.armature.bones.size(), 0), near(moves);
  for (const int b : motion.moving) moves[b] = near[b] = 1;
  const int parent = body.armature.bones[motion.bone].parent;
  near[parent] = 1;
  if (body.armature.bones[parent].parent >= 0) near[body.armature.bones[parent].parent] = 1;
  const std::array<double, 2> reach = reach_of(body.armature, motion.bone);
  const AffineTransform world = world_from_voxel(body.volume.grid);
  share_.assign(body.tissue.size(), 0);
  mask_.assign(body.tissue.size(), 0);
  parallel_for(std::ssize(body.tissue.bricks()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick) {
      auto influence = weights.chunk(brick).begin();
      body.tissue.for_each(brick, brick + 1, [&](std::int64_t index, const glm::ivec3& voxel) {
        const Influence mine = *influence++;
        int moving = 0, own = 0;
        for (int i = 0; i < 4; ++i) {
          if (moves[mine.bone[i]]) moving += mine.weight[i];
          if (near[mine.bone[i]]) own += mine.weight[i];
        }
        const double share = double(moving) / kFullWeight,
                     away = glm::distance(world * glm::dvec3(voxel), motion.centre),
                     most = reach[0] + (reach[1] - reach[0]) * share;
        share_[index] = static_cast<float>(share);
        mask_[index] = static_cast<float>((1 - smoothstep(kReachBegin * most, kReachEnd * most, away)) *
                                          smoothstep(kOtherPart, kOwnPart, double(own) / kFullWeight));
      });
    }
  });
}

void JointField::fade_by_bone(const WeightedBody& body, Progress& progress) {
  glm::ivec3 low(body.volume.grid.size), high(-1);
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    if (mask_[index] > 0) low = glm::min(low, voxel), high = glm::max(high, voxel);
  });
  if (high.x < 0) return;
  const glm::dvec3& spacing = body.volume.grid.spacing;
  const glm::ivec3 margin(glm::ceil(kBoneFade / spacing));
  low = glm::max(low - margin, glm::ivec3(0));
  high = glm::min(high + margin, body.volume.grid.size - 1);
  const VoxelBox box{low, high - low + 1};
  const std::vector<TissueKind> kinds = body.tissues.kinds();
  std::vector<std::uint8_t> seed(box.voxel_count(), 0);
  bool any = false;
  body.tissue.for_each([&](std::int64_t, const glm::ivec3& voxel) {
    if (box.contains(voxel) && is_bone(kinds[body.volume.at(voxel)])) seed[box.index(voxel)] = 1, any = true;
  });
  if (!any) return;
  const std::vector<float> squared = squared_distance(box, seed, spacing, progress);
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    if (mask_[index] > 0)
      mask_[index] *= static_cast<float>(smoothstep(0, kBoneFade, std::sqrt(double(squared[box.index(voxel)]))));
  });
}

void JointField::make_cells(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion) {
  const Grid& grid = body.volume.grid;
  const double finest = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  step_ = 2;
  while (step_ < TissueVoxels::kBrick && step_ * finest * 1.5 < kCellEdge) step_ *= 2;
  cell_edge_ = step_ * (grid.spacing.x + grid.spacing.y + grid.spacing.z) / 3;
  std::vector<std::int64_t> bricks;
  for (std::int64_t b = 0; b < std::ssize(body.tissue.bricks()); ++b) {
    const auto& brick = body.tissue.bricks()[b];
    const auto first = mask_.begin() + brick.first;
    if (std::any_of(first, first + brick.count(), [](float mask) { return mask > 0; })) bricks.push_back(b);
  }
  const std::vector<CellPiece> pieces = cell_pieces(body.tissue, weights, step_, grid.spacing, bricks);
  const CellNodes nodes = number_nodes(pieces, grid.size, step_);
  pieces_ = nodes.of_piece;
  node_position_.resize(nodes.count);
  piece_of_.assign(body.tissue.size(), -1);
  const AffineTransform world = world_from_voxel(grid);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const glm::ivec3 lowest = pieces[p].cell * step_;
    for (int i = 0; i < 8; ++i)
      node_position_[pieces_[p][i]] = world * (glm::dvec3(lowest + corner_of(i) * step_) - 0.5) - motion.centre;
    for (int z = 0; z < 8; ++z)
      for (std::uint64_t bits = pieces[p].voxels[z]; bits; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        piece_of_[body.tissue.index_of(lowest + glm::ivec3(bit & 7, bit >> 3, z))] = static_cast<std::int32_t>(p);
      }
  }
}

void JointField::make_shapes(const WeightedBody& body) {
  const glm::dmat3 world = world_from_voxel(body.volume.grid).linear;
  // Columns: gradient of each voxel coordinate in world axes, 1 / mm.
  const glm::dmat3 slopes = glm::transpose(glm::inverse(world));
  shapes_.resize(512);
  for (int z = 0; z < step_; ++z)
    for (int y = 0; y < step_; ++y)
      for (int x = 0; x < step_; ++x) {
        Shape& shape = shapes_[x + 8 * y + 64 * z];
        const glm::dvec3 t = (glm::dvec3(x, y, z) + 0.5) / double(step_);
        for (int i = 0; i < 8; ++i) {
          glm::dvec3 each, rise;
          for (int axis = 0; axis < 3; ++axis) {
            const bool upper = i >> axis & 1;
            each[axis] = upper ? t[axis] : 1 - t[axis];
            rise[axis] = (upper ? 1.0 : -1.0) / step_;
          }
          shape.weight[i] = static_cast<float>(each.x * each.y * each.z);
          shape.slope[i] = glm::vec3(
              slopes * glm::dvec3(rise.x * each.y * each.z, each.x * rise.y * each.z, each.x * each.y * rise.z));
        }
      }
}

void JointField::find_initial(const WeightedBody& body) {
  std::vector<double> sum(node_count(), 0), weight(node_count(), 1e-9);
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    const FieldPoint point = this->point(index, voxel);
    if (point.piece < 0) return;
    for (int i = 0; i < 8; ++i) {
      const double share = shapes_[point.place].weight[i] * (0.01 + point.mask);
      sum[pieces_[point.piece][i]] += share * share_[index];
      weight[pieces_[point.piece][i]] += share;
    }
  });
  initial_.resize(node_count());
  for (std::int64_t n = 0; n < node_count(); ++n) initial_[n] = std::clamp(sum[n] / weight[n], 0.0, 1.0);
}

void JointField::find_rows() {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::int32_t> lower(node_count(), -1), upper(node_count(), -1);
    for (const auto& piece : pieces_)
      for (int i = 0; i < 8; ++i) {
        if (i >> axis & 1) continue;
        const std::int32_t low = piece[i], high = piece[i | 1 << axis];
        if (upper[low] < 0) upper[low] = high;
        if (lower[high] < 0) lower[high] = low;
      }
    for (std::int32_t n = 0; n < node_count(); ++n)
      if (lower[n] >= 0 && upper[n] >= 0) rows_.push_back({lower[n], n, upper[n]});
  }
}

FieldPoint JointField::point(std::int64_t index, const glm::ivec3& voxel) const {
  const glm::ivec3 in = voxel % step_;
  return {piece_of_[index], static_cast<std::uint16_t>(in.x + 8 * in.y + 64 * in.z), mask_[index],
          (1 - mask_[index]) * share_[index]};
}

double JointField::value(const FieldPoint& point, std::span<const double> nodes) const {
  if (point.piece < 0 || point.mask == 0) return point.base;
  double sum = 0;
  for (int i = 0; i < 8; ++i) sum += shapes_[point.place].weight[i] * nodes[pieces_[point.piece][i]];
  return point.base + point.mask * sum;
}

}  // namespace limber
