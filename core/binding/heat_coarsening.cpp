// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes the first coarse level of a heat system. Connected cells of one block become one coarse cell. A block has 2 x 2
// x 2 cells if voxels are cubes. Blocks never cross the boundary of a brick (8^3 voxels), so bricks are processed
// independently.
#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/binding/heat_system.h"
#include "core/platform/memory_pages.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 32;  // number of bricks in one block of a parallel loop
constexpr int kSlots = HeatSystem::kSlots;

glm::ivec3 stepped(glm::ivec3 voxel, int direction) {
  voxel[direction >> 1] += direction & 1 ? 1 : -1;
  return voxel;
}
bool is_in_brick(const glm::ivec3& voxel) { return ((voxel.x | voxel.y | voxel.z) & ~7) == 0; }

class Coarsening {
 public:
  explicit Coarsening(const HeatSystem& system)
      : system_(system),
        halved_(coarsened_axes(system.spacing)),
        parent_(system.brick_count() * kSlots),
        pieces_(system.brick_count()) {
    want_large_pages(parent_.data(), static_cast<std::int64_t>(parent_.size() * sizeof(std::int32_t)));
    for (int slot = 0; slot < kSlots; ++slot) {
      const glm::ivec3 voxel = HeatSystem::voxel_of(slot), block = block_of(voxel);
      Block& own = blocks_[block.x + 8 * (block.y + 8 * block.z)];
      block_of_slot_[slot] = &own;
      own.place = block;
      own.slots.push_back(slot);
      for (int direction = 0; direction < 6; ++direction) {
        const glm::ivec3 there = stepped(voxel, direction);
        const int to = HeatSystem::slot_of(there & 7);
        const bool is_red = slot < HeatSystem::kColour;
        steps_[slot][direction] = {static_cast<std::int16_t>(to),
                                   static_cast<std::int16_t>(is_red ? direction * HeatSystem::kColour + slot
                                                                    : (direction ^ 1) * HeatSystem::kColour + to),
                                   is_in_brick(there), is_in_brick(there) && block_of(there) == block};
        if (is_red && steps_[slot][direction].stays_in_block) own.links.push_back(steps_[slot][direction].link);
      }
    }
  }

