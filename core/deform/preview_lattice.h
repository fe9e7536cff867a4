// SPDX-License-Identifier: AGPL-3.0-or-later
// The coarse lattice that a live preview is posed by: cells of `step` voxels an axis, those that hold tissue and one
// ring around them, so that the body's surface lies well inside what the cells cover. Its vertices follow the bones
// with the mean of the influences of the tissue voxels in the cells around, each counted by its trilinear share of the
// vertex; where tissue that follows one bone wholly is among them, as bone does, that alone counts, so that bones do
// not bend. Vertices without tissue around follow what their neighbours do.
//
// Some cells have images of their own for a part of what lies in them:
//   stiff  where tissue follows one bone wholly, but corners of the cell follow another bone too: that tissue alone
//   side   where tissue around the cell hangs together only by a way that leads far around, and moves apart, as a hand
//          beside a thigh or two fingers do: each side follows its own bones, and the cell has no image as a whole. So
//          it is where there is one side only, but the cell's vertices follow what lies beyond a gap next to the cell.
//          [the virtual nodes of Molino, Bao & Fedkiw 2004, A virtual node algorithm for changing mesh topology]
//
// Coordinates. Cell c covers the voxels c step .. c step + step - 1. In *cell coordinates* its middle is the whole
// number c and vertex v, its lowest corner, lies at v - 1/2; so a cell stands to this lattice as a voxel to lattice.h.
#pragma once

#include <array>
#include <vector>

#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Voxels an edge: 4 for a limb, 8 where there is so much tissue that a pose would take too long.
int preview_step(const TissueVoxels& tissue);

struct CellPart {
  std::int32_t cell;                                  // of PreviewLattice::cells
  bool is_stiff;                                      // or a side
  std::uint64_t places;                               // that it is the image of, of the 4^3 of the cell, x fastest
  std::array<std::vector<BoneWeight>, 8> influences;  // of the corners, bones rising; they sum to one
  std::array<std::int8_t, 64> apart;  // by place: to the tissue of other sides, kStepApart a step; kFarApart: further

  static constexpr int kStepApart = 63, kFarApart = 127;

  //   rest  cell coordinates
  static int place_of(const glm::ivec3& middle, const glm::dvec3& rest, int step) {
    const glm::ivec3 place =
        glm::ivec3(glm::clamp((rest - glm::dvec3(middle) + 0.5) * double(step), 0.0, step - 0.5)) * 4 / step;
    return place.x + 4 * (place.y + 4 * place.z);
  }
  bool holds(int place) const { return places >> place & 1; }
};

struct PreviewLattice {
  int step = 4;                         // 2, 4 or 8
  Grid grid;                            // of the volume
  glm::ivec3 first{0}, size{0};         // lowest cell and cells an axis of the box that holds them all
  std::vector<glm::ivec3> cells;        // x fastest
  std::vector<glm::ivec3> vertices;     // x fastest
  std::vector<std::int64_t> offsets;    // #vertices + 1
  std::vector<BoneWeight> influences;   // of vertex i: offsets[i] .. offsets[i + 1], bones rising; they sum to one
  std::vector<std::uint8_t> has_sides;  // by cell
  std::vector<CellPart> parts;          // by cell
  std::vector<float> depth;             // by place: mm below air inside tissue, minus mm to the nearest tissue outside

  // Of a vertex in arrays that hold a value for every corner of the box.
  std::int64_t place(const glm::ivec3& vertex) const {
    const glm::ivec3 v = vertex - first;
    return v.x + row() * (v.y + std::int64_t{size.y + 1} * v.z);
  }
  std::int64_t row() const { return size.x + 1; }
  std::int64_t slice() const { return row() * (size.y + 1); }
  std::int64_t places() const { return slice() * (size.z + 1); }

  // Trilinear; cell coordinates, inside that cell.
  double depth_in(const glm::ivec3& cell, const glm::dvec3& rest) const;
};

PreviewLattice preview_lattice(const Grid& grid, const TissueVoxels& tissue, const SkinWeights& weights, int step);

}  // namespace limber
