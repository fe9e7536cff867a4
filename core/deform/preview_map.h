// SPDX-License-Identifier: AGPL-3.0-or-later
// The live preview: an inverse map of the posed body, coarse enough to be recomputed for every frame while a bone is
// dragged. A PreviewMap stores the rest points of nodes that are `step` voxels apart over the posed body, and
// interpolates linearly between them. The posed cells of preview_lattice.h give each node its rest point; if two cells
// claim a node, the rules of inverse_map.h decide. A cell that bends is curved, so the trilinear map of its corners
// would flatten bulges. Inside such a cell, the corners' motions are therefore blended like those of bones. Newton
// steps, which start from the rest point of the trilinear map, find the rest point that the blended motion moves to the
// node.
//
// Nodes just outside all cells extrapolate their neighbours linearly, so that all eight nodes around any point of the
// body have rest points. If the rest points of these eight nodes jump, as in a fold, two sheets of the body meet
// between them. A point there is then extrapolated from its nearest node and from the point mirrored at that node, and
// so stays on one sheet. Extrapolation may lead into tissue of another side (preview_lattice.h), which is posed
// elsewhere. So each node stores its distance from such tissue; where the distance is negative, beyond the sheet's
// border, the map is empty.
//
// Baked joints (preview_shifts.h) shift the vertices around them, and so the tissue between these vertices.
//
// Where tissue moves with a tet mesh, as while a FEM solve runs, vertices near the mesh move with the mesh
// (carried_points.h) instead of with their bones. All cells then use the trilinear map of their corners.
//
// Only nodes near cells that moved are recomputed. The result is written into the memory of the map before the last
// one, unless another owner still uses it. The result never depends on earlier poses.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/deform/carried_points.h"
#include "core/deform/lattice.h"
#include "core/deform/preview_lattice.h"
#include "core/deform/preview_shifts.h"
#include "core/deform/rasterize.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct PreviewMap {
  static constexpr int kFullFraction = 65535;
  // The states of a cube of eight nodes. kNothing: no node is covered. kWhole: all covered nodes lie on one sheet of
  // the body. kBordered: they lie on one sheet, but some beyond its border. kBroken: they lie on different sheets.
  static constexpr std::uint8_t kNothing = 0, kWhole = 1, kBordered = 64, kBroken = 128;

  // A bounding box of rest points, whose coordinates are fractions as in the member `nodes`.
  struct RestBox {
    glm::u16vec3 low, high;
  };

  int step = 4;
  Grid grid;                     // grid of the volume; posed points are in its voxel coordinates
  glm::ivec3 first{0}, size{0};  // node n lies at voxel coordinates (first + n + 1/2) * step - 1/2
  // Rest points as fractions of [low, low + extent]. The last component is kFullFraction for nodes with a rest point
  // (covered nodes), else 0.
  std::vector<glm::u16vec4> nodes;
  // Distance at rest of each node from tissue beyond the border of the node's sheet, in units of step /
  // CellPart::kStepApart voxels. Negative for a node beyond the border; 0 for a node without a rest point.
  std::vector<std::int8_t> apart;
  std::vector<std::uint8_t> cubes;  // state of each cube, at the index of its lowest node
  std::vector<RestBox> reach;       // bounding box of each cube's covered nodes; undefined if it has none
  glm::dvec3 low{0}, extent{1};     // range of rest points, voxel coordinates

  std::int64_t index(const glm::ivec3& n) const {
    return n.x + std::int64_t{size.x} * (n.y + std::int64_t{size.y} * n.z);
  }
  bool contains(const glm::ivec3& n) const {
    return glm::all(glm::greaterThanEqual(n, glm::ivec3(0))) && glm::all(glm::lessThan(n, size));
  }
  bool covers(const glm::ivec3& n) const { return nodes[index(n)].w != 0; }
  glm::dvec3 node_from_voxel(const glm::dvec3& voxel) const {
    return (voxel + 0.5) / double(step) - 0.5 - glm::dvec3(first);
  }
  glm::dvec3 rest_of(const glm::u16vec3& fraction) const {
    return low + extent * (glm::dvec3(fraction) / double(kFullFraction));
  }
  glm::dvec3 rest_of_node(const glm::ivec3& n) const { return rest_of_node_at(index(n)); }
  glm::dvec3 rest_of_node_at(std::int64_t at) const { return rest_of(glm::u16vec3(nodes[at])); }
  // Neighbouring nodes are on different sheets if their distance at rest is larger than this, voxels. (A joint twisted
  // by 90 degrees moves neighbouring nodes up to 3 steps apart without a fold.)
  double jump() const { return 5.0 * step; }
  // Upper limit, in steps, on the error when the map of a node's cell is extended to a neighbouring node. A larger
  // error means that the two nodes are on different sheets. If no gap between sides is near, twice this limit is used.
  static constexpr double kStray = 1.5;
  // Rest points are extrapolated beyond a sheet's nodes only if they change by less than this from node to node,
  // voxels.
  double steepest() const { return 1.5 * step; }

  // Returns the rest point of a posed point, both in voxel coordinates; nothing if the point is not near the body.
  std::optional<glm::dvec3> rest_at(const glm::dvec3& posed) const;

 private:
  std::optional<glm::dvec3> between(const glm::dvec3& place) const;
  double apart_between(const glm::dvec3& place) const;
};

// A tet mesh and its posed nodes. Equal pointers are taken as equal contents.
struct MeshPose {
  std::shared_ptr<const TetMesh> rest;
  std::shared_ptr<const Eigen::MatrixX3d> posed;  // #V by 3 posed nodes, world, mm

