// SPDX-License-Identifier: AGPL-3.0-or-later
// The tissue of a volume as heat sees it: voxels of fixed temperature (each held by one rig bone) and soft voxels
// between them, joined through faces by conductances. Heat crosses faces only, never edges, corners or air, and spacing
// counts: a face conducts area / distance times the harmonic mean of the two conductivities; towards a held voxel only
// the soft half of the way resists.
//
// Conductivities are the thermal ones of living tissue relative to muscle. They matter where layers differ: fat
// conducts half as much, so skin over a limb follows the limb all around instead of the nearest bit of bone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/bone_parts.h"
#include "core/skin/multigrid.h"
#include "core/volume/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

constexpr std::uint16_t kSoft = 0xFFFF;

// Relative to muscle.
float conductivity(TissueKind kind);

// Which rig bone holds each tissue voxel, kSoft where none does: the voxels of its parts; for a bone without a part the
// soft voxels around its axis (a bone that has neither, because it lies outside the tissue, holds nothing).
std::vector<std::uint16_t> bone_holding(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                                        const Armature& armature);

// Heat flowing from a held voxel into a cell.
struct HeldFace {
  std::int32_t cell;
  std::uint16_t bone;
  float conductance;
};

class SoftBody {
 public:
  // References are kept.
  SoftBody(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
           const std::vector<std::uint16_t>& held_by);

  // The soft voxels of some bricks as cells; what lies in other bricks has temperature zero.
  struct Region {
    CellGraph graph;
    std::vector<HeldFace> held;
    std::vector<std::int64_t> place;  // #cells, in the tissue list
  };
  Region region(const std::vector<std::int32_t>& bricks) const;

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
  float face(std::int64_t axis, Label a, Label b) const;

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  const std::vector<std::uint16_t>& held_by_;
  std::vector<float> conductivity_;  // by label
  std::array<float, 3> face_;        // area / distance of a face across each axis, largest 1
};

}  // namespace limber
