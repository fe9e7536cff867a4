// SPDX-License-Identifier: AGPL-3.0-or-later
// The tissue of a volume as a graph for heat diffusion. Some voxels have a fixed temperature: each of them is *held* by
// one rig bone. All other voxels are *soft*: their temperatures are solved for. Heat flows through voxel faces only,
// never through edges, corners or air. The conductance of a face is area / distance times the harmonic mean of the
// conductivities on its two sides. At a face to a held voxel, only the half of the distance in the soft voxel counts.
//
// A soft voxel also receives heat from one bone at a distance: from the bone that is nearest along a path through the
// tissue (attracting_bone). The strength is proportional to 1 / distance^2 [Baran & Popovic 2007, 4]. Without this heat
// a small bone would lose the flesh beyond it to a larger neighbour (fingertips to the palm), and the two sides of a
// joint would mix over the whole thickness of the limb. The law does not depend on scale, so a finger and a thigh blend
// alike.
//
// Conductivities are the thermal conductivities of living tissue relative to muscle. They matter where layers differ:
// fat conducts half as much, so skin over a limb follows the whole limb and not only the nearest piece of bone.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/binding/brick_window.h"
#include "core/binding/heat_system.h"
#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Returns the thermal conductivity of a tissue kind, relative to muscle.
float conductivity(TissueKind kind);

// The constants of heat flow in the tissue of a volume.
struct HeatLaw {
  HeatLaw(const Grid& grid, const TissueTable& tissues, const std::map<Label, double>& stiffness = {});

  // Returns the conductance of a face perpendicular to `axis` between two voxels of these conductivities. If `there` is
  // 0, a bone holds the voxel on the other side at a fixed temperature.
  float conductance(int axis, float here, float there) const {
    if (there == 0) return 2 * face[axis] * here;
    return face[axis] * (here == there ? here : 2 * here * there / (here + there));
  }

  std::vector<float> conductivity;  // thermal conductivity of each label's tissue, relative to muscle
  // Strength of the heat that the tissue of each label receives at a distance, times the square of the tissue's
  // stiffness. The width of a blend is proportional to sqrt(conductivity / strength), so the square makes it inversely
  // proportional to the stiffness.
  std::vector<float> attraction;
  // Area / distance of a voxel face perpendicular to each axis, divided by the largest of the three values.
  std::array<float, 3> face;
  float volume_of_voxel = 1;  // mm3, divided by the largest area / distance of a face
};

// Returns the rig bone that holds each tissue voxel at a fixed temperature; kSoft for a voxel that no bone holds. A
// bone holds the voxels of its parts (BoneParts). A bone without parts holds the soft voxels around its axis. A bone
// outside the tissue holds nothing.
ZeroedVector<std::uint16_t> fixed_bone(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                                       const Armature& armature);

// The nearest bone of every tissue voxel and its distance. Distances are lengths of paths through tissue, so that a
// bone across an air gap is not near. A voxel held by a bone has distance 0. A voxel that no path from a bone reaches
// has the bone kSoft and an infinite distance.
struct NearestBone {
  ZeroedVector<std::uint16_t> bone;
  ZeroedVector<float> distance;  // distance between voxel centres, mm
};
NearestBone nearest_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                         const ZeroedVector<std::uint16_t>& held_by);
// Finds the bone that gives heat to each voxel at a distance: the nearest bone as in nearest_bone(), but by corrected
// distances (bone_reach.h). The distance to the last bone of a chain is reduced. The distance to a bone that only links
// a limb to the trunk (a collarbone) is increased. Flesh around a joint is divided by the plane that bisects the angle
// of the joint.
NearestBone attracting_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                            const ZeroedVector<std::uint16_t>& held_by);

// Conductance from a bone to a cell, through a face or at a distance.
struct HeldFace {
  std::int32_t cell;
  std::uint16_t bone;
  float conductance;
};

class HeatGraph {
 public:
  // Keeps references to all arguments except `tissues` and `stiffness`. The referenced objects must outlive the graph.
  HeatGraph(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
            const ZeroedVector<std::uint16_t>& held_by, const NearestBone& nearest,
            const std::map<Label, double>& stiffness = {});

  // Fills `system` with a cell for each soft voxel of the given bricks (blocks of 8^3 voxels). Soft voxels in other
  // bricks have temperature 0.
  //   bricks  indices of the bricks, ascending
  void fill(const std::vector<std::int32_t>& bricks, HeatSystem& system) const;
  // Adds the heat that bones give to the cells of a system from fill() to the solver's right-hand sides.
  //   lane_of_bone  index of the right-hand side for each bone; -1: the bone is not solved for
  void add_sources(const std::vector<std::int32_t>& bricks, const HeatSystem& system,
                   const std::vector<int>& lane_of_bone, HeatSolver& solver) const;

  // Adds the heat that soft voxels in other bricks give to the cells of a system from fill(), to each right-hand side.
  //   outside  a function (brick, index of a tissue voxel, right-hand side) -> the temperature at that voxel
  void add_outside(const std::vector<std::int32_t>& bricks, int lanes, const HeatSystem& system,
                   const std::function<float(std::int64_t, std::int64_t, int)>& outside, HeatSolver& solver) const;

  // The whole body as a graph of coarse cells. A cell is a connected set of soft voxels in one octant of a brick, so it
  // has at most 4^3 voxels.
  struct Coarse {
    CellGraph graph;
    std::vector<HeldFace> held;
    std::vector<std::int32_t> brick;  // brick that contains each cell
    // The cell of each tissue voxel; -1: a bone fixes the voxel's temperature.
    std::vector<std::int32_t> cell_of_place;
  };
  Coarse coarse() const;

 private:
  using Window = BrickWindow;
  struct CoarseCell {
    glm::i16vec3 octant;
    std::int32_t brick;
  };
  struct Link {
    std::int32_t from, to;
    float conductance;
  };
  template <class Body>
  void for_soft(std::int64_t brick, Window& window, const Body& body) const;
  void find_cells(std::int64_t brick, Window& window, std::vector<std::int32_t>& cell_of,
                  std::vector<CoarseCell>& found) const;
  void link_cells(std::int64_t brick, Window& window, const std::vector<std::int32_t>& cell_of,
                  std::vector<float>& diagonal, std::vector<Link>& links, std::vector<HeldFace>& held) const;
  BrickWindow::Source source() const { return {volume_, tissue_, held_by_, law_.conductivity}; }
  float conductance(const Window& window, const glm::ivec3& v, int here, int direction) const;
  float attraction(std::int64_t place, const glm::ivec3& voxel) const;
  std::vector<std::uint64_t> bones_in_bricks() const;

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  const ZeroedVector<std::uint16_t>& held_by_;
  const NearestBone& nearest_;
  const HeatLaw law_;
  std::vector<std::uint64_t> bones_in_brick_;
};

}  // namespace limber
