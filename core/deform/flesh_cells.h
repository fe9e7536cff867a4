// SPDX-License-Identifier: AGPL-3.0-or-later
// Divides the tissue that a pose bends into coarse cells of step^3 voxels: one cell for each connected component of the
// tissue in such a cube (cell_pieces.h). Cells whose tissue touches share the four nodes of the face between them.
// Neighbouring components that do not touch, such as two fingers or the two sides of a seam, have separate nodes [the
// virtual nodes of Molino, Bao & Fedkiw 2004, A virtual node algorithm for changing mesh topology].
//
// Lengths are in mm along the volume's own axes; the centre of voxel (0, 0, 0) is the origin.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/deform/brick_motions.h"
#include "core/deform/skinning.h"

namespace limber {

struct FleshCells {
  int step = 2;                                    // edge of a cell in voxels: 2, 4 or 8
  glm::dvec3 edge{0};                              // edge lengths of a cell along x, y, z, mm
  std::vector<std::array<std::int32_t, 8>> nodes;  // nodes of each cell; bits 0, 1, 2 of the index: x, y, z
  std::vector<glm::ivec3> lowest;                  // lowest voxel of each cell
  std::vector<float> fill;                         // share of each cell's cube that is tissue, (0, 1]
  std::vector<glm::dvec3> rest;                    // position of each node at rest, mm
  std::vector<glm::dvec3> blended;                 // position of each node after blending, mm
  std::vector<float> bone;                         // volume of bone around each node, in cell volumes
  std::vector<std::uint8_t> is_fixed;              // 1 for each node that touches a brick that moves as one rigid body

  // For each brick, the index of its first voxel in cell_of_voxel; -1: the pose does not bend the brick.
  std::vector<std::int32_t> bending;
  std::vector<std::int32_t> cell_of_voxel;  // 512 values per bent brick, x fastest: index of the voxel's cell; -1: air

  // Returns the cell that contains a voxel; -1: no cell contains it.
  //   voxel  position in the brick, 0 .. 7 on each axis
  std::int32_t cell_of(std::int64_t brick, const glm::ivec3& voxel) const {
    return bending[brick] < 0 ? -1 : cell_of_voxel[bending[brick] + voxel.x + 8 * (voxel.y + 8 * voxel.z)];
  }
};

// Divides the tissue into cells and computes the nodes' positions in a pose.
//   is_bone  1 for each label that is bone tissue
FleshCells flesh_cells(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                       const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                       const BrickMotions& motions);

}  // namespace limber
