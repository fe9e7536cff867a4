// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_cells.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop
constexpr int kMostShift = 3;        // blocks have at most 2^3 = 8 voxels along an axis, the size of a brick
// A shorter distance from a cell's centre to a face or to another centre counts as this, voxels.
constexpr float kLeastDistance = 0.5f;

class CellMaker {
 public:
  CellMaker(const BrickWindow::Source& source, const HeatLaw& law, const glm::i16vec3& shift)
      : source_(source),
        law_(law),
        bricks_(source.tissue.bricks()) {
    cells_.shift = shift;
    cells_.graph.spacing = source.volume.grid.spacing * glm::dvec3(1 << shift.x, 1 << shift.y, 1 << shift.z);
    cells_.number_in_brick.assign(source.tissue.size(), HeatCells::kNoCell);
    block_of_.fill(-1);
    for (int z = 0; z < TissueVoxels::kBrick; ++z)
      for (int y = 0; y < TissueVoxels::kBrick; ++y)
        for (int x = 0; x < TissueVoxels::kBrick; ++x) {
          const glm::ivec3 block = glm::ivec3(x, y, z) >> glm::ivec3(shift);
          block_of_[BrickWindow::at({x, y, z})] = static_cast<std::int16_t>(block.x + 8 * (block.y + 8 * block.z));
        }
  }

  HeatCells run() {
    find_cells();
    link_cells();
    return std::move(cells_);
  }

 private:
  struct Piece {
    glm::ivec3 sum{0};  // sum of the positions of the piece's voxels, relative to the brick's lowest corner
    int count = 0;
    int block = 0;
  };
  struct Found {
    std::vector<Piece> pieces;                       // pieces of each brick, the red ones first
    std::vector<std::array<std::int32_t, 2>> count;  // number of red and of black pieces in each brick
  };

  struct LinkSum {
    std::int32_t to;
    int axis;
    float conducted;  // sum of the conductances of the faces, as if the cells' centres were one voxel apart
  };
  // The links of one cell.
  struct Row {
    std::vector<LinkSum> links;
    std::vector<HeldSide> sides;
  };
  struct Rows {
    std::vector<std::int32_t> cell, links, sides;  // each cell, and the numbers of its links and sides
    std::vector<std::int32_t> neighbour;
    std::vector<float> conductance, diagonal;
    std::vector<HeldSide> held;
  };

  static glm::ivec3 block_at(int block) { return {block & 7, block >> 3 & 7, block >> 6}; }
  glm::ivec3 first_block(std::int64_t brick) const { return bricks_[brick].corner >> glm::ivec3(cells_.shift); }
  int colour_of(std::int64_t brick, int block) const {
    const glm::ivec3 at = first_block(brick) + block_at(block);
    return (at.x + at.y + at.z) & 1;
  }

