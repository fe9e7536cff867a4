// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/multigrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <type_traits>
#include <utility>

#include <Eigen/Dense>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 1024;  // number of cells in one block of a parallel loop
// Levels are made until one has at most this many cells; this coarsest level is solved directly.
constexpr std::int64_t kCoarsestSize = 64;
constexpr int kMostLevels = 12;

int colour_of(const glm::i16vec3& p) { return (p.x + p.y + p.z) & 1; }
}  // namespace

glm::i16vec3 coarsened_axes(const glm::dvec3& spacing) {
  const double closest = std::min({spacing.x, spacing.y, spacing.z});
  return {spacing.x < 1.5 * closest, spacing.y < 1.5 * closest, spacing.z < 1.5 * closest};
}

namespace {

// Returns the number of the block that contains each cell.
std::vector<std::uint64_t> blocks_of(const CellGraph& graph, const glm::i16vec3& halved) {
  std::vector<std::uint64_t> blocks(graph.size());
  parallel_for(graph.size(), 16 * kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const glm::u16vec3 block(graph.position[i] >> halved);
      blocks[i] = block.x | std::uint64_t{block.y} << 16 | std::uint64_t{block.z} << 32;
    }
  });
  return blocks;
}

// Calls body(cell) for each cell of the connected set of cells that contains `seed` within one block.
//   is_open  returns true if the search may enter a cell; after body(cell), it must return false for that cell
template <class IsOpen, class Body>
void search_block(const CellGraph& graph, const std::vector<std::uint64_t>& block, std::int32_t seed,
                  std::vector<std::int32_t>& open, const IsOpen& is_open, const Body& body) {
  open.assign(1, seed);
  body(seed);
  while (!open.empty()) {
    const std::int32_t i = open.back();
    open.pop_back();
    for (std::int32_t k = graph.first[i]; k < graph.first[i + 1]; ++k) {
      const std::int32_t j = graph.neighbour[k];
      if (block[j] != block[seed] || !is_open(j)) continue;
      body(j);
      open.push_back(j);
    }
  }
}

// Returns the first cell of the connected set in one block that contains each cell; -1 for a cell that is left out. A
// search of the connected set starts at every cell whose neighbours in the block all have higher indices. Only the
// search that starts at the set's first cell writes the result, for all cells of the set. So no two threads write to
// the same cell.
std::vector<std::int32_t> first_of_sets(const CellGraph& graph, const glm::i16vec3& halved, LoneCells lone) {
  std::vector<std::int32_t> first(graph.size(), -1);
  const std::vector<std::uint64_t> block = blocks_of(graph, halved);
  const auto may_be_first = [&](std::int32_t i) {
    for (std::int32_t k = graph.first[i]; k < graph.first[i + 1]; ++k)
      if (const std::int32_t j = graph.neighbour[k]; j < i && block[j] == block[i]) return false;
    return lone == LoneCells::Keep || graph.first[i] < graph.first[i + 1];
  };
  parallel_for(graph.size(), 16 * kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::int32_t> set, open;
    for (auto seed = static_cast<std::int32_t>(begin); seed < end; ++seed) {
      if (!may_be_first(seed)) continue;
      set.clear();
      search_block(
          graph, block, seed, open, [&](std::int32_t j) { return std::find(set.begin(), set.end(), j) == set.end(); },
          [&](std::int32_t j) { set.push_back(j); });
      if (*std::min_element(set.begin(), set.end()) < seed) continue;
      for (const std::int32_t j : set) first[j] = seed;
    }
  });
  return first;
}

// Numbers the cells of the next level. Each of them is a connected set of cells within one block, which has 2 x 2 x 2
// cells if cells are cubes. Returns the coarse cell of each cell; -1 for a cell that is left out.
std::vector<std::int32_t> aggregate(const CellGraph& fine, CellGraph& coarse, LoneCells lone) {
  const glm::i16vec3 halved = coarsened_axes(fine.spacing);
  coarse.spacing = fine.spacing * glm::dvec3(halved + glm::i16vec3(1));
  std::vector<std::int32_t> parent = first_of_sets(fine, halved, lone);
  std::vector<std::int32_t> seeds;
  for (std::int32_t i = 0; i < fine.size(); ++i)
    if (parent[i] == i) seeds.push_back(i);

  // Coarse cells of colour 0 come first. Within a colour, coarse cells have the order of their first fine cells, which
  // keeps neighbours close in memory.
  std::vector<std::int32_t> number(fine.size());
  for (int colour = 0; colour < 2; ++colour) {
    for (const std::int32_t seed : seeds)
      if (const glm::i16vec3 block = fine.position[seed] >> halved; colour_of(block) == colour) {
        number[seed] = static_cast<std::int32_t>(coarse.position.size());
        coarse.position.push_back(block);
      }
    if (colour == 0) coarse.red_count = static_cast<std::int32_t>(coarse.position.size());
  }
  parallel_for(fine.size(), 16 * kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (parent[i] >= 0) parent[i] = number[parent[i]];
  });
  return parent;
}