  bool operator==(const MeshPose&) const = default;
};

class LivePreview {
 public:
  // Reads `weights` in the constructor only, so that they need not outlive the preview.
  //   step  edge of a cell in voxels: preview_step(), or 2, 4 or 8
  LivePreview(std::shared_ptr<const LabelVolume> volume, const TissueTable& tissues, const TissueVoxels& tissue,
              const SkinWeights& weights, int step);

  // Returns the map of a pose. If nothing has changed since the last call, returns the same pointer. Throws Error if
  // the pose moves tissue too far, and if a joint was baked from a larger volume.
  //   posed_from_rest  motions of the bones of the weights
  //   mesh             a mesh that moves the tissue near it; empty: all tissue moves with the bones
  //   baked            baked joints with their rotations in the pose; their shifts are added to blending by dual
  //                    quaternions
  std::shared_ptr<const PreviewMap> update(const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                                           const MeshPose& mesh = {}, const std::vector<BentJoint>& baked = {});

  const PreviewLattice& lattice() const { return lattice_; }
  std::int64_t cells_rasterized() const { return cells_rasterized_; }  // in the last update

 private:
  struct Tiles;
  class Tile;
  class Finish;

  // A map, and the rows of nodes that must be recomputed before it matches the current pose.
  struct Made {
    std::shared_ptr<PreviewMap> map;
    // For each node, one bit for each axis (1 << axis): 1 if the next node along the axis is on another sheet.
    std::vector<std::uint8_t> jumps;
    std::vector<std::array<int, 2>> stale;  // begin and end of the stale nodes in each row (y, then z)
  };

  // In the functions below, `cell` is an index into a list of all cells of the lattice followed by all its parts.
  std::int64_t cell_count() const { return std::ssize(range_); }
  std::int64_t part_of(std::int64_t cell) const { return cell - std::ssize(lattice_.cells); }
  const CellPart* part(std::int64_t cell) const { return part_of(cell) < 0 ? nullptr : &lattice_.parts[part_of(cell)]; }
  const glm::ivec3& middle(std::int64_t cell) const { return lattice_.cells[part(cell) ? part(cell)->cell : cell]; }
  bool is_stiff(std::int64_t cell) const { return part(cell) && part(cell)->is_stiff; }
  const FixedPoint& corner(std::int64_t cell, int i) const;
  std::int32_t motion(std::int64_t cell, int corner) const;
  glm::dmat3 slope(std::int64_t cell) const;
  bool strays(std::int64_t node, int axis, std::int64_t next, const glm::dvec3& apart) const;
  bool has_moved(std::int64_t cell) const;
  PosedCell posed_cell(std::int64_t cell) const;
  glm::dvec3 in_bent_cell(std::int64_t cell, const glm::ivec3& node, const glm::dvec3& rest) const;

  bool pose_vertices(const std::vector<RigidTransform>& posed_from_rest, Blend blend, const MeshPose& mesh,
                     const std::vector<BentJoint>& baked);
  void hold_by(const std::shared_ptr<const TetMesh>& mesh);
  void bound_cells();
  void rasterize();
  void rasterize_tile(const glm::ivec3& tile, const std::int32_t* cells, std::int64_t count);
  void mark_stale(const glm::ivec3& tile);
  Made& spare();
  void finish(Made& made) const;

  std::shared_ptr<const LabelVolume> volume_;
  PreviewLattice lattice_;
  std::vector<int> priority_;  // by label: the tissue with the higher priority wins; air has the lowest
  // By PreviewLattice::place(vertex): index into motion_; -1: no cell at this vertex bends.
  std::vector<std::int32_t> motion_of_;
  std::vector<std::int32_t> first_motion_;   // index in motion_ of corner 0 of each part; -1: the part cannot bend
  std::vector<BoneWeight> part_influences_;  // influences of corner c of part p begin at part_offsets_[8 * p + c]
  std::vector<std::int32_t> part_offsets_;

  AffineTransform world_from_cell_;
  glm::dmat3 cell_from_world_{1};  // transforms vectors, not points

  // The state of the last pose that was computed.
  std::vector<RigidTransform> posed_from_rest_;
  Blend blend_ = Blend::Linear;
  MeshPose mesh_;
  PreviewShifts shifts_;
  // Points that may move with mesh_: all vertices, then eight corners of each part.
  std::optional<CarriedPoints> carried_;
  std::vector<FixedPoint> posed_;      // posed position of each vertex, by PreviewLattice::place(vertex)
  std::vector<SkinTransform> motion_;  // blended motions at corners of cells that can bend
  std::vector<std::array<FixedPoint, 8>> posed_parts_;
  // 1 for each vertex (by PreviewLattice::place(vertex)) and for each part that this update moves.
  std::vector<std::uint8_t> moved_, part_moved_;
  std::vector<std::uint8_t> bone_moved_;
  // Range of nodes that the posed image of each cell can contain, in this update and in the previous one. Node (0, 0,
  // 0) is the first node of the voxel grid, not first_.
  std::vector<VoxelRange> range_, before_;
  glm::ivec3 first_{0}, size_{0};      // first node, and size, of the range of nodes; it consists of whole tiles
  std::vector<glm::u16vec4> claimed_;  // rest point that a cell claims for each node, as in PreviewMap::nodes
  std::vector<std::int8_t> claimed_apart_;
  std::vector<std::int32_t> claiming_;  // cell that claims each node; -1: no cell does
  std::array<Made, 2> made_;
  std::shared_ptr<const PreviewMap> map_;  // result of the last update
  std::int64_t cells_rasterized_ = 0;
};

}  // namespace limber
