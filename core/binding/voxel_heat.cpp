// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/voxel_heat.h"

#include <algorithm>

#include "core/base/parallel.h"
#include "core/binding/multigrid.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop

// Calls body(place, b, slot) for every cell of each brick bricks[b]. `place` is the index of the cell's voxel in the
// list of tissue voxels.
template <class Body>
void for_cells(const TissueVoxels& tissue, const std::vector<std::int32_t>& bricks, const HeatSystem& system,
               const Body& body) {
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b)
      tissue.for_each(bricks[b], bricks[b] + 1, [&](std::int64_t place, const glm::ivec3& v) {
        if (const int slot = HeatSystem::slot_of(v & 7); system.is_cell(b, slot)) body(place, b, slot);
      });
  });
}

class BlockSolve {
 public:
  BlockSolve(const HeatGraph& heat, const HeatBody& body, const KnownHeat& known, const HeatDiffusion& settings)
      : heat_(heat),
        tissue_(body.tissue),
        armature_(body.armature),
        known_(known),
        settings_(settings),
        lane_of_bone_(body.armature.bones.size(), -1) {}

  void run(const BoneBlock& block, const Progress& progress, BestFour& best, WeightsReport& report) {
    const int lanes = static_cast<int>(block.bones.size());
    for (int lane = 0; lane < lanes; ++lane) lane_of_bone_[block.bones[lane]] = lane;
    if (known_.start_block) known_.start_block(block.bones);
    heat_.fill(block.bricks, system_);
    // Cells that no heat reaches get temperature zero: an additional heat loss there keeps the system solvable.
    for_cells(tissue_, block.bricks, system_, [&](std::int64_t place, std::int64_t b, int slot) {
      if (!known_.is_reached(block.bricks[b], place)) system_.diagonal[b * HeatSystem::kSlots + slot] += 1;
    });
    HeatSolver solver(system_, lanes, vectors_);
    heat_.add_sources(block.bricks, system_, lane_of_bone_, solver);
    if (known_.outside) heat_.add_outside(block.bricks, lanes, system_, known_.outside, solver);
    for_cells(tissue_, block.bricks, system_, [&](std::int64_t place, std::int64_t b, int slot) {
      if (slot < HeatSystem::kColour) return;
      for (int lane = 0; lane < lanes; ++lane)
        solver.first_guess_of_blacks(b, lane)[slot - HeatSystem::kColour] =
            known_.first_guess(block.bricks[b], place, lane);
    });
    const MultigridReport solved = solver.solve(settings_.residual, settings_.maximum_iterations, progress);
    if (progress.cancelled()) throw Cancelled();
    require_residual(solved, settings_.residual, armature_.bones[block.bones[0]].name);
    report.residual = std::max(report.residual, solved.residual);
    report.iterations = std::max(report.iterations, solved.iterations);
    for_cells(tissue_, block.bricks, system_, [&](std::int64_t place, std::int64_t b, int slot) {
      for (int lane = 0; lane < lanes; ++lane)
        best.offer(block.bricks[b], place, block.bones[lane], solver.temperature(b, lane, slot));
    });
    for (const int bone : block.bones) lane_of_bone_[bone] = -1;
  }

 private:
  const HeatGraph& heat_;
  const TissueVoxels& tissue_;
  const Armature& armature_;
  const KnownHeat& known_;
  const HeatDiffusion& settings_;
  std::vector<int> lane_of_bone_;
  // Memory that all blocks of bones reuse.
  HeatSystem system_;
  HeatVectors vectors_;
};
}  // namespace

void solve_in_voxels(const HeatGraph& heat, const HeatBody& body, const std::vector<BoneBlock>& blocks,
                     const KnownHeat& known, const HeatDiffusion& settings, const ShareOfProgress& share,
                     Progress& progress, BestFour& best, WeightsReport& report) {
  BlockSolve solve(heat, body, known, settings);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    solve.run(blocks[k], progress, best, report);
    progress.update("weights", share.at(k + 1, blocks.size()));
  }
}

}  // namespace limber
