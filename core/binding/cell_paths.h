// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the bone nearest to each cell of HeatCells along a path through tissue, as geodesic_front.h does for voxels: a
// front spreads from cell to linked cell, the shortest paths first. Each cell stores the last corner of its path (at
// first a voxel of the bone); from the corner to the cell the path is straight. If the last part of that straight line
// crosses a gap in the tissue, or a seam is near, the path bends at the cell from which the front came.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/binding/bone_reach.h"
#include "core/binding/heat_cells.h"

namespace limber {

struct CellPath {
  glm::vec3 corner{0};         // last corner of the path, voxel coordinates
  float to_corner = 0;         // length of the path up to the corner, mm
  float length = 0;            // length of the path up to the cell's centre, mm
  std::uint16_t bone = kSoft;  // bone at which the path begins; kSoft: no path reaches the cell

  // Returns the length of the path when it ends at a voxel of the cell instead of at the cell's centre, mm.
  float to(const glm::vec3& voxel, const glm::vec3& spacing) const {
    const glm::vec3 way = (voxel - corner) * spacing;
    return to_corner + std::sqrt(glm::dot(way, way));
  }
};

// Returns the path to each cell from the bone that is nearest after correction by `reaches` (one for each bone).
std::vector<CellPath> paths_to_cells(const Grid& grid, const TissueVoxels& tissue, const HeatCells& cells,
                                     const std::vector<BoneReach>& reaches);

// Finds the bone nearest to single voxels, along the paths to their cells. If the nearest bones of linked cells differ,
// or a cell touches bones, there are several candidate paths.
class PathsToVoxels {
 public:
  // Keeps references to all arguments.
  PathsToVoxels(const Grid& grid, const HeatCells& cells, const std::vector<CellPath>& paths, const Armature& armature,
                const std::vector<BoneReach>& reaches)
      : cells_(cells),
        paths_(paths),
        reaches_(reaches),
        hinges_(armature),
        spacing_(grid.spacing),
        world_(world_from_voxel(grid)) {}

  // Lists the candidates for the shortest path to the voxels of a cell. The list is empty if no path reaches the cell.
  void list(std::int32_t cell, std::vector<CellPath>& found) const;

  // The bone that gives heat to a voxel at a distance (attracting_bone), and its corrected distance, mm.
  struct Nearest {
    std::uint16_t bone;
    float distance;
  };
  // Returns the bone that gives heat to a voxel.
  //   listed  from list(), for the voxel's cell; not empty
  Nearest nearest(const std::vector<CellPath>& listed, const glm::ivec3& voxel) const;

 private:
  const HeatCells& cells_;
  const std::vector<CellPath>& paths_;
  const std::vector<BoneReach>& reaches_;
  const Hinges hinges_;
  const glm::vec3 spacing_;
  const AffineTransform world_;
};

}  // namespace limber
