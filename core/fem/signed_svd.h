// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes singular value decompositions of deformation gradients, two or four at once (matrix_lanes.h), since one at a
// time they would take a third of the time for assembling a matrix. One-sided Jacobi rotations find small singular
// values as precisely as large ones [Demmel & Veselic 1992].
#pragma once

#include <span>

#include <Eigen/Core>

namespace limber {

// F = U diag(sigma) V^T with rotations U and V. The last singular value, which is the smallest in magnitude, is
// negative if det F is negative.
struct Principal {
  Eigen::Matrix3d U, V;
  Eigen::Vector3d sigma;  // singular values, in descending order
};

enum class MatrixLanes { Widest, Two };  // number of SIMD lanes; both give the same result, bit for bit

// Decomposes each F into the result with the same index.
void signed_svd(std::span<const Eigen::Matrix3d> F, std::span<Principal> result,
                MatrixLanes width = MatrixLanes::Widest);
Principal signed_svd(const Eigen::Matrix3d& F);

}  // namespace limber
