// SPDX-License-Identifier: AGPL-3.0-or-later
// The live preview: where each place of the posed body comes from, coarse enough to be made anew for every picture
// while a bone is dragged. A PreviewMap holds rest points at nodes that lie `step` voxels apart over the posed body;
// between nodes it is read linearly. The cells of preview_lattice.h, posed, say which rest point a node is the image
// of, by the rules of inverse_map.h where two cells claim one node. Cells that bend are curved, and their corners'
// chords would take off what bulges: inside them the motions of the corners are blended as those of bones are, and a
// node's rest point is where that leads to the node, a step or two from what the chords say.
//
// Nodes just outside all cells carry their neighbours' map on, straight; so the eight nodes around any place of the
// body are there. Where those eight jump, in a fold, two sheets of the body meet between them: a place there reads the
// nearest node and what lies as far on that node's other side, mirrored through it, and so stays on one sheet. What is
// carried on may lead into tissue of another side (preview_lattice.h), which has gone elsewhere; so each node knows how
// far that is, and beyond the border, where that distance falls below zero, nothing is read.
//
// Where tissue is carried by a tet mesh, as while finite elements settle, vertices near the mesh go where that takes
// them (carried_points.h) instead of with their bones; cells are then read straight, by their chords.
//
// Only the surroundings of cells that moved are rasterized and finished again, in the memory of the map before last
// where nobody holds that any longer. What comes out never depends on what was posed before.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/deform/carried_points.h"
#include "core/deform/lattice.h"
#include "core/deform/preview_lattice.h"
#include "core/deform/rasterize.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct PreviewMap {
  static constexpr int kFullFraction = 65535;
  // Of a cube: nothing known there; its nodes lie on one sheet; so they do, but some beyond its border; they jump.
  static constexpr std::uint8_t kNothing = 0, kWhole = 1, kBordered = 64, kBroken = 128;

  // Boxes of rest points, in the nodes' own fractions.
  struct RestBox {
    glm::u16vec3 low, high;
  };

  int step = 4;
  Grid grid;                     // of the volume; posed points are in its voxels too
  glm::ivec3 first{0}, size{0};  // node n lies at the voxel coordinates (first + n + 1/2) step - 1/2
  std::vector<glm::u16vec4>
      nodes;  // rest point as fractions of [low, low + extent]; the last is kFullFraction where covered, or 0
  std::vector<std::int8_t> apart;   // by node: at rest, to what is beyond the border of its sheet, CellPart::kStepApart
                                    // a step; 0 where not covered
  std::vector<std::uint8_t> cubes;  // between node n and n + 1; as many as nodes
  std::vector<RestBox> reach;       // of each cube's covered nodes; meaningless in cubes without any
  glm::dvec3 low{0}, extent{1};     // voxel coordinates

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
  // Two nodes next to each other lie on different sheets where they are further apart than this at rest, voxels...
  // (A joint twisted by a right angle moves as much as 3 steps without a fold.)
  double jump() const { return 5.0 * step; }
  // ... or where each is further from where the other's cell leads to than this, steps (twice as far where no gap is
  // near).
  static constexpr double kStray = 1.5;
  // What is carried on beyond the nodes of a sheet is no steeper, voxels for a step.
  double steepest() const { return 1.5 * step; }

  // The rest point of a posed point, both in voxel coordinates; none outside the body's surroundings.
  std::optional<glm::dvec3> rest_at(const glm::dvec3& posed) const;

 private:
  std::optional<glm::dvec3> between(const glm::dvec3& place) const;
  double apart_between(const glm::dvec3& place) const;
};

// A tet mesh and where its nodes are. Equal pointers are equal contents.
struct MeshPose {
  std::shared_ptr<const TetMesh> rest;
  std::shared_ptr<const Eigen::MatrixX3d> posed;  // #V by 3, world, mm

  bool operator==(const MeshPose&) const = default;
};

class LivePreview {
 public:
  // `weights` are only read here.
  //   step  as preview_step() tells, or 2, 4, 8
  LivePreview(std::shared_ptr<const LabelVolume> volume, const TissueTable& tissues, const TissueVoxels& tissue,
              const SkinWeights& weights, int step);

  // The map of a pose. Another pointer than before only where it differs.
  //   posed_from_rest  #bones of the weights
  //   mesh             what carries the tissue near it; empty: nothing does
  // throws Error where the pose carries tissue too far
  std::shared_ptr<const PreviewMap> update(const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                                           const MeshPose& mesh = {});

  const PreviewLattice& lattice() const { return lattice_; }
  std::int64_t cells_rasterized() const { return cells_rasterized_; }  // by the last update

 private:
  struct Tiles;
  class Tile;
  class Finish;

  // A map, and what has to be done again before it tells the present pose.
  struct Made {
    std::shared_ptr<PreviewMap> map;
    std::vector<std::uint8_t> jumps;        // by node: bit per axis along which the next one lies on another sheet
    std::vector<std::array<int, 2>> stale;  // by row of nodes (y, then z): first and end
  };

  // The cells of the lattice and, after them, their parts.
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

  bool pose_vertices(const std::vector<RigidTransform>& posed_from_rest, Blend blend, const MeshPose& mesh);
  void hold_by(const std::shared_ptr<const TetMesh>& mesh);
  void bound_cells();
  void rasterize();
  void rasterize_tile(const glm::ivec3& tile, const std::int32_t* cells, std::int64_t count);
  void mark_stale(const glm::ivec3& tile);
  Made& spare();
  void finish(Made& made) const;

  std::shared_ptr<const LabelVolume> volume_;
  PreviewLattice lattice_;
  std::vector<int> priority_;                // by label; air lowest
  std::vector<std::int32_t> motion_of_;      // by place: of motion_, at the corners of cells that can bend; else -1
  std::vector<std::int32_t> first_motion_;   // by part: of its corners; -1 for those that cannot bend
  std::vector<BoneWeight> part_influences_;  // of corner c of part p: from part_offsets_[8 p + c] up to the next one
  std::vector<std::int32_t> part_offsets_;

  AffineTransform world_from_cell_;
  glm::dmat3 cell_from_world_{1};  // of directions

  // The last pose.
  std::vector<RigidTransform> posed_from_rest_;
  Blend blend_ = Blend::Linear;
  MeshPose mesh_;
  std::optional<CarriedPoints> carried_;  // by mesh_: the vertices, then eight for each part
  std::vector<FixedPoint> posed_;         // by place of the lattice
  std::vector<SkinTransform> motion_;     // blended from those of bones
  std::vector<std::array<FixedPoint, 8>> posed_parts_;
  std::vector<std::uint8_t> moved_, part_moved_;  // by place, by part: by the update under way
  std::vector<std::uint8_t> bone_moved_;
  std::vector<VoxelRange> range_,
      before_;                     // by cell: absolute nodes that its image can hold, of this update and of the last
  glm::ivec3 first_{0}, size_{0};  // nodes, whole tiles
  std::vector<glm::u16vec4> claimed_;  // by node: what a cell says
  std::vector<std::int8_t> claimed_apart_;
  std::vector<std::int32_t> claiming_;  // by node: that cell, -1 for none
  std::array<Made, 2> made_;
  std::shared_ptr<const PreviewMap> map_;  // the last one made
  std::int64_t cells_rasterized_ = 0;
};

}  // namespace limber
