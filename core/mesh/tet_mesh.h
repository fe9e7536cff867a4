// SPDX-License-Identifier: AGPL-3.0-or-later
// Tissue as tetrahedra. Places are world coordinates in mm; every tet is positively oriented: (b - a, c - a, d - a) of its
// corners a, b, c, d has a positive determinant, at rest.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace limber {

struct TetMesh {
  static constexpr std::uint16_t kSoft = 0;

  Eigen::MatrixX3d V;                 // #V places, world, mm
  Eigen::MatrixX4i T;                 // #T corners
  std::vector<std::uint16_t> region;  // #T: kSoft, or 1 + the rig bone whose bone tissue the tet is

  static int bone_of(std::uint16_t region) { return int(region) - 1; }  // -1 of soft tissue
};

}  // namespace limber
