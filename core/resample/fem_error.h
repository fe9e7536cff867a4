// SPDX-License-Identifier: AGPL-3.0-or-later
// Estimates how far a solved shape is from the exact solution of the elastic problem, from a second solve with larger
// tets. If the error is in proportion to the edge of the tets to the power p, the exact solution lies beyond the finer
// one, by the difference of the two solutions divided by (ratio of the edges to the power p, minus 1) [Richardson 1911;
// Roache 1994, Perspective: a method for uniform reporting of grid refinement studies]. For bent limbs p = 1.25 was
// measured. Where the coarse solve is a rough one, as for draft quality, the estimate is many times larger than the
// error. It holds for the error of the tets' size only: it knows nothing of materials, weights or labels that are
// wrong.
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace limber {

struct FemShape;
struct Grid;

// How far flesh that bends is estimated to be from where the exact solution has it.
struct FemError {
  double rms_mm = 0;      // root of the mean square over the volume of this flesh
  double most_mm = 0;     // 95 % of this volume are nearer
  double largest_mm = 0;  // the furthest tet's centre
  glm::dvec3 place{0};    // where it lies in the pose, world, mm
  double coarse_tet_mm = 0;
  std::string unknown;  // why there is no estimate; empty: there is one
};

// Edge of the tets of the second solve, as a multiple of that of the first.
constexpr double kCoarser = 1.5;

// Returns the estimate for the shape `fine`.
//   coarse  the same pose of the same body, solved with tets that are larger by kCoarser
//   grid    grid of the body's volume
FemError estimated_error(const FemShape& fine, const FemShape& coarse, const Grid& grid);

// Returns the differences of two solutions in mm, at the centres of the soft tets of `shape` that `other` holds as
// well, and the centres' indices.
//   grid  grid of the body's volume
struct ShapeDifference {
  std::vector<int> tet;
  std::vector<double> mm;
};
ShapeDifference difference_of(const FemShape& shape, const FemShape& other, const Grid& grid);

}  // namespace limber
