// SPDX-License-Identifier: AGPL-3.0-or-later
// The border of a tet mesh at rest: what lies outside the mesh goes with the place of the border that is nearest.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/deform/box_bins.h"
#include "core/mesh/tet_mesh.h"
#include "core/volume/grid.h"

namespace limber {

class MeshBorder {
 public:
  struct Place {
    int tet;                     // that has the face
    std::array<int, 3> corners;  // nodes
    glm::dvec3 shares;           // of them; they sum to one
    double distance_mm;
  };

  // Keeps a reference: the mesh must outlive it.
  MeshBorder(const TetMesh& mesh, const Grid& grid);

  // The place nearest to a rest point, in voxel coordinates; none where none is within `furthest_mm`.
  std::optional<Place> nearest(const glm::dvec3& rest,
                               double furthest_mm = std::numeric_limits<double>::infinity()) const;

 private:
  struct Face {
    std::array<int, 3> corners;
    int tet;
  };
  const TetMesh* mesh_;
  Grid grid_;
  AffineTransform world_from_voxel_;
  std::vector<Face> faces_;
  BoxBins bins_;
};

// The rotation of a tet's motion; exactly none where it does not move.    moved  #V posed - rest, mm
Eigen::Matrix3d rotation_of(const TetMesh& mesh, const Eigen::MatrixX3d& moved, int tet);

}  // namespace limber
