// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds, for a rest point outside a tet mesh, the nearest point on the mesh's border, with which the rest point moves.
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
    int tet;                     // the tet with the border face that contains the point
    std::array<int, 3> corners;  // nodes of this face
    glm::dvec3 shares;           // barycentric coordinates of the point in this face
    double distance_mm;
  };

  // Keeps a reference to the mesh, which must outlive this object.
  MeshBorder(const TetMesh& mesh, const Grid& grid);

  // Returns the border's point nearest to a rest point; nothing if there is none within `furthest_mm`.
  //   rest  voxel coordinates
  //   side  only the border of tets on this side of seams counts (TetMesh::side); -1: all of the border
  std::optional<Place> nearest(const glm::dvec3& rest, double furthest_mm = std::numeric_limits<double>::infinity(),
                               int side = -1) const;

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

// Returns the rotational part of a tet's motion; exactly the identity if the tet is only translated.
//   moved  #V motions of the nodes (posed - rest), mm
Eigen::Matrix3d rotation_of(const TetMesh& mesh, const Eigen::MatrixX3d& moved, int tet);

}  // namespace limber
