// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the surface between the regions of a lattice of samples, as triangles that cannot cross each other: a dual
// surface net [Gibson, MICCAI 1998], made free of intersections by fans [Ju & Udeshi, Intersection-free contouring on
// an octree grid, Pacific Graphics 2006]. Also builds the tets of the lattice on both sides of the surface.
//
// A cell with samples of two regions gets one vertex strictly inside it. For every lattice edge between two regions, a
// fan of triangles around a point of the edge joins the vertices of the cells around it. Inside a cell all triangles
// meet at the cell's vertex and form cones, so they cannot cross each other, whatever the positions of the vertices.
// Between cells of two sizes, the fan also includes a point of the face between them, so that the surface has no crack.
//
// Around every lattice edge, every two neighbouring cells give one tet: it joins the edge's two ends to the vertices of
// these cells. The vertex of a cell with only one region is its centre. Away from the surface these tets are those of
// the body-centred cubic lattice [as in Labelle & Shewchuk, Isosurface stuffing, SIGGRAPH 2007]. If the surface crosses
// the edge, the tet is split in two at the crossing point. Every tet is positively oriented for all positions of the
// vertices in their cells, so this cannot fail.
#pragma once

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/mesh/sample_lattice.h"

namespace limber {

// Looks up the regions of voxels at lattice coordinates. Everything beyond the grid is air.
class VoxelLookup {
 public:
  VoxelLookup(const VoxelRegions& voxels, const SampleLattice& lattice);
  // Splits the line of `length` that begins at `from` along `axis` into `count` equal intervals, and writes the region
  // at the centre of each.
  void along(const glm::dvec3& from, int axis, int length, int count, std::uint16_t* regions) const;
  // Returns true if the voxel around a position is air.
  bool is_air(const glm::dvec3& place) const {
    const glm::ivec3 v(glm::floor((place - offset_) / scale_ + 0.5));
    return !voxels_.grid.contains(v) || voxels_.tissue.index_of(v) < 0;
  }
  double voxel_along(int axis) const { return scale_[axis]; }  // voxel size along `axis`, lattice steps
  double shortest_voxel() const { return std::min({scale_.x, scale_.y, scale_.z}); }

 private:
  const VoxelRegions& voxels_;
  glm::dvec3 offset_, scale_;
};

// Number of times that each point of the net was pushed outwards. `cell` has one entry for the point in each cell;
// `edge[axis]` has one for the point on the lattice edge that begins at each sample.
struct Pushes {
  std::vector<std::uint8_t> cell, edge[3];
  explicit Pushes(std::size_t samples);
};

// The surface net. Coordinates are in steps of the lattice.
class SurfaceNet {
 public:
  using Cell = SampleLattice::Cell;
  struct Node {
    glm::dvec3 place, low, high;  // the position, and the corners of the box in which the node may move
  };
  struct Edge {  // a lattice edge between two regions
    glm::ivec3 from;
    int axis, length, node;
    std::uint16_t first, second;
    float border;  // position along the edge, [0, 1], of the border between `first` and `second`
    int cell[4];   // nodes of the cells around the edge, counter-clockwise seen from its end; large cells occur twice
    int face[4];   // node of the face between cells i and i + 1; -1: both have the same size
  };

  // Numbers the nodes and fits them to the voxels: points on lattice edges are at the border between the edge's
  // regions, points of cells and faces in the middle of the edge points around them. Then all points next to air move
  // along the surface's normal until, around each of them, as much tissue is outside the surface as air is inside. So a
  // coarse surface has the volume of the voxels, although its corners are outside a convex body.
  SurfaceNet(const SampleLattice& lattice, const VoxelLookup& voxel_at);
  // For a lattice whose samples are voxels (sample_voxels()): points on lattice edges are in the middle of the edge, so
  // the net's surfaces are the voxels' own faces. Edges that a seam cuts have a point, too.
  explicit SurfaceNet(const SampleLattice& voxels);
  // Moves each point from its fitted position outwards by its number of pushes.
  void place(const Pushes& pushes);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Edge>& edges() const { return edges_; }
  int node_of(const Cell& cell) const {
    return cell_node_[lattice_.index(cell.corner)];
  }  // -1: the cell has one region only

  // Returns the region at a position.
  std::uint16_t region_at(const glm::dvec3& place) const;
  // Returns true if a position is in air; faster than region_at().
  bool is_air(const glm::dvec3& place) const {
    const Holds holds = holds_[lattice_.index(smallest_at(place))];
    return holds == Holds::both ? region_at(place) == RegionSurface::kAir : holds == Holds::air;
  }
  // Returns true if there is air in the cell that contains a given smallest cell.
  //   smallest  index of the smallest cell's lowest corner
  bool is_near_air(std::int64_t smallest) const { return holds_[smallest] != Holds::tissue; }

  // Calls triangle(a, b, c, edge) for each triangle around each lattice edge. The triangle's front faces the edge's far
  // end.
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

  // Returns the tets, world, mm. Their first nodes are those of the net.
  TetMesh tets() const;

 private:
  enum class Holds : std::uint8_t { tissue, air, both };

  glm::ivec3 smallest_at(const glm::dvec3& place) const {
    return glm::clamp(glm::ivec3(glm::floor(place)), glm::ivec3(0), lattice_.size - 2);
  }
  template <class Body>
  void for_each_edge(const Body& body) const;
  void number_edges(const VoxelLookup* voxel_at);
  void number_cells();
  void number_faces();
  void find_air();
  void start_at_borders();
  void shift_to_skin(const VoxelLookup& voxel_at);
  std::int64_t face_between(const glm::ivec3& from, int axis, int slot, int size) const;
  glm::ivec3 sample_at(std::int64_t index) const;
  std::optional<glm::dvec3> middle_of_face(const Cell& cell, const Cell& other, const glm::ivec3& corner,
                                           int axis) const;
  std::uint16_t region_on_face(const glm::dvec3& middle, const glm::dvec3& place, const glm::ivec3& corner, int axis,
                               int size) const;

  const SampleLattice& lattice_;
  std::vector<Node> nodes_;         // nodes on lattice edges, then those in cells, then those on faces
  std::vector<glm::dvec3> fitted_;  // #nodes: position before any push
  std::vector<Edge> edges_;
  std::vector<Cell> cells_;  // cells with samples of two regions
  std::vector<std::int32_t> cell_node_, edge_node_[3];
  std::vector<Holds> holds_;  // #samples: contents of the cell around each smallest cell, by its lowest corner
  // The node of each face between cells of different sizes, by 3 * (index of the lowest sample of the smaller face) +
  // axis.
  std::unordered_map<std::int64_t, int> face_node_;
};

}  // namespace limber
