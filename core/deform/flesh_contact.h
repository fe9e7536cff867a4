// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a pose folds flesh into other flesh, and the way apart. A node that lies in a cell from elsewhere has gone
// through a surface, and so has the cell: the two depths below air at rest together are how far, and each side goes
// back by half of it, along the other's surface normal. Nearer at rest than one and a half times that, flesh is pressed
// together or turned inside out, not gone through: that is not contact.
//
// Lengths in mm along the volume's own axes, as in flesh_cells.h.
#pragma once

#include <optional>
#include <vector>

#include "core/deform/depth.h"
#include "core/deform/flesh_cells.h"

namespace limber {

class FleshContact {
 public:
  //   depth  below air at rest    spacing  of voxels
  FleshContact(const FleshCells& cells, const TissueDepth& depth, const glm::dvec3& spacing);

  // Looks where all cells lie now.
  //   posed  by node
  void look(const std::vector<glm::dvec3>& posed);
  // Of a node of flesh, since the last look; none where it lies in no other flesh.
  std::optional<glm::dvec3> way_apart(std::int32_t node) const;

 private:
  struct Cell {
    glm::dvec3 middle;  // posed
    glm::dmat3 rest_from_posed;
    bool is_flesh;  // neither bone nor turned inside out
  };
  glm::ivec3 bin_of(const glm::dvec3& at) const { return glm::ivec3(glm::floor((at - first_) / bin_)); }
  std::size_t place(const glm::ivec3& bin) const {
    return bin.x + std::size_t(bins_.x) * (bin.y + std::size_t(bins_.y) * bin.z);
  }
  void fill_bins(const std::vector<std::pair<glm::ivec3, glm::ivec3>>& boxes);

  const FleshCells& cells_;
  std::vector<float> depth_;            // by node
  std::vector<glm::vec3> depth_slope_;  // by cell, at rest
  std::vector<float> middle_depth_;     // by cell
  std::vector<Cell> posed_cells_;
  std::vector<glm::dvec3> posed_;
  double bin_ = 0;
  glm::dvec3 first_{0};
  glm::ivec3 bins_{0};
  std::vector<std::int64_t> begin_;  // by bin, then one more
  std::vector<std::int32_t> cells_of_bins_;
};

}  // namespace limber