// Lists, for each aggregate (coarse cell), its cells with an index below `count`. The lists are stored one after the
// other in `child`; `first` contains the index at which each list begins.
void list_children(const std::vector<std::int32_t>& parent, std::int64_t count, std::int64_t aggregates,
                   std::vector<std::int32_t>& first, std::vector<std::int32_t>& child) {
  first.assign(aggregates + 1, 0);
  for (std::int64_t i = 0; i < count; ++i)
    if (parent[i] >= 0) ++first[parent[i] + 1];
  for (std::int64_t c = 0; c < aggregates; ++c) first[c + 1] += first[c];
  child.resize(first.back());
  std::vector<std::int32_t> place(first.begin(), first.end() - 1);
  for (std::int64_t i = 0; i < count; ++i)
    if (parent[i] >= 0) child[place[parent[i]]++] = static_cast<std::int32_t>(i);
}

}  // namespace

CellGraph coarsen(const CellGraph& fine, std::vector<std::int32_t>& parent, LoneCells lone) {
  CellGraph coarse;
  parent = aggregate(fine, coarse, lone);
  const std::int64_t size = coarse.size();
  std::vector<std::int32_t> child_first, child;
  list_children(parent, fine.size(), size, child_first, child);

  const glm::i16vec3 halved = coarsened_axes(fine.spacing);
  const auto across = [&](const glm::i16vec3& step) {
    const int axis = step.x != 0 ? 0 : step.y != 0 ? 1 : 2;
    return halved[axis] ? kCoarseConductance : 1.0f;
  };
  struct Links {
    std::vector<std::int32_t> neighbour;
    std::vector<float> conductance;
  };
  std::vector<Links> blocks((size + kGrain - 1) / kGrain);
  coarse.first.assign(size + 1, 0);
  coarse.diagonal.assign(size, 0);
  const auto link = [&](std::int32_t c, Links& links) {
    const std::size_t start = links.neighbour.size();
    double linked = 0, lost = 0;
    for (std::int32_t m = child_first[c]; m < child_first[c + 1]; ++m) {
      const std::int32_t i = child[m];
      double own = fine.diagonal[i];
      for (std::int32_t k = fine.first[i]; k < fine.first[i + 1]; ++k) {
        own -= fine.conductance[k];
        const std::int32_t d = parent[fine.neighbour[k]];
        if (d == c) continue;
        std::size_t at = start;
        while (at < links.neighbour.size() && links.neighbour[at] != d) ++at;
        if (at == links.neighbour.size()) {
          links.neighbour.push_back(d);
          links.conductance.push_back(0);
        }
        const float g = fine.conductance[k] * across(coarse.position[c] - coarse.position[d]);
        links.conductance[at] += g;
        linked += g;
      }
      lost += std::max(own, 0.0);
    }
    coarse.diagonal[c] = static_cast<float>(linked + kCoarseConductance * lost);
    coarse.first[c + 1] = static_cast<std::int32_t>(links.neighbour.size() - start);
  };
  parallel_for(size, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t c = begin; c < end; ++c) link(static_cast<std::int32_t>(c), blocks[begin / kGrain]);
  });
  for (std::int64_t c = 0; c < size; ++c) coarse.first[c + 1] += coarse.first[c];
  coarse.neighbour.resize(coarse.first.back());
  coarse.conductance.resize(coarse.first.back());
  parallel_for(std::ssize(blocks), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t block = begin; block < end; ++block) {
      const Links links = std::exchange(blocks[block], {});
      const std::int32_t from = coarse.first[block * kGrain];
      std::copy(links.neighbour.begin(), links.neighbour.end(), coarse.neighbour.begin() + from);
      std::copy(links.conductance.begin(), links.conductance.end(), coarse.conductance.begin() + from);
    }
  });
  return coarse;
}

