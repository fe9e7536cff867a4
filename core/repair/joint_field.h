// SPDX-License-Identifier: AGPL-3.0-or-later
// The share w with which the tissue around a joint follows the bones below the joint, as a smooth function of few
// unknowns. The tissue is divided into coarse cells whose corners are nodes (deform/cell_nodes.h). In a voxel
//
//    w = (1 - mask) * w0 + mask * S,      S = trilinear interpolation of the values of the eight nodes of the voxel's
//    cell
//
// where w0 is the share according to the body's present weights. The mask falls to 0 towards bone, far from the joint
// along its two bones, and in tissue that follows other parts of the body. So w changes continuously into weights that
// stay as they are. Node values in [0, 1] give shares in [0, 1].
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/repair/joint_motion.h"
#include "core/skin/skin_weights.h"
#include "core/skin/weighted_body.h"

namespace limber {

// The share in one voxel as a function of the interpolated node value S: w = base + mask * S.
struct FieldPoint {
  std::int32_t piece = -1;  // index of the voxel's cell; -1: the share is fixed
  std::uint16_t place = 0;  // position of the voxel in its cell, x + 8 y + 64 z
  float mask = 0, base = 0;
};

class JointField {
 public:
  // Keeps a reference to the body, which must outlive the field.
  //   weights  must be rigid in bone tissue
  //   throws Error if the joint has no soft tissue to repair
  JointField(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion, Progress& progress);

  std::int64_t node_count() const { return std::ssize(node_position_); }
  // Returns a node's position at rest relative to the joint, along the world's axes, mm.
  const glm::dvec3& node_position(std::int64_t node) const { return node_position_[node]; }
  // Returns the node values whose shares approximate w0, the share according to the body's present weights, best.
  const std::vector<double>& initial() const { return initial_; }
  std::span<const std::array<std::int32_t, 8>> pieces() const { return pieces_; }
  // Three nodes in a row along an axis of the volume.
  using Row = std::array<std::int32_t, 3>;
  std::span<const Row> rows() const { return rows_; }
  double cell_edge() const { return cell_edge_; }  // mean edge length of a cell over the three axes, mm

  // Return w0 (the share according to the body's present weights) and the mask of a tissue voxel, by its list index.
  float share(std::int64_t voxel) const { return share_[voxel]; }
  float mask(std::int64_t voxel) const { return mask_[voxel]; }
  FieldPoint point(std::int64_t index, const glm::ivec3& voxel) const;
  double value(const FieldPoint& point, std::span<const double> nodes) const;

  // The trilinear weights of a cell's eight nodes at a position in the cell, and their gradients in world axes, 1 / mm.
  struct Shape {
    std::array<float, 8> weight;
    std::array<glm::vec3, 8> slope;
  };
  const Shape& shape(std::uint16_t place) const { return shapes_[place]; }

 private:
  void find_shares(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion);
  void fade_by_bone(const WeightedBody& body, Progress& progress);
  void make_cells(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion);
  void make_shapes(const WeightedBody& body);
  void find_initial(const WeightedBody& body);
  void find_rows();

  int step_ = 4;  // edge of a cell in voxels
  std::vector<float> share_, mask_;
  std::vector<std::int32_t> piece_of_;
  std::vector<std::array<std::int32_t, 8>> pieces_;
  std::vector<glm::dvec3> node_position_;
  std::vector<Row> rows_;
  double cell_edge_ = 0;
  std::vector<double> initial_;
  std::vector<Shape> shapes_;
};

}  // namespace limber
