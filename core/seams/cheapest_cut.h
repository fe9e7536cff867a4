// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where a seam between a limb and the body part that it touches is cheapest: along the middle of skin and
// connective tissue, with as much fat and muscle below it as skin usually has.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/seams/limbs.h"
#include "core/seams/skin_layers.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

// The tissue in which the cut that parts a limb from the body is searched: it lies near the voxel faces where the free
// part of the limb (is_free()) meets parts of the body that the limb may touch.
struct SeamBand {
  struct Node {
    glm::ivec3 voxel;
    std::int64_t place;  // index of the voxel among the tissue voxels
    float way;           // length of the path through tissue to the nearest face where the limbs meet, mm
  };
  // The side of the cut on which a voxel lies: with the limb, or with the part of the body that the limb touches
  // (Other). Free: the cut decides.
  enum class Side { Limb, Other, Free };

  const Limb& limb;
  std::vector<Node> nodes = {};
  // Neighbour in the band of each voxel, by edge; -1: none. Edges 0, 1, 2 lead to lower x, y, z; 3, 4, 5 to higher z,
  // y, x; edge 5 - k is the reverse of edge k, as in a CutGraph.
  std::vector<std::array<std::int32_t, 6>> beside = {};
  std::vector<std::uint8_t> is_end = {};     // 1 for each voxel that is connected to tissue outside the band
  std::vector<std::uint8_t> is_bridge = {};  // 1 for each voxel of tissue that skin separates from every bone
  std::vector<Side> side = {};
  std::vector<std::uint8_t> inside = {};  // 1 for each voxel on the limb's side of the cheapest cut

  static constexpr int edge_up(int axis) { return 5 - axis; }
  static constexpr int axis_of(int edge) { return edge < 3 ? edge : 5 - edge; }
};

// Returns for each voxel of the band 1 if it is on the limb's side of the cheapest cut, else 0. Reads all of the band
// but `inside`.
//   kinds               tissue kind of each label
//   seams               faces that are cut already
//   of_limb, of_other   how deep tissue usually lies below the skin of the limb, and of the parts that it may touch
std::vector<std::uint8_t> cheapest_cut(const SeamBand& band, const LabelVolume& volume,
                                       const std::vector<TissueKind>& kinds, const Seams& seams,
                                       const SkinLayers& of_limb, const SkinLayers& of_other);

}  // namespace limber