void require_residual(const MultigridReport& solved, double residual, const std::string& bone) {
  if (solved.residual <= residual) return;
  char text[64];
  std::snprintf(text, sizeof text, "%.1e after %d iterations", solved.residual, solved.iterations);
  throw Error("the heat solve stopped at a residual of " + std::string(text), bone,
              "check that the volume's spacing is right, or use --method geodesic");
}

Multigrid::Multigrid(CellGraph finest) {
  levels_.push_back({std::move(finest), {}});
  while (levels_.back().graph.size() > kCoarsestSize && std::ssize(levels_) < kMostLevels) {
    // Cells without neighbours are not coarsened, since relaxation solves them exactly.
    Level next;
    next.graph = coarsen(levels_.back().graph, levels_.back().parent);
    if (next.graph.size() == 0 || next.graph.size() == levels_.back().graph.size()) {
      levels_.back().parent.clear();
      break;
    }
    Level& level = levels_.back();
    list_children(level.parent, level.graph.red_count, next.graph.size(), level.first_red, level.red);
    levels_.push_back(std::move(next));
  }
  const CellGraph& graph = levels_.back().graph;
  if (graph.size() > 8 * kCoarsestSize) return;  // the graph has many small components; relaxation solves them
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(graph.size(), graph.size());
  for (std::int64_t i = 0; i < graph.size(); ++i) {
    dense(i, i) += graph.diagonal[i];
    for (std::int32_t k = graph.first[i]; k < graph.first[i + 1]; ++k)
      dense(i, graph.neighbour[k]) -= graph.conductance[k];
  }
  const Eigen::MatrixXd inverse = dense.ldlt().solve(Eigen::MatrixXd::Identity(graph.size(), graph.size()));
  if (inverse.allFinite()) coarsest_inverse_.assign(inverse.data(), inverse.data() + inverse.size());
}

template <int Lanes>
class Multigrid::Solver {
 public:
  using Sums = std::array<double, Lanes>;

  explicit Solver(const Multigrid& grid) : grid_(grid), at_(grid.levels_.size()) {
    for (size_t l = 0; l < at_.size(); ++l) {
      at_[l].x.resize(grid.levels_[l].graph.size() * Lanes);
      if (l > 0) at_[l].b.resize(at_[l].x.size());
    }
  }

  MultigridReport solve(ZeroedVector<float> b, ZeroedVector<float>& x, double residual, int most_iterations,
                        const Progress& progress) {
    const CellGraph& graph = grid_.finest();
    ZeroedVector<float> p(b.size()), q(b.size());
    const Sums bb = sum_over(graph.size(), [&](std::int64_t i, Sums& sums) {
      for (int l = 0; l < Lanes; ++l) sums[l] += double(b[i * Lanes + l]) * b[i * Lanes + l];
    });
    ZeroedVector<float>& r = b;  // from here on, b is the residual
    Sums rr = sum_over(graph.size(), [&](std::int64_t i, Sums& sums) {
      float acc[Lanes];
      gather(graph, x.data(), i, acc);
      for (int l = 0; l < Lanes; ++l) {
        const float value = b[i * Lanes + l] + acc[l] - graph.diagonal[i] * x[i * Lanes + l];
        r[i * Lanes + l] = value;
        sums[l] += double(value) * value;
      }
    });

    MultigridReport report;
    std::array<bool, Lanes> open;
    auto check = [&] {
      bool any = false;
      report.residual = 0;
      for (int l = 0; l < Lanes; ++l) {
        const double relative = bb[l] > 0 ? std::sqrt(rr[l] / bb[l]) : 0;
        report.residual = std::max(report.residual, relative);
        open[l] = relative > residual;
        any |= open[l];
      }
      return any;
    };
    Sums rz_before{};
    while (check() && report.iterations < most_iterations && !progress.cancelled()) {
      ZeroedVector<float>& z = at_[0].x;
      cycle(0, r, false);
      const Sums rz = sum_over(graph.size(), [&](std::int64_t i, Sums& sums) {
        for (int l = 0; l < Lanes; ++l) sums[l] += double(r[i * Lanes + l]) * z[i * Lanes + l];
      });
      float beta[Lanes], alpha[Lanes];
      for (int l = 0; l < Lanes; ++l)
        beta[l] = open[l] && report.iterations > 0 && rz_before[l] > 0 ? static_cast<float>(rz[l] / rz_before[l]) : 0;
      for_cells(graph.size(), [&](std::int64_t i) {
        for (int l = 0; l < Lanes; ++l) p[i * Lanes + l] = z[i * Lanes + l] + beta[l] * p[i * Lanes + l];
      });
      const Sums pq = sum_over(graph.size(), [&](std::int64_t i, Sums& sums) {
        float acc[Lanes];
        gather(graph, p.data(), i, acc);
        for (int l = 0; l < Lanes; ++l) {
          const float value = graph.diagonal[i] * p[i * Lanes + l] - acc[l];
          q[i * Lanes + l] = value;
          sums[l] += double(value) * p[i * Lanes + l];
        }
      });
      for (int l = 0; l < Lanes; ++l) alpha[l] = open[l] && pq[l] > 0 ? static_cast<float>(rz[l] / pq[l]) : 0;
      rr = sum_over(graph.size(), [&](std::int64_t i, Sums& sums) {
        for (int l = 0; l < Lanes; ++l) {
          x[i * Lanes + l] += alpha[l] * p[i * Lanes + l];
          const float value = r[i * Lanes + l] -= alpha[l] * q[i * Lanes + l];
          sums[l] += double(value) * value;
        }
      });
      rz_before = rz;
      ++report.iterations;
    }
    return report;
  }

