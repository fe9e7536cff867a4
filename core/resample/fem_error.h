// SPDX-License-Identifier: AGPL-3.0-or-later
// Estimates how far a solved shape is from the exact solution of the elastic problem, by Richardson extrapolation from
// a second solve with larger tets. If the error is proportional to (edge length of the tets)^p, then
//   error of the finer solution = (difference of the two solutions) / ((ratio of the edge lengths)^p - 1)
// [Richardson 1911; Roache 1994, Perspective: a method for uniform reporting of grid refinement studies]. For bent
// limbs p = 1.25 was measured. If the second solve is very coarse, as for draft quality, the estimate is many times
// larger than the error. The estimate contains only the error due to the size of the tets. Errors of materials, weights
// or labels are not included.
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace limber {

struct FemShape;
struct Grid;

// Estimated distance between the solved positions and the exact solution, for the flesh that bends.
struct FemError {
  double rms_mm = 0;      // root mean square of the distance over the volume of this flesh
  double most_mm = 0;     // 95th percentile of the distance over the volume of this flesh
  double largest_mm = 0;  // largest distance of a tet's centre
  glm::dvec3 place{0};    // posed position of the tet centre with the largest distance, world, mm
  double coarse_tet_mm = 0;
  std::string unknown;  // why there is no estimate; empty: there is one
};

// Edge length of the tets of the second solve, as a multiple of the first solve's.
constexpr double kCoarser = 1.5;

// Returns the estimated error of the shape `fine`.
//   coarse  the same pose of the same body, solved with tets that are kCoarser times as large
//   grid    grid of the body's volume
FemError estimated_error(const FemShape& fine, const FemShape& coarse, const Grid& grid);

// Distances between the positions in two solutions, at the centres of those soft tets of `shape` that lie in the mesh
// of `other` too.
//   tet   indices of these tets in the mesh of `shape`     mm  distance at each of them
//   grid  grid of the body's volume
struct ShapeDifference {
  std::vector<int> tet;
  std::vector<double> mm;
};
ShapeDifference difference_of(const FemShape& shape, const FemShape& other, const Grid& grid);

}  // namespace limber
