// SPDX-License-Identifier: AGPL-3.0-or-later
// Singular values of deformation gradients, two or four at once, as the processor can: a third of what assembling a
// matrix took went there. By one-sided Jacobi rotations, which find small singular values as exactly as large ones
// [Demmel & Veselic 1992].
#pragma once

#include <span>

#include <Eigen/Core>

namespace limber {

// F = U diag(sigma) V^T with rotations U and V; only the smallest singular value, the last, is negative where det F is.
struct Principal {
  Eigen::Matrix3d U, V;
  Eigen::Vector3d sigma;  // falling
};

enum class MatrixLanes { Widest, Two };  // the same comes out, to the bit

// Of each F, as many as there are.
void signed_svd(std::span<const Eigen::Matrix3d> F, std::span<Principal> result,
                MatrixLanes width = MatrixLanes::Widest);
Principal signed_svd(const Eigen::Matrix3d& F);

}  // namespace limber