  CoarseHeat run() {
    const std::int64_t bricks = system_.brick_count();
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t brick = begin; brick < end; ++brick) find_pieces(brick);
    });
    number_pieces();
    std::vector<Rows> rows((bricks + kGrain - 1) / kGrain);
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      std::vector<Row> found;
      for (std::int64_t brick = begin; brick < end; ++brick) find_rows(brick, found, rows[begin / kGrain]);
    });
    join(rows);
    CoarseHeat coarse{std::move(graph_), ZeroedVector<std::int32_t>(bricks * HeatSystem::kColour)};
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t brick = begin; brick < end; ++brick)
        std::copy_n(&parent_[brick * kSlots + HeatSystem::kColour], HeatSystem::kColour,
                    &coarse.parent_of_black[brick * HeatSystem::kColour]);
    });
    return coarse;
  }

 private:
  struct Rows {
    std::vector<std::int32_t> cell, count;  // the coarse cell of each row, and the row's number of links
    std::vector<std::int32_t> neighbour;
    std::vector<float> conductance, diagonal;
  };

  // The links of one coarse cell (called a "piece" here). A piece consists of up to eight cells, which have at most 24
  // faces to other cells.
  struct Row {
    int count = 0;
    std::array<std::int32_t, 24> to;
    std::array<float, 24> conductance;
    std::array<int, 6> last;  // index in `to` of the latest link in each direction
    double linked = 0, lost = 0;

    void clear() { count = 0, last = {}, linked = 0, lost = 0; }
    void add(std::int32_t other, float g, int direction) {
      int& known = last[direction];
      if (known >= count || to[known] != other)
        known = static_cast<int>(std::find(to.begin(), to.begin() + count, other) - to.begin());
      if (known == count) {
        to[count] = other;
        conductance[count++] = 0;
      }
      conductance[known] += g;
    }
  };

  // A block of cells, which become one coarse cell if they are connected. `slots` are the cells' slots, the same in
  // every brick. `links` are the links between these slots, as indices into the conductances of a brick.
  struct Block {
    glm::ivec3 place{0};
    std::vector<int> slots, links;
  };
  // A step from a slot to the next one in one of six directions: the slot that it leads to, whether it stays in the
  // same brick and in the same block, and the index of the link between both slots, among the conductances of the brick
  // of the red slot.
  struct Step {
    std::int16_t slot, link;
    bool stays_in_brick, stays_in_block;
  };

  glm::ivec3 block_of(const glm::ivec3& voxel) const { return voxel >> glm::ivec3(halved_); }
  // Returns the conductances from the red slots of a brick.
  const float* conductances_of(std::int64_t brick) const {
    return &system_.conductance[brick * 6 * HeatSystem::kColour];
  }

  // Returns true if every slot of the block has a cell and all adjacent cells in the block are linked.
  bool is_whole(std::int64_t brick, const Block& block) const {
    const float* conductance = conductances_of(brick);
    return std::all_of(block.slots.begin(), block.slots.end(),
                       [&](int slot) { return system_.is_cell(brick, slot); }) &&
           std::all_of(block.links.begin(), block.links.end(), [&](int link) { return conductance[link] > 0; });
  }

  // Numbers the coarse cells of a brick from 0, separately for each colour. Until number_pieces() runs, an entry of
  // `parent_` is twice this number, plus the colour of the block.
  void find_pieces(std::int64_t brick) {
    std::int32_t* parent = &parent_[brick * kSlots];
    const float* conductance = conductances_of(brick);
    std::fill_n(parent, kSlots, -1);
    std::array<int, 8> open;
    std::array<std::int32_t, 2> found{};
    for (int seed = 0; seed < kSlots; ++seed) {
      if (!system_.is_cell(brick, seed) || parent[seed] >= 0) continue;
      const Block& block = *block_of_slot_[seed];
      const int colour = colour_of(brick, block.place);
      const std::int32_t piece = 2 * found[colour]++ + colour;
      if (is_whole(brick, block)) {
        for (const int slot : block.slots) parent[slot] = piece;
        continue;
      }
      int waiting = 0;
      parent[seed] = piece;
      open[waiting++] = seed;
      while (waiting > 0) {
        const int slot = open[--waiting];
        for (int direction = 0; direction < 6; ++direction) {
          const Step& step = steps_[slot][direction];
          if (!step.stays_in_block || parent[step.slot] >= 0 || !(conductance[step.link] > 0)) continue;
          parent[step.slot] = piece;
          open[waiting++] = step.slot;
        }
      }
    }
    pieces_[brick] = found;
  }

  int colour_of(std::int64_t brick, const glm::ivec3& block) const {
    const glm::ivec3 at = block_of(system_.corners[brick]) + block;
    return (at.x + at.y + at.z) & 1;
  }

  // Numbers the coarse cells of all bricks. Colour 0 comes first; within a colour they have the order of the bricks,
  // which keeps neighbours close in memory.
  void number_pieces() {
    graph_.spacing = system_.spacing * glm::dvec3(halved_ + glm::i16vec3(1));
    std::vector<std::array<std::int32_t, 2>> first(pieces_);
    std::int32_t next = 0;
    for (int colour = 0; colour < 2; ++colour) {
      for (auto& of_brick : first) next += std::exchange(of_brick[colour], next);
      if (colour == 0) graph_.red_count = next;
    }
    graph_.position.resize(next);
    parallel_for(system_.brick_count(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t brick = begin; brick < end; ++brick)
        for (int slot = 0; slot < kSlots; ++slot) {
          std::int32_t& parent = parent_[brick * kSlots + slot];
          if (parent < 0) continue;
          parent = first[brick][parent & 1] + (parent >> 1);
          graph_.position[parent] = glm::i16vec3(block_of(system_.corners[brick] + HeatSystem::voxel_of(slot)));
        }
    });
    first_ = std::move(first);
  }

  // Computes the links of the coarse cells of a brick: sums over the faces of their fine cells.
  //   found  working memory, reused from brick to brick
  void find_rows(std::int64_t brick, std::vector<Row>& found, Rows& rows) const {
    const std::array<std::int32_t, 2>& count = pieces_[brick];
    found.resize(count[0] + count[1]);
    for (Row& row : found) row.clear();
    for (int slot = 0; slot < kSlots; ++slot) {
      const std::int32_t parent = parent_[brick * kSlots + slot];
      if (parent < 0) continue;
      Row& row = found[parent < graph_.red_count ? parent - first_[brick][0] : count[0] + parent - first_[brick][1]];
      double own = system_.diagonal[brick * kSlots + slot];
      for (int direction = 0; direction < 6; ++direction) {
        const Step& step = steps_[slot][direction];
        const std::int64_t other = step.stays_in_brick ? brick : system_.beside[brick][direction];
        const float g = conductances_of(slot < HeatSystem::kColour ? brick : other)[step.link];
        if (!(g > 0)) continue;
        own -= g;
        if (step.stays_in_block) continue;  // linked cells of one block belong to the same piece
        const float across = halved_[direction >> 1] ? g * kCoarseConductance : g;
        row.linked += across;
        row.add(parent_[other * kSlots + step.slot], across, direction);
      }
      row.lost += std::max(own, 0.0);
    }
    for (std::int32_t k = 0; k < std::ssize(found); ++k) {
      rows.cell.push_back(k < count[0] ? first_[brick][0] + k : first_[brick][1] + k - count[0]);
      rows.count.push_back(found[k].count);
      rows.diagonal.push_back(static_cast<float>(found[k].linked + kCoarseConductance * found[k].lost));
      rows.neighbour.insert(rows.neighbour.end(), found[k].to.begin(), found[k].to.begin() + found[k].count);
      rows.conductance.insert(rows.conductance.end(), found[k].conductance.begin(),
                              found[k].conductance.begin() + found[k].count);
    }
  }

  void join(std::vector<Rows>& rows) {
    graph_.first.assign(graph_.size() + 1, 0);
    graph_.diagonal.resize(graph_.size());
    for (const Rows& some : rows)
      for (std::size_t k = 0; k < some.cell.size(); ++k) graph_.first[some.cell[k] + 1] = some.count[k];
    for (std::int64_t i = 0; i < graph_.size(); ++i) graph_.first[i + 1] += graph_.first[i];
    graph_.neighbour.resize(graph_.first.back());
    graph_.conductance.resize(graph_.first.back());
    parallel_for(std::ssize(rows), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t r = begin; r < end; ++r) {
        Rows some = std::move(rows[r]);
        std::int64_t from = 0;
        for (std::size_t k = 0; k < some.cell.size(); from += some.count[k++]) {
          const std::int32_t to = graph_.first[some.cell[k]];
          std::copy_n(some.neighbour.begin() + from, some.count[k], graph_.neighbour.begin() + to);
          std::copy_n(some.conductance.begin() + from, some.count[k], graph_.conductance.begin() + to);
          graph_.diagonal[some.cell[k]] = some.diagonal[k];
        }
      }
    });
  }

  const HeatSystem& system_;
  const glm::i16vec3 halved_;
  std::array<Block, kSlots> blocks_;
  std::array<const Block*, kSlots> block_of_slot_;
  std::array<std::array<Step, 6>, kSlots> steps_;
  ZeroedVector<std::int32_t> parent_;                // coarse cell of each slot of each brick; -1: none
  std::vector<std::array<std::int32_t, 2>> pieces_;  // number of coarse cells of each colour in each brick
  std::vector<std::array<std::int32_t, 2>> first_;   // first coarse cell of each colour in each brick
  CellGraph graph_;
};
}  // namespace

CoarseHeat coarsen(const HeatSystem& system) { return Coarsening(system).run(); }

}  // namespace limber
