// SPDX-License-Identifier: AGPL-3.0-or-later
// Points that a tet mesh carries, found once at rest and then posed as often as the mesh moves. A point in the mesh
// goes with its tet; one beside it, no further than some mm, with the nearest place of its border, turned by the
// rotation of the tet there. A point may be tied to an anchor instead: it then goes as if it were fixed to the tissue
// around that, however far the point itself lies; so the corners of a lattice cell follow the one of two fingers that
// they are meant for.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/mesh/tet_mesh.h"
#include "core/volume/grid.h"

namespace limber {

struct PointToCarry {
  glm::dvec3 rest;    // voxel coordinates
  glm::dvec3 anchor;  // likewise; the point itself, where it is its own
};

class CarriedPoints {
 public:
  //   furthest_mm  from an anchor to the mesh
  CarriedPoints(std::shared_ptr<const TetMesh> mesh, const Grid& grid, const std::vector<PointToCarry>& points,
                double furthest_mm);

  const std::shared_ptr<const TetMesh>& mesh() const { return mesh_; }
  // Where they are, voxel coordinates; none for those that are too far from the mesh.    posed  #V by 3, world, mm
  std::vector<std::optional<glm::dvec3>> posed(const Eigen::MatrixX3d& posed) const;

 private:
  struct Hold {
    int tet = -1;  // -1: none
    std::array<int, 4> nodes{};
    std::array<double, 4> shares{};
    glm::dvec3 off{0};  // from what the shares say to the point, mm, at rest
  };
  Hold hold_in(int tet, const glm::dvec3& world) const;

  std::shared_ptr<const TetMesh> mesh_;
  AffineTransform voxel_from_world_;
  std::vector<glm::dvec3> rest_;
  std::vector<Hold> holds_;
};

}  // namespace limber
