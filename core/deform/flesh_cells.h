// SPDX-License-Identifier: AGPL-3.0-or-later
// The tissue that a pose bends, as coarse cells of step^3 voxels: one cell for each piece of tissue that hangs together
// inside one (cell_pieces.h). Cells whose tissue touches share the four nodes of the side between them; where tissue
// only lies side by side, as two fingers or the two sides of a seam do, each has nodes of its own [the virtual nodes of
// Molino, Bao & Fedkiw 2004, A virtual node algorithm for changing mesh topology].
//
// Lengths in mm along the volume's own axes; the centre of voxel (0, 0, 0) is the origin.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/deform/brick_motions.h"
#include "core/deform/skinning.h"

namespace limber {

struct FleshCells {
  int step = 2;                                    // voxels an edge: 2, 4 or 8
  glm::dvec3 edge{0};                              // mm
  std::vector<std::array<std::int32_t, 8>> nodes;  // by cell; bit 0 of the place is x, bit 1 y, bit 2 z
  std::vector<glm::ivec3> lowest;                  // by cell: its lowest voxel
  std::vector<float> fill;                         // by cell: how much of it is tissue, (0, 1]
  std::vector<glm::dvec3> rest;                    // by node
  std::vector<glm::dvec3> blended;                 // by node: where blending carries it
  std::vector<float> bone;                         // by node: how much bone lies around it, in cells
  std::vector<std::uint8_t> is_fixed;              // by node: whether tissue beside it follows one bone as a whole

  // By brick: the place in cell_of_voxel of its first voxel, -1 of bricks that do not bend.
  std::vector<std::int32_t> bending;
  std::vector<std::int32_t> cell_of_voxel;  // 512 a bending brick, x fastest; -1 in air

  //   voxel  of the brick, 0 .. 7 on each axis
  std::int32_t cell_of(std::int64_t brick, const glm::ivec3& voxel) const {
    return bending[brick] < 0 ? -1 : cell_of_voxel[bending[brick] + voxel.x + 8 * (voxel.y + 8 * voxel.z)];
  }
};

//   is_bone  by label
FleshCells flesh_cells(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                       const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                       const BrickMotions& motions);

}  // namespace limber
