// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/cell_heat.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/bone_blocks.h"

namespace limber {

namespace {
// A bone is solved for only in bricks (8^3 voxels) where the coarse solution gives it a larger weight than this. With
// this weight, a bone that turns by 60 degrees moves a point 300 mm from the joint by only 0.1 mm.
constexpr float kNegligible = 3e-4f;
// Smaller temperatures are not stored. This is half of the smallest weight that BestFour stores.
constexpr float kLeastTemperature = 5e-5f;
constexpr double kScoutResidual = 1e-4;
constexpr std::int64_t kGrain = 64;    // number of bricks in one block of a parallel loop
constexpr std::int64_t kCells = 4096;  // number of cells in one block of a parallel loop

using Sources = std::vector<std::vector<CellSource>>;

// The cells of the whole body, coarsened twice (scout cells), and each bone's temperatures in them.
struct Scout {
  std::vector<std::int32_t> of_cell;  // scout cell that contains each cell
  std::vector<bool> reached;          // true: heat from at least one bone reaches the scout cell
  std::vector<std::vector<float>> by_bone;
};

std::vector<bool> reached_cells_of(const CellGraph& graph, const std::vector<double>& heat) {
  std::vector<bool> reached(graph.size(), false);
  std::vector<std::int32_t> open;
  for (std::int32_t c = 0; c < graph.size(); ++c)
    if (heat[c] > 0) {
      reached[c] = true;
      open.push_back(c);
    }
  while (!open.empty()) {
    const std::int32_t cell = open.back();
    open.pop_back();
    for (std::int32_t k = graph.first[cell]; k < graph.first[cell + 1]; ++k)
      if (const std::int32_t other = graph.neighbour[k]; !reached[other]) {
        reached[other] = true;
        open.push_back(other);
      }
  }
  return reached;
}

// Returns the graph of the scout cells. Its diagonal contains only the links between cells, no losses to bones.
CellGraph coarsen_twice(const CellGraph& cells, std::vector<std::int32_t>& scout_of_cell) {
  static_assert(kScoutCoarsenings == 2);
  std::vector<std::int32_t> upper;
  CellGraph graph = coarsen(coarsen(cells, scout_of_cell, LoneCells::Keep), upper, LoneCells::Keep);
  parallel_for(std::ssize(scout_of_cell), kCells, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t c = begin; c < end; ++c) scout_of_cell[c] = upper[scout_of_cell[c]];
  });
  for (std::int64_t c = 0; c < graph.size(); ++c) {
    double linked = 0;
    for (std::int32_t k = graph.first[c]; k < graph.first[c + 1]; ++k) linked += graph.conductance[k];
    graph.diagonal[c] = static_cast<float>(linked);
  }
  return graph;
}

Scout solve_scout(const CellGraph& cells, const Sources& sources, const Progress& progress) {
  Scout scout;
  CellGraph graph = coarsen_twice(cells, scout.of_cell);
  const std::int64_t size = graph.size();
  std::vector<double> heat(size, 0);
  for (const auto& of_bone : sources)
    for (const CellSource& source : of_bone) heat[scout.of_cell[source.cell]] += source.on_scout;
  scout.reached = reached_cells_of(graph, heat);
  // Cells that no heat reaches get temperature zero: an additional heat loss there keeps the system solvable.
  for (std::int64_t c = 0; c < size; ++c) graph.diagonal[c] += scout.reached[c] ? static_cast<float>(heat[c]) : 1;
  const Multigrid multigrid(std::move(graph));
  scout.by_bone.resize(sources.size());
  std::vector<int> block;
  for (std::size_t bone = 0; bone <= sources.size(); ++bone) {
    if (bone < sources.size() && !sources[bone].empty()) block.push_back(static_cast<int>(bone));
    if (block.empty() || (bone < sources.size() && std::ssize(block) < Multigrid::kMostLanes)) continue;
    const auto lanes = std::ssize(block);
    ZeroedVector<float> b(size * lanes), x(size * lanes);
    for (std::int64_t lane = 0; lane < lanes; ++lane)
      for (const CellSource& source : sources[block[lane]])
        b[scout.of_cell[source.cell] * lanes + lane] += source.on_scout;
    multigrid.solve(std::move(b), x, static_cast<int>(lanes), kScoutResidual, 100, progress);
    for (std::int64_t lane = 0; lane < lanes; ++lane) {
      std::vector<float>& own = scout.by_bone[block[lane]];
      own.resize(size);
      for (std::int64_t c = 0; c < size; ++c) own[c] = x[c * lanes + lane];
    }
    block.clear();
  }
  return scout;
}

