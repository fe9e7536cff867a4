// SPDX-License-Identifier: AGPL-3.0-or-later
// The coarse lattice that poses a live preview. It consists of all cells (`step` voxels along each edge) with tissue
// and one ring of cells around them, so that the body's surface is well inside. A vertex follows the mean of the
// influences of the tissue voxels in the cells around it; each voxel counts with its trilinear weight at the vertex.
// Tissue that follows one bone with full weight, as bone does, counts a thousand times as much, so that bones do not
// bend. Vertices without tissue around them follow the mean of their neighbours.
//
// Some cells also have *parts*, which are posed by corners of their own:
//    stiff  the tissue in a cell that follows one bone with full weight, if the cell's corners also follow other bones
//    side   the tissue in a cell on one side of a gap, such as hand and thigh or two fingers. The sides are connected
//           only far from the cell and can move apart, so each follows its own bones, and the cell itself is not posed.
//           A cell with only one side has this part too if the cell's vertices also follow tissue across a gap. [the
//           virtual nodes of Molino, Bao & Fedkiw 2004, A virtual node algorithm for changing mesh topology]
//
// Coordinates. Cell c covers the voxels c * step to c * step + step - 1. In *cell coordinates* its centre is the
// integer c and its lowest corner, vertex c, is at c - 1/2, in the same way as for the voxels of lattice.h.
#pragma once

#include <array>
#include <vector>

#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Returns the number of voxels along a cell's edge: 4 for a small volume, such as a limb; 8 if there is so much tissue
// that posing it with cells of 4 voxels would take too long.
int preview_step(const TissueVoxels& tissue);

struct CellPart {
  std::int32_t cell;  // the cell that contains the part, as an index into PreviewLattice::cells
  // True: tissue that follows one bone; false: tissue on one side of a gap.
  bool is_stiff;
  // One bit for each of the 4^3 subcells, x fastest: 1 if the part poses it.
  std::uint64_t places;
  std::array<std::vector<BoneWeight>, 8> influences;  // weights of each corner: sum 1, ascending by bone
  // Distance of each of the 4^3 subcells from the tissue of other sides, in units of 1 / kStepApart cell edge.
  // kFarApart: the distance is too large to be stored.
  std::array<std::int8_t, 64> apart;

  static constexpr int kStepApart = 63, kFarApart = 127;

  // Returns the index of the subcell that contains a rest point.
  //   middle  cell coordinates of the cell's centre
  //   rest    cell coordinates
  static int place_of(const glm::ivec3& middle, const glm::dvec3& rest, int step) {
    const glm::ivec3 place =
        glm::ivec3(glm::clamp((rest - glm::dvec3(middle) + 0.5) * double(step), 0.0, step - 0.5)) * 4 / step;
    return place.x + 4 * (place.y + 4 * place.z);
  }
  bool holds(int place) const { return places >> place & 1; }
};

struct PreviewLattice {
  int step = 4;                         // edge of a cell in voxels: 2, 4 or 8
  Grid grid;                            // the volume's grid
  glm::ivec3 first{0}, size{0};         // lowest cell and size of the box of all cells
  std::vector<glm::ivec3> cells;        // cells in use, x fastest
  std::vector<glm::ivec3> vertices;     // vertices in use, x fastest
  std::vector<std::int64_t> offsets;    // #vertices + 1: index of the first influence of each vertex
  std::vector<BoneWeight> influences;   // weights of each vertex: sum 1, ascending by bone
  std::vector<std::uint8_t> has_sides;  // 1 for each cell that has parts that are sides
  std::vector<CellPart> parts;          // parts of all cells, in the order of the cells
  std::vector<float> depth;             // by place(vertex): depth below air, mm; in air: minus the distance from tissue

  // Returns the index of a vertex in arrays that have one value for every corner of the box of cells.
  std::int64_t place(const glm::ivec3& vertex) const {
    const glm::ivec3 v = vertex - first;
    return v.x + row() * (v.y + std::int64_t{size.y + 1} * v.z);
  }
  std::int64_t row() const { return size.x + 1; }
  std::int64_t slice() const { return row() * (size.y + 1); }
  std::int64_t places() const { return slice() * (size.z + 1); }

  // Returns the depth below air at a point in a cell in mm, interpolated trilinearly.
  //   rest  cell coordinates
  double depth_in(const glm::ivec3& cell, const glm::dvec3& rest) const;
};

PreviewLattice preview_lattice(const Grid& grid, const TissueVoxels& tissue, const SkinWeights& weights, int step);

}  // namespace limber
