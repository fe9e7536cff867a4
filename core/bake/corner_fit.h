// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits a field that is given at the corners of tissue voxels by one that is trilinear between the nodes of a coarser
// lattice. A node's share in a corner is its trilinear weight there. The values x of the nodes minimise
//
//    sum over corners  weight * | sum of the nodes' shares * x  -  given |^2
//      +   kBending * sum over three nodes in a row  | x - 2 x + x |^2
//
// The second sum is small; it continues the field smoothly to nodes in the air beside the skin, which have few corners
// around them. The equations are solved by conjugate gradients, one field after the other, so that the result does not
// depend on the number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

class CornerFit {
 public:
  //   corners  #C different corners; each is given by the voxel of which it is the lowest corner
  //   weight   #C, each above 0
  //   step     number of corners from one node to the next, along each axis
  CornerFit(std::vector<glm::ivec3> corners, std::vector<float> weight, const glm::ivec3& step);

  const glm::ivec3& first() const { return first_; }  // node n of the box lies at the corner (first + n) * step
  const glm::ivec3& size() const { return size_; }
  const std::vector<std::int32_t>& nodes() const { return nodes_; }  // indices of the nodes in the box, ascending

  // Returns the value of each node for a field that is given at the corners.
  std::vector<glm::dvec3> fit(const std::vector<glm::vec3>& given) const;

 private:
  struct Shares {
    glm::ivec3 side[8];    // 0 or 1 along each axis: where each node lies among the eight nodes around the corner
    std::int32_t node[8];  // indices of these nodes in the box
    double share[8];
    int count = 0;
  };
  Shares shares_of(const glm::ivec3& corner) const;
  void number_nodes();
  void add_corners();
  void add_bending(const std::vector<glm::dvec3>& x, std::vector<glm::dvec3>& to) const;
  std::vector<glm::dvec3> product(const std::vector<glm::dvec3>& x) const;

  std::vector<glm::ivec3> corners_;
  std::vector<float> weight_;
  glm::ivec3 step_, first_{0}, size_{0};
  // nodes_: index of each node in the box. index_: for each index in the box, the index in nodes_; -1: no node.
  std::vector<std::int32_t> nodes_, index_;
  std::vector<std::int32_t> columns_;  // #N by 27: neighbours of each node; -1: none
  // Entries of the equations' matrix for each node and its neighbours, #N by 27, in the order of columns_.
  std::vector<double> matrix_;
  std::vector<std::array<std::int32_t, 3>> in_a_row_;  // three nodes in a row along an axis
  std::vector<double> diagonal_;
};

}  // namespace limber