// Returns for each bone the bricks in which the scout solution gives the bone weight, ascending.
std::vector<std::vector<std::int32_t>> bricks_with_weight(const HeatCells& cells, const Scout& scout) {
  const std::int64_t brick_count = std::ssize(cells.first) - 1;
  std::vector<std::vector<std::int32_t>> bricks(scout.by_bone.size());
  parallel_for(std::ssize(bricks), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t bone = begin; bone < end; ++bone) {
      const std::vector<float>& temperature = scout.by_bone[bone];
      if (temperature.empty()) continue;
      const auto has_weight = [&](std::int32_t cell) { return temperature[scout.of_cell[cell]] > kNegligible; };
      for (std::int64_t brick = 0; brick < brick_count; ++brick) {
        bool found = false;
        for (std::int32_t k = 0; k < cells.cell_count(brick) && !found; ++k) found = has_weight(cells.cell(brick, k));
        if (found) bricks[bone].push_back(static_cast<std::int32_t>(brick));
      }
    }
  });
  return bricks;
}

// The cells of some of the bricks as a separate graph. Cells in other bricks have temperature 0.
class BrickCells {
 public:
  BrickCells(const HeatCells& cells, const Scout& scout)
      : cells_(cells),
        scout_(scout),
        number_(cells.graph.size(), -1) {}

  // Sets the bricks whose cells are in the graph.
  void choose(const std::vector<std::int32_t>& bricks) {
    std::vector<std::array<std::int32_t, 2>> from(bricks.size() + 1);
    std::int32_t next = 0;
    for (int colour = 0; colour < 2; ++colour) {
      for (std::size_t b = 0; b < bricks.size(); ++b) {
        from[b][colour] = next;
        next += cells_.first[bricks[b] + 1][colour] - cells_.first[bricks[b]][colour];
      }
      from[bricks.size()][colour] = next;
    }
    whole_.resize(next);
    red_count_ = from.back()[0];
    parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t b = begin; b < end; ++b)
        for (int colour = 0; colour < 2; ++colour)
          for (std::int32_t k = from[b][colour]; k < from[b + 1][colour]; ++k) {
            whole_[k] = cells_.first[bricks[b]][colour] + k - from[b][colour];
            number_[whole_[k]] = k;
          }
    });
  }
  void forget() {
    for_cells([&](std::int64_t k) { number_[whole_[k]] = -1; });
  }

  const std::vector<std::int32_t>& whole() const { return whole_; }  // index of each chosen cell among all cells
  // Returns the index of a cell among the chosen cells; -1: the cell is not chosen.
  std::int32_t number(std::int32_t cell) const { return number_[cell]; }

  CellGraph graph() const {
    const CellGraph& all = cells_.graph;
    const std::int64_t size = std::ssize(whole_);
    CellGraph graph;
    graph.spacing = all.spacing;
    graph.red_count = red_count_;
    graph.position.resize(size);
    graph.diagonal.resize(size);
    graph.first.assign(size + 1, 0);
    for_cells([&](std::int64_t k) {
      const std::int32_t cell = whole_[k];
      graph.position[k] = all.position[cell];
      // Cells that no heat reaches get temperature zero: an additional heat loss there keeps the system solvable.
      graph.diagonal[k] = all.diagonal[cell] + (scout_.reached[scout_.of_cell[cell]] ? 0.0f : 1.0f);
      for (std::int32_t i = all.first[cell]; i < all.first[cell + 1]; ++i)
        graph.first[k + 1] += number_[all.neighbour[i]] >= 0;
    });
    for (std::int64_t k = 0; k < size; ++k) graph.first[k + 1] += graph.first[k];
    graph.neighbour.resize(graph.first.back());
    graph.conductance.resize(graph.first.back());
    for_cells([&](std::int64_t k) {
      std::int32_t at = graph.first[k];
      for (std::int32_t i = all.first[whole_[k]]; i < all.first[whole_[k] + 1]; ++i)
        if (const std::int32_t other = number_[all.neighbour[i]]; other >= 0) {
          graph.neighbour[at] = other;
          graph.conductance[at++] = all.conductance[i];
        }
    });
    return graph;
  }

  template <class Body>
  void for_cells(const Body& body) const {
    parallel_for(std::ssize(whole_), kCells, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) body(k);
    });
  }

 private:
  const HeatCells& cells_;
  const Scout& scout_;
  std::vector<std::int32_t> number_, whole_;
  std::int32_t red_count_ = 0;
};