  // Computes x = M^-1 b on a level by relaxation sweeps, with one or two corrections from the coarser levels between
  // them. The sweeps after a correction mirror those before it, so that M is symmetric.
  void cycle(size_t level, const ZeroedVector<float>& b, bool twice = true) {
    const Level& here = grid_.levels_[level];
    const CellGraph& graph = here.graph;
    ZeroedVector<float>& x = at_[level].x;
    if (here.parent.empty()) return solve_coarsest(graph, b, x);

    // Relaxes the red cells. Since x starts at 0, this needs no values of neighbours.
    for_cells(graph.red_count, [&](std::int64_t i) {
      for (int l = 0; l < Lanes; ++l) x[i * Lanes + l] = b[i * Lanes + l] / graph.diagonal[i];
    });
    relax(graph, graph.red_count, graph.size(), b, x);
    visit_coarser(level, b);
    if (twice) {
      relax(graph, graph.red_count, graph.size(), b, x);
      relax(graph, 0, graph.red_count, b, x);
      relax(graph, graph.red_count, graph.size(), b, x);
      visit_coarser(level, b);
    }
    relax(graph, graph.red_count, graph.size(), b, x);
    relax(graph, 0, graph.red_count, b, x);
  }

  const ZeroedVector<float>& solution() const { return at_[0].x; }

 private:
  struct Vectors {
    ZeroedVector<float> x, b;
  };

