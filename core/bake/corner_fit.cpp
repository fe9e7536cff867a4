// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bake/corner_fit.h"

#include <algorithm>
#include <climits>
#include <cmath>

#include "core/base/error.h"

namespace limber {

namespace {

// Weight of the term in corner_fit.h that keeps the field smooth; a corner in soft tissue has the weight 1.
constexpr double kBending = 0.01;
// The iterations end when the residual is this share of the residual of zero values.
constexpr double kTolerance = 1e-6;
constexpr int kMostIterations = 400;

double dot(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i], b[i]);
  return sum;
}

glm::ivec3 floor_divided(const glm::ivec3& a, const glm::ivec3& b) {
  return glm::ivec3(glm::floor(glm::dvec3(a) / glm::dvec3(b)));
}

}  // namespace

CornerFit::CornerFit(std::vector<glm::ivec3> corners, std::vector<float> weight, const glm::ivec3& step)
    : corners_(std::move(corners)),
      weight_(std::move(weight)),
      step_(step) {
  if (corners_.empty()) return;
  glm::ivec3 low(INT_MAX), high(INT_MIN);
  for (const glm::ivec3& corner : corners_) {
    low = glm::min(low, floor_divided(corner, step_));
    high = glm::max(high, -floor_divided(-corner, step_));
  }
  first_ = low;
  size_ = high - low + 1;
  number_nodes();
  add_corners();
}

// Lists the lattice nodes that have a share in the value at some voxel corner, and the neighbours of each of these
// nodes.
void CornerFit::number_nodes() {
  const std::size_t row = size_.x, slice = row * size_.y;
  index_.assign(slice * size_.z, 0);  // 1 marks a node until the nodes are counted
  for (const glm::ivec3& corner : corners_) {
    const Shares shares = shares_of(corner);
    for (int i = 0; i < shares.count; ++i) index_[shares.node[i]] = 1;
  }
  for (std::size_t place = 0; place < index_.size(); ++place) {
    const bool is_node = index_[place] == 1;
    index_[place] = is_node ? static_cast<std::int32_t>(nodes_.size()) : -1;
    if (is_node) nodes_.push_back(static_cast<std::int32_t>(place));
  }
  columns_.assign(27 * nodes_.size(), -1);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const std::size_t place = nodes_[n];
    const glm::ivec3 at(place % row, place / row % size_.y, place / slice);
    std::int32_t* column = &columns_[27 * n];
    for (int c = 0; c < 27; ++c) {
      const glm::ivec3 near = at + glm::ivec3(c % 3, c / 3 % 3, c / 9) - 1;
      if (glm::any(glm::lessThan(near, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(near, size_))) continue;
      column[c] = index_[near.x + row * near.y + slice * near.z];
    }
    for (const int along : {1, 3, 9})
      if (column[13 - along] >= 0 && column[13 + along] >= 0)
        in_a_row_.push_back({column[13 - along], static_cast<std::int32_t>(n), column[13 + along]});
  }
}

// Adds the terms that the voxel corners contribute to the equations to matrix_.
void CornerFit::add_corners() {
  matrix_.assign(27 * nodes_.size(), 0.0);
  for (std::size_t corner = 0; corner < corners_.size(); ++corner) {
    const Shares shares = shares_of(corners_[corner]);
    for (int i = 0; i < shares.count; ++i)
      for (int j = 0; j < shares.count; ++j) {
        const glm::ivec3 off = shares.side[j] - shares.side[i] + 1;
        matrix_[27 * index_[shares.node[i]] + off.x + 3 * off.y + 9 * off.z] +=
            weight_[corner] * shares.share[i] * shares.share[j];
      }
  }
  diagonal_.assign(nodes_.size(), 0.0);
  for (std::size_t n = 0; n < nodes_.size(); ++n) diagonal_[n] = matrix_[27 * n + 13];
  for (const auto& [a, b, c] : in_a_row_) {
    diagonal_[a] += kBending;
    diagonal_[b] += 4 * kBending;
    diagonal_[c] += kBending;
  }
}

// Returns the lattice nodes around a voxel corner whose shares (trilinear weights) there are above zero, and the
// shares.
CornerFit::Shares CornerFit::shares_of(const glm::ivec3& corner) const {
  const glm::ivec3 low = floor_divided(corner, step_);
  const glm::dvec3 high = glm::dvec3(corner - low * step_) / glm::dvec3(step_), rest = 1.0 - high;
  Shares shares;
  for (int i = 0; i < 8; ++i) {
    const double share = (i & 1 ? high.x : rest.x) * (i & 2 ? high.y : rest.y) * (i & 4 ? high.z : rest.z);
    if (share == 0) continue;
    shares.side[shares.count] = glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
    const glm::ivec3 n = low + shares.side[shares.count] - first_;
    shares.node[shares.count] = n.x + size_.x * (n.y + size_.y * n.z);
    shares.share[shares.count++] = share;
  }
  return shares;
}

void CornerFit::add_bending(const std::vector<glm::dvec3>& x, std::vector<glm::dvec3>& to) const {
  for (const auto& [a, b, c] : in_a_row_) {
    const glm::dvec3 bend = kBending * (x[a] - 2.0 * x[b] + x[c]);
    to[a] += bend;
    to[b] -= 2.0 * bend;
    to[c] += bend;
  }
}

std::vector<glm::dvec3> CornerFit::product(const std::vector<glm::dvec3>& x) const {
  std::vector<glm::dvec3> y(x.size(), glm::dvec3(0));
  for (std::size_t n = 0; n < x.size(); ++n)
    for (int c = 0; c < 27; ++c)
      if (const std::int32_t m = columns_[27 * n + c]; m >= 0) y[n] += matrix_[27 * n + c] * x[m];
  add_bending(x, y);
  return y;
}

std::vector<glm::dvec3> CornerFit::fit(const std::vector<glm::vec3>& given) const {
  std::vector<glm::dvec3> x(nodes_.size(), glm::dvec3(0)), residual = x;
  for (std::size_t corner = 0; corner < corners_.size(); ++corner) {
    const Shares shares = shares_of(corners_[corner]);
    for (int i = 0; i < shares.count; ++i)
      residual[index_[shares.node[i]]] += weight_[corner] * shares.share[i] * glm::dvec3(given[corner]);
  }
  const auto preconditioned = [&](const std::vector<glm::dvec3>& r) {
    std::vector<glm::dvec3> z(r.size());
    for (std::size_t n = 0; n < r.size(); ++n) z[n] = r[n] / diagonal_[n];
    return z;
  };
  std::vector<glm::dvec3> z = preconditioned(residual), p = z;
  double rz = dot(residual, z);
  if (!std::isfinite(rz))
    throw Error("the solve moves tissue to positions that are not finite numbers", "baked joint",
                "bake a smaller range");
  const double enough = kTolerance * kTolerance * rz;
  for (int iteration = 0; iteration < kMostIterations && rz > enough; ++iteration) {
    const std::vector<glm::dvec3> Ap = product(p);
    const double alpha = rz / dot(p, Ap);
    for (std::size_t n = 0; n < x.size(); ++n) x[n] += alpha * p[n], residual[n] -= alpha * Ap[n];
    z = preconditioned(residual);
    const double next = dot(residual, z);
    for (std::size_t n = 0; n < x.size(); ++n) p[n] = z[n] + next / rz * p[n];
    rz = next;
  }
  return x;
}

}  // namespace limber
