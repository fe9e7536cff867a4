// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/lattice_net.h"

#include <algorithm>
#include <memory>
#include <unordered_map>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/faces_at_seams.h"
#include "core/mesh/surface_net.h"
#include "core/mesh/voxel_ball.h"

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;
constexpr int kPushes = 12;  // upper limit on pushes of one point outwards; after that, samples become tissue
constexpr int kRounds = 90;
constexpr std::int64_t kBricks = 64, kVoxels = 4096;  // bricks per task, voxels per task

using Cell = SampleLattice::Cell;

// Returns, in order, the voxels for which passes() is true.
//   count                     size of the range that is split over threads
//   voxels(begin, end, body)  calls body(voxel) for each voxel of a part of that range
template <class Voxels, class Passes>
std::vector<glm::ivec3> select(std::int64_t count, std::int64_t grain, const Voxels& voxels, const Passes& passes) {
  std::vector<std::vector<glm::ivec3>> found((count + grain - 1) / grain);
  parallel_for(count, grain, [&](std::int64_t begin, std::int64_t end) {
    voxels(begin, end, [&](const glm::ivec3& v) {
      if (passes(v)) found[begin / grain].push_back(v);
    });
  });
  std::vector<glm::ivec3> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

// Returns the tissue voxels in those cells that contain air, in brick order. Only these voxels can be outside the
// surface.
std::vector<glm::ivec3> find_near_air(const SurfaceNet& net, const SmallestCells& smallest,
                                      const TissueVoxels& tissue) {
  return select(
      std::ssize(tissue.bricks()), kBricks,
      [&](std::int64_t begin, std::int64_t end, const auto& body) {
        tissue.for_each(begin, end, [&](std::int64_t, const glm::ivec3& v) { body(v); });
      },
      [&](const glm::ivec3& v) { return net.is_near_air(smallest(v)); });
}

std::vector<glm::ivec3> find_outside(const SurfaceNet& net, const SampleLattice& lattice,
                                     const std::vector<glm::ivec3>& near_air) {
  return select(
      std::ssize(near_air), kVoxels,
      [&](std::int64_t begin, std::int64_t end, const auto& body) {
        std::for_each(&near_air[begin], &near_air[0] + end, body);
      },
      [&](const glm::ivec3& v) { return net.is_air(lattice.fine_from_voxel * glm::dvec3(v)); });
}

// Returns those voxels of `outside` (outside the surface) that have no tissue voxel inside the surface within
// kNearVoxels.
std::vector<glm::ivec3> find_missed(const SurfaceNet& net, const SampleLattice& lattice, const TissueVoxels& tissue,
                                    const Grid& grid, const std::vector<glm::ivec3>& outside) {
  const auto is_near_inside = [&](const glm::ivec3& v) {
    return any_voxel_near(v, grid, kNearVoxels, [&](const glm::ivec3& near) {
      return tissue.index_of(near) >= 0 && !net.is_air(lattice.fine_from_voxel * glm::dvec3(near));
    });
  };
  return select(
      std::ssize(outside), kVoxels,
      [&](std::int64_t begin, std::int64_t end, const auto& body) {
        std::for_each(&outside[begin], &outside[0] + end, body);
      },
      [&](const glm::ivec3& v) { return !is_near_inside(v); });
}

struct Missed {
  Cell cell;
  glm::dvec3 sum{0};  // sum of the positions of the cell's tissue voxels outside the surface, lattice steps
  int count = 0;
  glm::dvec3 place() const { return sum / double(count); }
};

// Returns the cells that have tissue voxels outside the surface, the cells with the most such voxels first.
std::vector<Missed> cells_that_miss(const SampleLattice& lattice, const std::vector<glm::ivec3>& outside) {
  std::unordered_map<std::int64_t, std::size_t> place_of;
  std::vector<Missed> missed;
  for (const glm::ivec3& v : outside) {
    const glm::dvec3 at = lattice.fine_from_voxel * glm::dvec3(v);
    const Cell cell = lattice.cell(glm::ivec3(glm::floor(at)));
    const auto [known, is_new] = place_of.emplace(lattice.index(cell.corner), missed.size());
    if (is_new) missed.push_back({cell});
    missed[known->second].sum += at;
    ++missed[known->second].count;
  }
  std::stable_sort(missed.begin(), missed.end(), [](const Missed& a, const Missed& b) { return a.count > b.count; });
  return missed;
}

// Returns one lattice edge for each cell that has tissue voxels outside the surface: of the edges between tissue and
// air, the one whose point of the surface net is nearest to the mean of these voxels. Null: there is no such edge.
std::vector<const SurfaceNet::Edge*> nearest_edges(const SurfaceNet& net, const std::vector<Missed>& missed) {
  std::vector<int> miss_at(net.nodes().size(), -1);
  for (std::size_t m = 0; m < missed.size(); ++m)
    if (const int node = net.node_of(missed[m].cell); node >= 0) miss_at[node] = static_cast<int>(m);
  std::vector<const SurfaceNet::Edge*> nearest(missed.size(), nullptr);
  for (const SurfaceNet::Edge& edge : net.edges()) {
    if (edge.first != kAir && edge.second != kAir) continue;
    for (const int cell : edge.cell) {
      if (miss_at[cell] < 0) continue;
      const auto far = [&](const SurfaceNet::Edge& from) {
        return glm::distance(net.nodes()[from.node].place, missed[miss_at[cell]].place());
      };
      const SurfaceNet::Edge*& best = nearest[miss_at[cell]];
      if (!best || far(edge) < far(*best)) best = &edge;
    }
  }
  return nearest;
}

// Pushes one of two points of the net outwards: the point in the cell, or the point on `edge`. Selects the one nearer
// to the cell's voxels outside the surface, or the other one if the nearer one has reached its limit of pushes. Pushing
// only one point keeps the surface close to the voxels; late rounds push both, to finish sooner. Returns false if both
// have reached their limit.
bool push(const SurfaceNet& net, const SampleLattice& lattice, const Missed& miss, const SurfaceNet::Edge* edge,
          int round, Pushes& pushes) {
  const int node = net.node_of(miss.cell);
  if (node < 0) return false;
  std::uint8_t none = kPushes;
  std::uint8_t& of_cell = pushes.cell[lattice.index(miss.cell.corner)];
  std::uint8_t& of_edge = edge ? pushes.edge[edge->axis][lattice.index(edge->from)] : none;
  const bool cell_first = !edge || glm::distance(miss.place(), net.nodes()[node].place) <
                                       glm::distance(miss.place(), net.nodes()[edge->node].place);
  std::uint8_t &first = cell_first ? of_cell : of_edge, &second = cell_first ? of_edge : of_cell;
  const bool first_can = first < kPushes, pushes_second = second < kPushes && (!first_can || round >= kRounds / 2);
  first += first_can;
  second += pushes_second;
  return first_can || pushes_second;
}

// Moves the surface towards voxels outside it, for at least `to_gain` of these voxels, starting with the cells that
// have most of them: pushes points of the net outwards, or makes samples tissue. Returns true if a sample became
// tissue.
bool make_room(const SurfaceNet& net, SampleLattice& lattice, const std::vector<Missed>& missed, std::int64_t to_gain,
               int round, Pushes& pushes) {
  bool any_became = false;
  const auto become_tissue = [&](const glm::ivec3& p) {
    const std::int64_t at = lattice.index(p);
    const bool was_air = lattice.label[at] == kAir;
    if (was_air) lattice.label[at] = lattice.soft_at(at), any_became = true;
    return was_air;
  };
  const auto nearest = nearest_edges(net, missed);
  for (std::size_t m = 0; m < missed.size() && to_gain > 0; ++m) {
    const Missed& miss = missed[m];
    const Cell& cell = miss.cell;
    to_gain -= miss.count;
    if (round < kRounds * 3 / 4 && push(net, lattice, miss, nearest[m], round, pushes)) continue;
    const glm::dvec3 inside = miss.place() - glm::dvec3(cell.corner);
    const bool nearest_was_air =
        become_tissue(cell.corner + glm::ivec3(glm::greaterThan(inside, glm::dvec3(0.5 * cell.size))) * cell.size);
    if (nearest_was_air && round < kRounds / 2) continue;
    for (int z = 0; z <= cell.size; ++z)
      for (int y = 0; y <= cell.size; ++y)
        for (int x = 0; x <= cell.size; ++x)
          if (lattice.has_sample(cell.corner + glm::ivec3(x, y, z))) become_tissue(cell.corner + glm::ivec3(x, y, z));
  }
  return any_became;
}

LatticeNet finished(const SurfaceNet& net, const SampleLattice& lattice, const VoxelRegions& voxels) {
  LatticeNet result;
  result.world_from_lattice = lattice.world_from_lattice;
  result.spacing_mm = lattice.spacing_mm;
  result.mesh = net.tets();
  const auto count = static_cast<Eigen::Index>(net.nodes().size());
  result.surface.V = result.mesh.V.topRows(count);
  result.low.resize(count, 3), result.high.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const glm::dvec3 low = net.nodes()[i].low * lattice.step, high = net.nodes()[i].high * lattice.step;
    result.low.row(i) << low.x, low.y, low.z;
    result.high.row(i) << high.x, high.y, high.z;
  }
  std::vector<std::array<int, 3>> triangles;
  const bool mirrored = glm::determinant(lattice.world_from_lattice.linear) < 0;
  net.for_each_triangle([&](int a, int b, int c, const SurfaceNet::Edge& edge) {
    if (mirrored) std::swap(b, c);
    triangles.push_back({a, b, c});
    result.surface.sides.push_back({edge.second, edge.first});
  });
  result.surface.F.resize(triangles.size(), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    result.surface.F.row(i) << triangles[i][0], triangles[i][1], triangles[i][2];
  if (voxels.sides) {
    result.cut = faces_at_seams(voxels, lattice, net);
    smooth_seams(result);
  }
  return result;
}

}  // namespace

