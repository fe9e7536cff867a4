// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_diffusion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "core/base/parallel.h"
#include "core/binding/cover_islands.h"
#include "core/binding/flesh_graph.h"
#include "core/platform/large_blocks.h"

namespace limber {

namespace {
// Upper limit on a negligible weight. A bone is solved for only in bricks where the coarse solution gives it more
// weight than this. With this weight, a bone that turns by 60 degrees moves a point 300 mm from the joint by only 0.1
// mm.
constexpr float kNegligible = 3e-4f;
constexpr double kCoarseResidual = 1e-4;
// Time that each bone (right-hand side) of a block adds to the solve of a brick, relative to the time that a brick
// takes for any number of bones.
constexpr double kLaneCost = 0.25;
// Upper limit on the memory of a block (a group of bones that are solved together), in bytes per tissue voxel of the
// body. It does not apply to a block of one bone.
constexpr double kBlockBytes = 16;
constexpr int kMostTogether = 4;     // largest number of bones that are solved together
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop

// The coarse solution: each bone's temperature in the coarse cells, without values up to kNegligible.
struct CoarseTemperatures {
  struct Entry {
    std::int32_t cell;
    float value;
  };
  std::vector<std::vector<Entry>> by_bone;
};

void fill_sources(const std::vector<HeldFace>& held, const std::vector<int>& lane_of_bone, int lanes,
                  std::vector<float>& b) {
  for (const HeldFace& face : held)
    if (const int lane = lane_of_bone[face.bone]; lane >= 0)
      b[std::int64_t{face.cell} * lanes + lane] += face.conductance;
}

// Returns for each cell whether heat from some bone reaches it.
std::vector<bool> reached_cells(const CellGraph& graph, const std::vector<HeldFace>& held) {
  std::vector<bool> reached(graph.size(), false);
  std::vector<std::int32_t> open;
  auto reach = [&](std::int32_t cell) {
    if (reached[cell]) return;
    reached[cell] = true;
    open.push_back(cell);
  };
  for (const HeldFace& face : held) reach(face.cell);
  while (!open.empty()) {
    const std::int32_t cell = open.back();
    open.pop_back();
    for (std::int32_t k = graph.first[cell]; k < graph.first[cell + 1]; ++k) reach(graph.neighbour[k]);
  }
  return reached;
}

CoarseTemperatures solve_coarse(const HeatGraph::Coarse& coarse, const std::vector<bool>& reached, int bone_count) {
  // Cells that no heat reaches keep temperature zero. An extra loss of heat keeps the system solvable.
  CellGraph graph = coarse.graph;
  for (std::int64_t i = 0; i < graph.size(); ++i)
    if (!reached[i]) graph.diagonal[i] += 1;
  const std::int64_t size = graph.size();
  const Multigrid multigrid(std::move(graph));

  std::vector<bool> holds(bone_count, false);
  for (const HeldFace& face : coarse.held) holds[face.bone] = true;
  CoarseTemperatures temperatures;
  temperatures.by_bone.resize(bone_count);
  std::vector<int> lane_of_bone(bone_count, -1), block;
  for (int bone = 0; bone <= bone_count; ++bone) {
    if (bone < bone_count && holds[bone]) {
      lane_of_bone[bone] = static_cast<int>(block.size());
      block.push_back(bone);
    }
    if (block.empty() || (bone < bone_count && std::ssize(block) < Multigrid::kMostLanes)) continue;
    const int lanes = static_cast<int>(block.size());
    std::vector<float> b(size * lanes, 0.0f), x(size * lanes, 0.0f);
    fill_sources(coarse.held, lane_of_bone, lanes, b);
    multigrid.solve(std::move(b), x, lanes, kCoarseResidual, 100);
    for (int lane = 0; lane < lanes; ++lane) {
      for (std::int64_t c = 0; c < size; ++c)
        if (x[c * lanes + lane] > kNegligible)
          temperatures.by_bone[block[lane]].push_back({static_cast<std::int32_t>(c), x[c * lanes + lane]});
      lane_of_bone[block[lane]] = -1;
    }
    block.clear();
  }
  return temperatures;
}

// A group of bones that are solved together, and the bricks in which any of these bones has weight.
struct Block {
  std::vector<int> bones;
  std::vector<std::int32_t> bricks;
};

// Groups the bones into blocks that are solved together. Each block starts with the remaining bone that has the most
// bricks. Bones that share many bricks with the block join it.
//   most_bytes  memory limit of a block of several bones
std::vector<Block> blocks_of_bones(const CoarseTemperatures& temperatures,
                                   const std::vector<std::int32_t>& brick_of_cell, double most_bytes) {
  const int bone_count = static_cast<int>(temperatures.by_bone.size());
  std::vector<std::vector<std::int32_t>> bricks(bone_count);
  std::vector<int> waiting;
  for (int bone = 0; bone < bone_count; ++bone) {
    for (const auto& entry : temperatures.by_bone[bone]) bricks[bone].push_back(brick_of_cell[entry.cell]);
    std::sort(bricks[bone].begin(), bricks[bone].end());
    bricks[bone].erase(std::unique(bricks[bone].begin(), bricks[bone].end()), bricks[bone].end());
    if (!bricks[bone].empty()) waiting.push_back(bone);
  }
  std::stable_sort(waiting.begin(), waiting.end(), [&](int a, int b) { return bricks[a].size() > bricks[b].size(); });

  std::vector<Block> blocks;
  while (!waiting.empty()) {
    Block block{{waiting.front()}, bricks[waiting.front()]};
    waiting.erase(waiting.begin());
    while (std::ssize(block.bones) < kMostTogether) {
      // Finds the bone that saves the most work by joining this block instead of starting a block of its own.
      double best_gain = 0;
      size_t best = waiting.size();
      std::vector<std::int32_t> joined;
      for (size_t k = 0; k < waiting.size(); ++k) {
        const auto& own = bricks[waiting[k]];
        std::vector<std::int32_t> both;
        std::set_union(block.bricks.begin(), block.bricks.end(), own.begin(), own.end(), std::back_inserter(both));
        const double lanes = std::ssize(block.bones);
        const double apart = block.bricks.size() * (1 + kLaneCost * lanes) + own.size() * (1 + kLaneCost);
        if (both.size() * HeatVectors::bytes_of_brick(static_cast<int>(lanes) + 1) > most_bytes) continue;
        const double together = both.size() * (1 + kLaneCost * (lanes + 1));
        if (apart - together > best_gain) {
          best_gain = apart - together;
          best = k;
          joined = std::move(both);
        }
      }
      if (best == waiting.size()) break;
      block.bones.push_back(waiting[best]);
      block.bricks = std::move(joined);
      waiting.erase(waiting.begin() + best);
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

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

}  // namespace

SkinWeights diffuse_heat(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                         const HeatDiffusion& settings, Progress& progress, WeightsReport* report) {
  const TissueVoxels tissue(volume);
  const BoneParts parts = split_bones(volume, tissue, tissues, armature, progress);
  return diffuse_heat(volume, tissue, tissues, armature, parts, settings, progress, report);
}

SkinWeights diffuse_heat(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const Armature& armature, const BoneParts& parts, const HeatDiffusion& settings,
                         Progress& progress, WeightsReport* report) {
  WeightsReport ignored;
  WeightsReport& said = report ? *report : ignored;
  progress.update("weights", 0);
  return_free_memory();  // gives back the memory that splitting bones and finding seams has freed
  const int bone_count = static_cast<int>(armature.bones.size());
  const std::vector<std::uint16_t> held_by = fixed_bone(volume, tissue, parts, armature);
  const NearestBone nearest = attracting_bone(volume, tissue, armature, held_by);
  const HeatGraph body(volume, tissue, tissues, held_by, nearest, settings.stiffness);
  const HeatGraph::Coarse coarse = body.coarse();
  const std::vector<bool> reached = reached_cells(coarse.graph, coarse.held);
  const CoarseTemperatures temperatures = solve_coarse(coarse, reached, bone_count);
  progress.update("weights", 0.2);

  return_free_memory();
  BestFour best(tissue);
  std::vector<int> lane_of_bone(bone_count, -1);
  const std::vector<Block> blocks = blocks_of_bones(temperatures, coarse.brick, kBlockBytes * tissue.size());
  std::vector<float> guess(coarse.graph.size() * kMostTogether, 0.0f);
  // Working memory that all blocks of bones reuse.
  HeatSystem system;
  HeatVectors vectors;
  for (size_t k = 0; k < blocks.size(); ++k) {
    const Block& block = blocks[k];
    const int lanes = static_cast<int>(block.bones.size());
    std::fill(guess.begin(), guess.end(), 0.0f);
    for (int lane = 0; lane < lanes; ++lane) {
      lane_of_bone[block.bones[lane]] = lane;
      for (const auto& entry : temperatures.by_bone[block.bones[lane]])
        guess[std::int64_t{entry.cell} * lanes + lane] = entry.value;
    }
    body.fill(block.bricks, system);
    // Cells that no heat reaches keep temperature zero. An extra loss of heat keeps the system solvable.
    for_cells(tissue, block.bricks, system, [&](std::int64_t place, std::int64_t b, int slot) {
      if (!reached[coarse.cell_of_place[place]]) system.diagonal[b * HeatSystem::kSlots + slot] += 1;
    });
    HeatSolver solver(system, lanes, vectors);
    body.add_sources(block.bricks, system, lane_of_bone, solver);
    for_cells(tissue, block.bricks, system, [&](std::int64_t place, std::int64_t b, int slot) {
      if (slot < HeatSystem::kColour) return;
      const float* from = &guess[std::int64_t{coarse.cell_of_place[place]} * lanes];
      for (int lane = 0; lane < lanes; ++lane)
        solver.first_guess_of_blacks(b, lane)[slot - HeatSystem::kColour] = from[lane];
    });
    const MultigridReport solved = solver.solve(settings.residual, settings.maximum_iterations, progress);
    if (progress.cancelled()) throw Cancelled();
    if (solved.residual > settings.residual) {
      char text[64];
      std::snprintf(text, sizeof text, "%.1e after %d iterations", solved.residual, solved.iterations);
      throw Error("the heat solve stopped at a residual of " + std::string(text), armature.bones[block.bones[0]].name,
                  "check that the volume's spacing is right, or use --method geodesic");
    }
    said.residual = std::max(said.residual, solved.residual);
    said.iterations = std::max(said.iterations, solved.iterations);
    for_cells(tissue, block.bricks, system, [&](std::int64_t place, std::int64_t b, int slot) {
      for (int lane = 0; lane < lanes; ++lane)
        best.offer(block.bricks[b], place, block.bones[lane], solver.temperature(b, lane, slot));
    });
    for (const int bone : block.bones) lane_of_bone[bone] = -1;
    progress.update("weights", 0.2 + 0.75 * double(k + 1) / blocks.size());
  }
  best.hold_all(held_by, kSoft);
  cover_islands(volume, tissue, armature, best, said, &tissues);
  return best.weights(names_of_bones(armature));
}

}  // namespace limber
