// SPDX-License-Identifier: AGPL-3.0-or-later
// Points that move with a tet mesh. They are located in the mesh at rest once and can then be posed any number of
// times. A point in the mesh moves with its tet. A point near the mesh moves with the nearest point of the mesh's
// border, and rotates with the tet there. A point may have an anchor at another position: the point then moves as if it
// were fixed to the tissue at its anchor, however far away that is. So the corners of a lattice cell follow the finger
// to which the cell belongs, and not a finger beside it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/mesh/tet_mesh.h"
#include "core/volume/grid.h"

namespace limber {

struct PointToCarry {
  glm::dvec3 rest;    // position at rest, voxel coordinates
  glm::dvec3 anchor;  // anchor, voxel coordinates; equal to `rest` for a point without its own anchor
};

class CarriedPoints {
 public:
  // Finds the tet that contains the anchor of each point, else the nearest place on the border of the mesh.
  //   furthest_mm  points whose anchor is further than this from the mesh do not move with it
  CarriedPoints(std::shared_ptr<const TetMesh> mesh, const Grid& grid, const std::vector<PointToCarry>& points,
                double furthest_mm);

  const std::shared_ptr<const TetMesh>& mesh() const { return mesh_; }
  // Returns the posed points in voxel coordinates; nothing for points that do not move with the mesh.
  //   posed  #V by 3 posed nodes, world, mm
  std::vector<std::optional<glm::dvec3>> posed(const Eigen::MatrixX3d& posed) const;

 private:
  struct Hold {
    int tet = -1;  // -1: the point does not move with the mesh
    std::array<int, 4> nodes{};
    std::array<double, 4> shares{};
    glm::dvec3 off{0};  // offset of the point from the weighted mean of its nodes, at rest, mm
  };
  Hold hold_in(int tet, const glm::dvec3& world) const;

  std::shared_ptr<const TetMesh> mesh_;
  AffineTransform voxel_from_world_;
  std::vector<glm::dvec3> rest_;
  std::vector<Hold> holds_;
};

}  // namespace limber