  template <class Body>
  void for_soft(std::int64_t brick, const BrickWindow& window, const Body& body) const {
    const glm::ivec3 corner = bricks_[brick].corner;
    source_.tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      if (const int here = BrickWindow::at(v - corner); window.soft[here] > 0) body(v, place, here);
    });
  }

  // Finds the cells of a brick by flood fill. Each fill starts at the first voxel of a block that is in no cell yet.
  void find_in_brick(std::int64_t brick, BrickWindow& window, Found& found) {
    window.look(source_, brick);
    const glm::ivec3 corner = bricks_[brick].corner;
    std::array<std::int16_t, 1000> piece_of;
    piece_of.fill(-1);
    std::array<std::pair<int, glm::ivec3>, 512> open;
    std::vector<Piece> pieces;
    for_soft(brick, window, [&](const glm::ivec3& seed, std::int64_t, int seed_here) {
      if (piece_of[seed_here] >= 0) return;
      const auto number = static_cast<std::int16_t>(pieces.size());
      Piece piece;
      piece.block = block_of_[seed_here];
      int waiting = 0;
      piece_of[seed_here] = number;
      open[waiting++] = {seed_here, seed};
      while (waiting > 0) {
        const auto [here, v] = open[--waiting];
        piece.sum += v - corner;
        ++piece.count;
        for (int direction = 0; direction < 6; ++direction) {
          const int there = here + BrickWindow::kTo[direction];
          if (block_of_[there] != piece.block || window.soft[there] == 0 || piece_of[there] >= 0) continue;
          if (window.is_cut(v, direction)) continue;
          glm::ivec3 w = v;
          w[direction >> 1] += direction & 1 ? 1 : -1;
          piece_of[there] = number;
          open[waiting++] = {there, w};
        }
      }
      pieces.push_back(piece);
    });

    std::vector<std::uint16_t> order(pieces.size());
    std::array<std::int32_t, 2> count{};
    std::uint16_t next = 0;
    for (int colour = 0; colour < 2; ++colour)
      for (std::size_t k = 0; k < pieces.size(); ++k)
        if (colour_of(brick, pieces[k].block) == colour) {
          order[k] = next++;
          ++count[colour];
          found.pieces.push_back(pieces[k]);
        }
    found.count.push_back(count);
    for_soft(brick, window, [&](const glm::ivec3&, std::int64_t place, int here) {
      cells_.number_in_brick[place] = order[piece_of[here]];
    });
  }

  void find_cells() {
    const std::int64_t bricks = std::ssize(bricks_);
    std::vector<Found> found((bricks + kGrain - 1) / kGrain);
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      BrickWindow window;
      for (std::int64_t brick = begin; brick < end; ++brick) find_in_brick(brick, window, found[begin / kGrain]);
    });

    cells_.first.resize(bricks + 1);
    std::int32_t next = 0;
    for (int colour = 0; colour < 2; ++colour) {
      for (std::int64_t brick = 0; brick < bricks; ++brick) {
        cells_.first[brick][colour] = next;
        next += found[brick / kGrain].count[brick % kGrain][colour];
      }
      cells_.first[bricks][colour] = next;
      if (colour == 0) cells_.graph.red_count = next;
    }
    cells_.graph.position.resize(next);
    cells_.centre.resize(next);
    parallel_for(std::ssize(found), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) {
        const Piece* piece = found[k].pieces.data();
        for (std::int64_t brick = k * kGrain; brick < std::min(bricks, (k + 1) * kGrain); ++brick)
          for (std::int32_t number = 0; number < cells_.cell_count(brick); ++number, ++piece) {
            const std::int32_t cell = cells_.cell(brick, number);
            cells_.graph.position[cell] = glm::i16vec3(first_block(brick) + block_at(piece->block));
            cells_.centre[cell] =
                glm::vec3(bricks_[brick].corner) + glm::vec3(piece->sum) / static_cast<float>(piece->count);
          }
        found[k] = {};
      }
    });
  }

  void add_link(Row& row, std::int32_t to, int axis, float conducted) const {
    for (auto link = row.links.rbegin(); link != row.links.rend(); ++link)
      if (link->to == to) {
        link->conducted += conducted;
        return;
      }
    row.links.push_back({to, axis, conducted});
  }
  // Adds the face between a cell and the voxel `there`, which is held by a bone.
  void add_side(Row& row, std::int32_t cell, std::uint16_t bone, int direction, float conducted,
                const glm::ivec3& there) const {
    const auto distance = [&](const glm::ivec3& voxel) {
      const glm::vec3 way = (glm::vec3(voxel) - cells_.centre[cell]) * glm::vec3(source_.volume.grid.spacing);
      return glm::dot(way, way);
    };
    for (HeldSide& side : row.sides)
      if (side.bone == bone && side.direction == direction) {
        side.conductance += conducted;
        if (distance(there) < distance(glm::ivec3(side.nearest))) side.nearest = glm::i16vec3(there);
        return;
      }
    row.sides.push_back({cell, bone, static_cast<std::uint8_t>(direction), conducted, glm::i16vec3(there)});
  }

  // Adds the links of a brick's cells.
  //   found  working memory, reused from brick to brick
  void link_in_brick(std::int64_t brick, BrickWindow& window, std::vector<Row>& found, Rows& rows) const {
    window.look(source_, brick);
    const std::int32_t count = cells_.cell_count(brick);
    if (std::ssize(found) < count) found.resize(count);
    for (std::int32_t k = 0; k < count; ++k) found[k].links.clear(), found[k].sides.clear();
    for_soft(brick, window, [&](const glm::ivec3& v, std::int64_t place, int here) {
      const std::uint16_t number = cells_.number_in_brick[place];
      const std::int32_t cell = cells_.cell(brick, number);
      for (int direction = 0; direction < 6; ++direction) {
        const int there = here + BrickWindow::kTo[direction], axis = direction >> 1;
        // Skips a face inside the cell or a face that a seam cuts.
        if (block_of_[there] == block_of_[here] && window.soft[there] > 0) continue;
        const std::int32_t beyond = window.place[there];
        if (beyond < 0 || window.is_cut(v, direction)) continue;
        const float conducted = law_.conductance(axis, window.soft[here], window.soft[there]);
        if (window.soft[there] == 0) {
          glm::ivec3 w = v;
          w[axis] += direction & 1 ? 1 : -1;
          const float to_face = std::abs(0.5f * static_cast<float>(v[axis] + w[axis]) - cells_.centre[cell][axis]);
          add_side(found[number], cell, source_.held_by[beyond], direction,
                   conducted * kLeastDistance / std::max(to_face, kLeastDistance), w);
        } else {
          const std::int64_t in = block_of_[there] >= 0 ? brick : window.beside[direction];
          add_link(found[number], cells_.cell(in, cells_.number_in_brick[beyond]), axis, conducted);
        }
      }
    });
    for (std::int32_t k = 0; k < count; ++k) write_row(cells_.cell(brick, k), found[k], rows);
  }

  void write_row(std::int32_t cell, const Row& row, Rows& rows) const {
    double diagonal = 0;
    for (const LinkSum& link : row.links) {
      const float apart = std::abs(cells_.centre[link.to][link.axis] - cells_.centre[cell][link.axis]);
      rows.neighbour.push_back(link.to);
      rows.conductance.push_back(link.conducted / std::max(apart, kLeastDistance));
      diagonal += rows.conductance.back();
    }
    for (const HeldSide& side : row.sides) diagonal += side.conductance;
    rows.held.insert(rows.held.end(), row.sides.begin(), row.sides.end());
    rows.cell.push_back(cell);
    rows.links.push_back(static_cast<std::int32_t>(row.links.size()));
    rows.sides.push_back(static_cast<std::int32_t>(row.sides.size()));
    rows.diagonal.push_back(static_cast<float>(diagonal));
  }

  void link_cells() {
    const std::int64_t bricks = std::ssize(bricks_);
    std::vector<Rows> rows((bricks + kGrain - 1) / kGrain);
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      BrickWindow window;
      std::vector<Row> found;
      for (std::int64_t brick = begin; brick < end; ++brick) link_in_brick(brick, window, found, rows[begin / kGrain]);
    });
    CellGraph& graph = cells_.graph;
    graph.first.assign(graph.size() + 1, 0);
    graph.diagonal.resize(graph.size());
    cells_.side_from.assign(graph.size() + 1, 0);
    for (const Rows& some : rows)
      for (std::size_t k = 0; k < some.cell.size(); ++k) {
        graph.first[some.cell[k] + 1] = some.links[k];
        cells_.side_from[some.cell[k] + 1] = some.sides[k];
      }
    for (std::int64_t c = 0; c < graph.size(); ++c) {
      graph.first[c + 1] += graph.first[c];
      cells_.side_from[c + 1] += cells_.side_from[c];
    }
    graph.neighbour.resize(graph.first.back());
    graph.conductance.resize(graph.first.back());
    cells_.sides.resize(cells_.side_from.back());
    parallel_for(std::ssize(rows), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t r = begin; r < end; ++r) place_rows(std::exchange(rows[r], {}));
    });
  }
  void place_rows(const Rows& rows) {
    CellGraph& graph = cells_.graph;
    std::int64_t link = 0, side = 0;
    for (std::size_t k = 0; k < rows.cell.size(); link += rows.links[k], side += rows.sides[k++]) {
      const std::int32_t cell = rows.cell[k];
      std::copy_n(rows.neighbour.begin() + link, rows.links[k], graph.neighbour.begin() + graph.first[cell]);
      std::copy_n(rows.conductance.begin() + link, rows.links[k], graph.conductance.begin() + graph.first[cell]);
      std::copy_n(rows.held.begin() + side, rows.sides[k], cells_.sides.begin() + cells_.side_from[cell]);
      graph.diagonal[cell] = rows.diagonal[k];
    }
  }

  const BrickWindow::Source source_;
  const HeatLaw& law_;
  const std::vector<TissueVoxels::Brick>& bricks_;
  HeatCells cells_;
  std::array<std::int16_t, 1000> block_of_;  // block of each voxel of a window; -1: outside the brick
};
}  // namespace

HeatCells make_heat_cells(const BrickWindow::Source& source, const HeatLaw& law, const glm::i16vec3& shift) {
  return CellMaker(source, law, shift).run();
}

glm::i16vec3 shift_of_cells(const Grid& grid, std::int64_t tissue_voxels, std::int64_t most_cells) {
  glm::i16vec3 shift(0);
  glm::dvec3 size = grid.spacing;
  for (std::int64_t cells = tissue_voxels; cells > most_cells;) {
    const glm::i16vec3 doubled = coarsened_axes(size);
    bool grows = false;
    for (int axis = 0; axis < 3; ++axis) {
      if (!doubled[axis] || shift[axis] == kMostShift) continue;
      ++shift[axis];
      size[axis] *= 2;
      cells /= 2;
      grows = true;
    }
    if (!grows) break;
  }
  return shift;
}

}  // namespace limber
