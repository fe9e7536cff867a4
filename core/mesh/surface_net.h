// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface between the regions of a lattice of samples, as triangles that cannot cut themselves: a dual surface net
// [Gibson, MICCAI 1998], made free of intersections by fans [Ju & Udeshi, Intersection-free contouring on an octree
// grid, Pacific Graphics 2006]; and the tets of the lattice on both of its sides.
//
// A cell with samples of two regions gets one vertex strictly inside it; around every lattice edge between two regions
// a face joins the vertices of the cells there, as a fan around a point of the edge. Inside a cell all triangles are
// cones from its vertex, so none can cross another wherever the vertices lie. Where cells of two sizes meet the fan
// also passes a point of the face between them, so that the surface has no crack.
//
// The tets stand around every lattice edge, between its two ends and the vertices of each two cells that follow each
// other there; the vertex of a cell of one region is its middle. Away from the surface that is the body-centred cubic
// lattice [as in Labelle & Shewchuk, Isosurface stuffing, SIGGRAPH 2007]. Where the edge passes the surface, one tet
// stands on each side of its point. All are positive wherever the vertices lie in their cells, so this cannot fail.
#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "core/mesh/sample_lattice.h"

namespace limber {

// Regions of the voxels at places of a lattice, air beyond the grid.
class VoxelLookup {
 public:
  VoxelLookup(const VoxelRegions& voxels, const SampleLattice& lattice);
  // At `count` places in the middle of equal parts of the way from `from` along an axis.
  void along(const glm::dvec3& from, int axis, int length, int count, std::uint16_t* regions) const;
  double voxel_along(int axis) const { return scale_[axis]; }  // fine steps

 private:
  const VoxelRegions& voxels_;
  glm::dvec3 offset_, scale_;
};

// How often each point was pushed outwards.
struct Pushes {
  std::vector<std::uint8_t> cell,
      edge[3];  // the point in each cell, and that of the edge along each axis from each sample
  explicit Pushes(std::size_t samples);
};

// Coordinates are counted in steps of the lattice.
class SurfaceNet {
 public:
  using Cell = SampleLattice::Cell;
  struct Node {
    glm::dvec3 place, low, high;  // with the box in which it may lie
  };
  struct Edge {  // between two regions
    glm::ivec3 from;
    int axis, length, node;
    std::uint16_t first, second;
    float border;  // share of it where one region ends and the other begins
    int cell[4];   // the nodes of the cells around it, counter-clockwise seen from its end; a larger one comes twice
    int face[4];   // that of the face between each and the next, -1 where both are of one size
  };

  // Points are nowhere until they are placed.
  SurfaceNet(const SampleLattice& lattice, const VoxelLookup& voxel_at);
  // Edges' points where the border is and as far out as they were pushed, the others in between.
  void place(const Pushes& pushes);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Edge>& edges() const { return edges_; }
  int node_of(const Cell& cell) const { return cell_node_[lattice_.index(cell.corner)]; }  // -1 of a cell of one region

  // The region of a place; whether it is air, which is sooner known; and whether its cell holds any.
  std::uint16_t region_at(const glm::dvec3& place) const;
  bool is_air(const glm::dvec3& place) const {
    const Holds holds = holds_[lattice_.index(smallest_at(place))];
    return holds == Holds::both ? region_at(place) == RegionSurface::kAir : holds == Holds::air;
  }
  bool is_near_air(std::int64_t smallest) const {
    return holds_[smallest] != Holds::tissue;
  }  // by where the smallest cell stands

  // triangle(a, b, c, edge): nodes of each around an edge, facing the sample further along the axis.
  template <class Triangle>
  void for_each_triangle(const Triangle& triangle) const {
    for (const Edge& edge : edges_)
      for (int slot = 0; slot < 4; ++slot) {
        const int a = edge.cell[slot], b = edge.cell[(slot + 1) % 4], middle = edge.face[slot];
        if (a == b) continue;
        if (middle < 0) {
          triangle(edge.node, a, b, edge);
        } else {
          triangle(edge.node, a, middle, edge);
          triangle(edge.node, middle, b, edge);
        }
      }
  }

  // World, mm; the nodes of the net first.
  TetMesh tets() const;

 private:
  enum class Holds : std::uint8_t { tissue, air, both };

  glm::ivec3 smallest_at(const glm::dvec3& place) const {
    return glm::clamp(glm::ivec3(glm::floor(place)), glm::ivec3(0), lattice_.size - 2);
  }
  template <class Body>
  void for_each_edge(const Body& body) const;
  void number_edges(const VoxelLookup& voxel_at);
  void number_cells();
  void number_faces();
  void find_air();
  std::int64_t face_between(const glm::ivec3& from, int axis, int slot, int size) const;
  glm::ivec3 sample_at(std::int64_t index) const;
  std::optional<glm::dvec3> middle_of_face(const Cell& cell, const Cell& other, const glm::ivec3& corner,
                                           int axis) const;
  std::uint16_t region_on_face(const glm::dvec3& middle, const glm::dvec3& place, const glm::ivec3& corner, int axis,
                               int size) const;

  const SampleLattice& lattice_;
  std::vector<Node> nodes_;  // of edges, then of cells, then of faces
  std::vector<Edge> edges_;
  std::vector<Cell> cells_;  // those with samples of two regions
  std::vector<std::int32_t> cell_node_, edge_node_[3];
  std::vector<Holds> holds_;  // of the cell in which lies the smallest that begins at each sample
  std::unordered_map<std::int64_t, int>
      face_node_;  // 3 index of the face's lowest sample + axis; the face of the smaller cell
};

}  // namespace limber