LatticeNet lattice_net(const VoxelRegions& voxels, const LatticeNetSettings& settings, Progress& progress) {
  if (voxels.tissue.size() == 0) return {};
  progress.update("surface", 0);
  SampleLattice lattice = sample_regions(voxels, settings);
  const VoxelLookup voxel_at(voxels, lattice);
  const SmallestCells smallest(lattice, voxels.grid);
  Pushes pushes(lattice.label.size());
  const auto allowed = static_cast<std::int64_t>((1 - settings.least_near) * double(voxels.tissue.size()));
  auto net = std::make_unique<SurfaceNet>(lattice, voxel_at);
  std::vector<glm::ivec3> near_air, outside;
  bool is_known = false;  // true: near_air was found for the current net
  for (int round = 0;; ++round) {
    progress.update("surface", 1 - 1 / (1 + 0.3 * (round + 1)));
    net->place(pushes);
    const auto missed = [&](const std::vector<glm::ivec3>& among) {
      return find_missed(*net, lattice, voxels.tissue, voxels.grid, find_outside(*net, lattice, among));
    };
    if (round > 0) outside = missed(outside);
    if (round == 0 || std::ssize(outside) <= allowed) {  // other voxels may be outside after points have moved
      if (!std::exchange(is_known, true)) near_air = find_near_air(*net, smallest, voxels.tissue);
      outside = missed(near_air);
    }
    if (std::ssize(outside) <= allowed || round == kRounds) {
      LatticeNet result = finished(*net, lattice, voxels);
      const double all = double(voxels.tissue.size());
      result.near = 1 - double(outside.size()) / all;
      if (!is_known) near_air = find_near_air(*net, smallest, voxels.tissue);
      result.covered = 1 - double(find_outside(*net, lattice, near_air).size()) / all;
      return result;
    }
    if (make_room(*net, lattice, cells_that_miss(lattice, outside), std::ssize(outside) - allowed, round, pushes)) {
      net = std::make_unique<SurfaceNet>(lattice, voxel_at);
      is_known = false;
    }
  }
}

}  // namespace limber
