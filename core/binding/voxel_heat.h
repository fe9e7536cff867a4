// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves for the temperatures of single voxels, one block of bones after the other. heat_system.h solves one block.
#pragma once

#include <functional>
#include <vector>

#include "core/binding/bone_blocks.h"
#include "core/binding/flesh_graph.h"
#include "core/binding/heat_settings.h"
#include "core/skin/top_four.h"

namespace limber {

// The body through which heat flows. The referenced objects must outlive this struct.
struct HeatBody {
  const LabelVolume& volume;
  const TissueVoxels& tissue;
  const TissueTable& tissues;
  const Armature& armature;
  const ZeroedVector<std::uint16_t>& held_by;  // bone that holds each tissue voxel, from fixed_bone()
};

// Temperatures that are known before the solve. `brick` and `place` are indices of a brick and of a soft voxel in it;
// `lane` is the index of a bone in its block.
struct KnownHeat {
  std::function<void(const std::vector<int>& bones)> start_block;  // called before each block of bones is solved
  // Returns true if heat from at least one bone reaches a voxel.
  std::function<bool(std::int64_t brick, std::int64_t place)> is_reached;
  // Returns the initial guess of a bone's temperature at a voxel.
  std::function<float(std::int64_t brick, std::int64_t place, int lane)> first_guess;
  // Returns a bone's temperature at a voxel of a brick in which the bone's block is not solved. Empty: all are 0.
  std::function<float(std::int64_t brick, std::int64_t place, int lane)> outside;
};

// The part of a longer task's progress that one solve covers, as fractions of the whole, [0, 1].
struct ShareOfProgress {
  double begin, end;
  double at(std::size_t done, std::size_t count) const {
    return begin + (end - begin) * static_cast<double>(done) / static_cast<double>(count);
  }
};

// For each block, solves for the temperatures of its bones at the voxels of its bricks, and offers them to `best`.
// Throws Error if the residual of a solve stays above that of the settings, and Cancelled if the user cancels.
void solve_in_voxels(const HeatGraph& heat, const HeatBody& body, const std::vector<BoneBlock>& blocks,
                     const KnownHeat& known, const HeatDiffusion& settings, const ShareOfProgress& share,
                     Progress& progress, BestFour& best, WeightsReport& report);

}  // namespace limber
