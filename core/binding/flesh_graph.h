// SPDX-License-Identifier: AGPL-3.0-or-later
// The tissue of a volume as heat sees it: voxels of fixed temperature (each held by one rig bone) and soft voxels
// between them, joined through faces by conductances. Heat crosses faces only, never edges, corners or air, and spacing
// counts: a face conducts area / distance times the harmonic mean of the two conductivities; towards a held voxel only
// the soft half of the way resists.
//
// A soft voxel is also warmed from afar, by one bone (attracting_bone), the nearest through the tissue, with a strength
// that falls with the square of the distance [Baran & Popovic 2007, 4]. Without it a small bone loses the flesh beyond
// it to a larger neighbour (fingertips to the palm), and the two sides of a joint mix over the whole thickness of the
// limb; the law is free of scale, so a finger and a thigh blend alike.
//
// Conductivities are the thermal ones of living tissue relative to muscle. They matter where layers differ: fat
// conducts half as much, so skin over a limb follows the limb all around instead of the nearest bit of bone.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/binding/heat_system.h"
#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

constexpr std::uint16_t kSoft = 0xFFFF;

// Relative to muscle.
float conductivity(TissueKind kind);

// Which rig bone holds each tissue voxel, kSoft where none does: the voxels of its parts; for a bone without a part the
// soft voxels around its axis (a bone that has neither, because it lies outside the tissue, holds nothing).
std::vector<std::uint16_t> fixed_bone(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                                      const Armature& armature);

// For every soft voxel the bone nearest to it and how far it is, found by spreading through tissue: a bone across an
// air gap does not count. Held voxels have distance 0; kSoft and infinity where no held voxel is reached.
struct NearestBone {
  std::vector<std::uint16_t> bone;
  std::vector<float> distance;  // mm, between voxel centres
};
NearestBone nearest_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                         const std::vector<std::uint16_t>& held_by);
// The same by what the bones stand for: the last bone of a chain counts as nearer than it is, a mere link to a limb as
// further off, and flesh around a joint goes by the plane that halves its angle.
NearestBone attracting_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                            const std::vector<std::uint16_t>& held_by);

// Heat flowing from a bone into a cell, through a face or from afar.
struct HeldFace {
  std::int32_t cell;
  std::uint16_t bone;
  float conductance;
};

class HeatGraph {
 public:
  // References are kept.
  HeatGraph(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
            const std::vector<std::uint16_t>& held_by, const NearestBone& nearest,
            const std::map<Label, double>& stiffness = {});

  // Makes the soft voxels of some bricks (rising) the cells of a system; what lies in other bricks has temperature
  // zero.
  void fill(const std::vector<std::int32_t>& bricks, HeatSystem& system) const;
  // What bones give to the cells of such a system, added to a solver's sources.
  //   lane_of_bone  -1 for bones that are not solved for
  void add_sources(const std::vector<std::int32_t>& bricks, const HeatSystem& system,
                   const std::vector<int>& lane_of_bone, HeatSolver& solver) const;

  // The whole body in cells of up to 4^3 voxels: connected sets of soft voxels in one octant of a brick.
  struct Coarse {
    CellGraph graph;
    std::vector<HeldFace> held;
    std::vector<std::int32_t> brick;          // #cells
    std::vector<std::int32_t> cell_of_place;  // #tissue voxels, -1 for held ones
  };
  Coarse coarse() const;

 private:
  struct Window;
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
  float conductance(const Window& window, const glm::ivec3& v, int here, int direction) const;
  float attraction(std::int64_t place, const glm::ivec3& voxel) const;
  std::vector<std::uint64_t> bones_in_bricks() const;

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  const std::vector<std::uint16_t>& held_by_;
  const NearestBone& nearest_;
  std::vector<float> conductivity_;  // by label
  std::vector<float> attraction_;    // likewise: the square of its stiffness, since blends are as wide as the root of
                                     // conduction over attraction
  std::array<float, 3> face_;        // area / distance of a face across each axis, largest 1
  float volume_of_voxel_ = 1;        // mm3, in the same measure
  std::vector<std::uint64_t> bones_in_brick_;
};

}  // namespace limber