  template <class Body>
  static void for_cells(std::int64_t begin, std::int64_t end, const Body& body) {
    parallel_for(end - begin, kGrain, [&](std::int64_t first, std::int64_t last) {
      for (std::int64_t i = begin + first; i < begin + last; ++i) body(i);
    });
  }
  template <class Body>
  static void for_cells(std::int64_t count, const Body& body) {
    for_cells(0, count, body);
  }
  template <class Body>
  static Sums sum_over(std::int64_t count, const Body& body) {
    std::vector<Sums> part((count + kGrain - 1) / kGrain, Sums{});
    parallel_for(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
      Sums sums{};
      for (std::int64_t i = begin; i < end; ++i) body(i, sums);
      part[begin / kGrain] = sums;
    });
    Sums total{};
    for (const Sums& sums : part)
      for (int l = 0; l < Lanes; ++l) total[l] += sums[l];
    return total;
  }

  // Computes acc = sum over the neighbours of cell i of conductance * x.
  static void gather(const CellGraph& graph, const float* x, std::int64_t i, float (&acc)[Lanes]) {
    for (int l = 0; l < Lanes; ++l) acc[l] = 0;
    for (std::int32_t k = graph.first[i], end = graph.first[i + 1]; k < end; ++k) {
      const float c = graph.conductance[k];
      const float* from = x + std::int64_t{graph.neighbour[k]} * Lanes;
      for (int l = 0; l < Lanes; ++l) acc[l] += c * from[l];
    }
  }

  void relax(const CellGraph& graph, std::int64_t begin, std::int64_t end, const ZeroedVector<float>& b,
             ZeroedVector<float>& x) {
    for_cells(begin, end, [&](std::int64_t i) {
      float acc[Lanes];
      gather(graph, x.data(), i, acc);
      const float scale = 1 / graph.diagonal[i];
      for (int l = 0; l < Lanes; ++l) x[i * Lanes + l] = (b[i * Lanes + l] + acc[l]) * scale;
    });
  }

  // Adds the correction from the next coarser level. Must be called right after a half sweep over the black cells, so
  // that only red cells have a residual.
  void visit_coarser(size_t level, const ZeroedVector<float>& b) {
    const Level& here = grid_.levels_[level];
    ZeroedVector<float>& x = at_[level].x;
    ZeroedVector<float>& coarse_b = at_[level + 1].b;
    for_cells(std::ssize(here.first_red) - 1, [&](std::int64_t c) {
      float sum[Lanes] = {};
      for (std::int32_t k = here.first_red[c]; k < here.first_red[c + 1]; ++k) {
        const std::int64_t i = here.red[k];
        float acc[Lanes];
        gather(here.graph, x.data(), i, acc);
        for (int l = 0; l < Lanes; ++l) sum[l] += b[i * Lanes + l] + acc[l] - here.graph.diagonal[i] * x[i * Lanes + l];
      }
      for (int l = 0; l < Lanes; ++l) coarse_b[c * Lanes + l] = sum[l];
    });
    cycle(level + 1, coarse_b);
    const ZeroedVector<float>& correction = at_[level + 1].x;
    for_cells(here.graph.size(), [&](std::int64_t i) {
      if (here.parent[i] < 0) return;
      for (int l = 0; l < Lanes; ++l) x[i * Lanes + l] += correction[std::int64_t{here.parent[i]} * Lanes + l];
    });
  }

  void solve_coarsest(const CellGraph& graph, const ZeroedVector<float>& b, ZeroedVector<float>& x) {
    if (grid_.coarsest_inverse_.empty()) {
      std::fill(x.begin(), x.end(), 0.0f);
      for (int sweep = 0; sweep < 8; ++sweep) {
        relax(graph, 0, graph.red_count, b, x);
        relax(graph, graph.red_count, graph.size(), b, x);
      }
      for (int sweep = 0; sweep < 8; ++sweep) {
        relax(graph, graph.red_count, graph.size(), b, x);
        relax(graph, 0, graph.red_count, b, x);
      }
      return;
    }
    const std::int64_t n = graph.size();
    for (std::int64_t i = 0; i < n; ++i) {
      double acc[Lanes] = {};
      for (std::int64_t j = 0; j < n; ++j)
        for (int l = 0; l < Lanes; ++l) acc[l] += grid_.coarsest_inverse_[i * n + j] * b[j * Lanes + l];
      for (int l = 0; l < Lanes; ++l) x[i * Lanes + l] = static_cast<float>(acc[l]);
    }
  }

  const Multigrid& grid_;
  std::vector<Vectors> at_;
};

template <int Lanes>
class Multigrid::LanesCycle : public Multigrid::Cycle {
 public:
  explicit LanesCycle(const Multigrid& grid) : solver_(grid) { b.resize(grid.finest().size() * Lanes); }
  const ZeroedVector<float>& run() override {
    solver_.cycle(0, b);
    return solver_.solution();
  }

 private:
  Solver<Lanes> solver_;
};

namespace {
// Calls body with the number of lanes (right-hand sides) as a compile-time constant.
template <class Body>
auto with_lanes(int lanes, const Body& body) {
  switch (lanes) {
    case 1: return body(std::integral_constant<int, 1>());
    case 2: return body(std::integral_constant<int, 2>());
    case 3: return body(std::integral_constant<int, 3>());
    case 4: return body(std::integral_constant<int, 4>());
    case 5: return body(std::integral_constant<int, 5>());
    case 6: return body(std::integral_constant<int, 6>());
    case 7: return body(std::integral_constant<int, 7>());
    default: return body(std::integral_constant<int, 8>());
  }
}
}  // namespace

MultigridReport Multigrid::solve(ZeroedVector<float> b, ZeroedVector<float>& x, int lanes, double residual,
                                 int most_iterations, const Progress& progress) const {
  return with_lanes(lanes, [&](auto count) {
    return Solver<count>(*this).solve(std::move(b), x, residual, most_iterations, progress);
  });
}

std::unique_ptr<Multigrid::Cycle> Multigrid::cycle(int lanes) const {
  return with_lanes(lanes,
                    [&](auto count) -> std::unique_ptr<Cycle> { return std::make_unique<LanesCycle<count>>(*this); });
}

}  // namespace limber
