// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where a pose moves flesh into other flesh, and how to separate the two. If a node is inside a cell from another
// part of the body, it has entered through that part's surface. The depth of this penetration is the sum of the depths
// of node and cell below air at rest. The node is moved back by half of this sum along the surface normal at the cell.
// If node and cell are nearer to each other at rest than 1.5 times the sum plus two cell diagonals, the flesh is only
// compressed or inverted, and there is no contact.
//
// Lengths are in mm along the volume's own axes, as in flesh_cells.h.
#pragma once

#include <optional>
#include <vector>

#include "core/deform/depth.h"
#include "core/deform/flesh_cells.h"

namespace limber {

class FleshContact {
 public:
  // Computes how deep the cells lie below air at rest. look() must be called before way_apart().
  //   cells    must outlive this object
  //   depth    depth below air at rest
  //   spacing  size of a voxel, mm
  FleshContact(const FleshCells& cells, const TissueDepth& depth, const glm::dvec3& spacing);

  // Stores the posed positions and sorts the posed cells into bins; way_apart() uses them.
  //   posed  posed position of each node
  void look(const std::vector<glm::dvec3>& posed);
  // Returns the motion that moves a node half of the way out of other flesh; nothing if the node was in no other flesh
  // when look() was last called.
  std::optional<glm::dvec3> way_apart(std::int32_t node) const;

 private:
  struct Cell {
    glm::dvec3 middle;  // posed position of the cell's centre
    glm::dmat3 rest_from_posed;
    bool is_flesh;  // true: the cell is neither mostly bone nor inverted
  };
  glm::ivec3 bin_of(const glm::dvec3& at) const { return glm::ivec3(glm::floor((at - first_) / bin_)); }
  std::size_t place(const glm::ivec3& bin) const {
    return bin.x + std::size_t(bins_.x) * (bin.y + std::size_t(bins_.y) * bin.z);
  }
  void fill_bins(const std::vector<std::pair<glm::ivec3, glm::ivec3>>& boxes);

  const FleshCells& cells_;
  std::vector<float> depth_;            // depth of each node below air at rest, mm
  std::vector<glm::vec3> depth_slope_;  // gradient of the depth in each cell at rest, mm per mm
  std::vector<float> middle_depth_;     // mean depth of each cell's nodes, mm
  std::vector<Cell> posed_cells_;
  std::vector<glm::dvec3> posed_;
  double bin_ = 0;
  glm::dvec3 first_{0};
  glm::ivec3 bins_{0};
  std::vector<std::int64_t> begin_;  // #bins + 1: index in cells_of_bins_ of the first cell of each bin
  std::vector<std::int32_t> cells_of_bins_;
};

}  // namespace limber