// The temperatures that were solved for one block of bones.
struct BlockTemperatures {
  std::vector<int> bones;
  std::vector<std::int32_t> cell;
  ZeroedVector<float> value;  // temperatures, #cells x #bones
};

BlockTemperatures solve_block(const BoneBlock& block, BrickCells& chosen, const Scout& scout, const Sources& sources,
                              const Armature& armature, const HeatDiffusion& settings, const Progress& progress,
                              WeightsReport& report) {
  chosen.choose(block.bricks);
  const auto lanes = std::ssize(block.bones), size = std::ssize(chosen.whole());
  ZeroedVector<float> b(size * lanes), x(size * lanes);
  chosen.for_cells([&](std::int64_t k) {
    for (std::int64_t lane = 0; lane < lanes; ++lane)
      x[k * lanes + lane] = scout.by_bone[block.bones[lane]][scout.of_cell[chosen.whole()[k]]];
  });
  for (std::int64_t lane = 0; lane < lanes; ++lane) {
    const std::vector<CellSource>& own = sources[block.bones[lane]];
    parallel_for(std::ssize(own), kCells, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t s = begin; s < end; ++s)
        if (const std::int64_t k = chosen.number(own[s].cell); k >= 0) b[k * lanes + lane] += own[s].conductance;
    });
  }
  const MultigridReport solved =
      Multigrid(chosen.graph())
          .solve(std::move(b), x, static_cast<int>(lanes), settings.residual, settings.maximum_iterations, progress);
  if (progress.cancelled()) throw Cancelled();
  require_residual(solved, settings.residual, armature.bones[block.bones[0]].name);
  report.residual = std::max(report.residual, solved.residual);
  report.iterations = std::max(report.iterations, solved.iterations);
  chosen.forget();
  return {block.bones, chosen.whole(), std::move(x)};
}

// Sorts the temperatures of all blocks by cell.
CellTemperatures by_cell(std::vector<BlockTemperatures>& blocks, std::int64_t cell_count) {
  CellTemperatures temperatures;
  temperatures.first.assign(cell_count + 1, 0);
  const auto for_entries = [&](const BlockTemperatures& block, const auto& body) {
    const auto lanes = std::ssize(block.bones);
    parallel_for(std::ssize(block.cell), kCells, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k)
        for (std::int64_t lane = 0; lane < lanes; ++lane)
          if (block.value[k * lanes + lane] >= kLeastTemperature)
            body(block.cell[k], static_cast<std::uint16_t>(block.bones[lane]), block.value[k * lanes + lane]);
    });
  };
  for (const BlockTemperatures& block : blocks)
    for_entries(block, [&](std::int32_t cell, std::uint16_t, float) { ++temperatures.first[cell + 1]; });
  for (std::int64_t c = 0; c < cell_count; ++c) temperatures.first[c + 1] += temperatures.first[c];
  temperatures.entries.resize(temperatures.first.back());
  std::vector<std::uint16_t> done(cell_count, 0);
  for (BlockTemperatures& block : blocks) {
    for_entries(block, [&](std::int32_t cell, std::uint16_t bone, float value) {
      temperatures.entries[temperatures.first[cell] + done[cell]++] = {bone, value};
    });
    block = {};
  }
  return temperatures;
}
}  // namespace

CellTemperatures solve_cells(const HeatCells& cells, const Sources& sources, const Armature& armature,
                             const HeatDiffusion& settings, double most_bytes, const ShareOfProgress& share,
                             Progress& progress, WeightsReport& report) {
  const Scout scout = solve_scout(cells.graph, sources, progress);
  progress.update("weights", share.at(1, 4));
  // Memory of a cell: about 110 bytes for its links on all levels, and 28 for each bone's vectors.
  const double cells_of_brick = double(cells.graph.size()) / double(cells.first.size());
  const auto bytes_of_brick = [&](int lanes) { return cells_of_brick * (110 + 28.0 * lanes); };
  const std::vector<BoneBlock> blocks = blocks_of_bones(bricks_with_weight(cells, scout), bytes_of_brick, most_bytes);
  BrickCells chosen(cells, scout);
  std::vector<BlockTemperatures> solved;
  for (const BoneBlock& block : blocks) {
    solved.push_back(solve_block(block, chosen, scout, sources, armature, settings, progress, report));
    progress.update("weights", share.at(blocks.size() + 3 * solved.size(), 4 * blocks.size()));
  }
  return by_cell(solved, cells.graph.size());
}

}  // namespace limber
