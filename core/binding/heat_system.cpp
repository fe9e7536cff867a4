// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_system.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/base/parallel.h"
#include "core/platform/memory_pages.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 32;  // number of bricks in one block of a parallel loop
constexpr int kRow = 4;              // number of cells of one colour in a row

using Four = float __attribute__((vector_size(16)));

Four load(const float* from) {
  Four four;
  std::memcpy(&four, from, sizeof four);
  return four;
}
void store(const Four& four, float* to) { std::memcpy(to, &four, sizeof four); }
// Return the four cells of a row shifted by one cell along x: before() fetches the missing first cell from the row of
// the brick towards -x, after() the missing last cell from the row of the brick towards +x.
Four before(const Four& previous_row, const Four& row) {
  return __builtin_shufflevector(previous_row, row, 3, 4, 5, 6);
}
Four after(const Four& row, const Four& next_row) { return __builtin_shufflevector(row, next_row, 1, 2, 3, 4); }

// Sets `values` to `count` zeros. New memory is already zero; reused memory is cleared on several threads.
void make_zeros(std::size_t count, HeatValues& values) {
  const bool is_new = count > values.capacity();
  if (is_new) values = HeatValues();
  values.resize(count);
  if (is_new) return want_large_pages(values.data(), static_cast<std::int64_t>(count * sizeof(float)));
  parallel_for(static_cast<std::int64_t>(count), 1 << 16,
               [&](std::int64_t begin, std::int64_t end) { std::fill(&values[begin], &values[0] + end, 0.0f); });
}
}  // namespace

void HeatSystem::reset(std::vector<glm::ivec3> its_corners, std::vector<std::array<std::int32_t, 6>> its_neighbours,
                       const glm::dvec3& its_spacing) {
  spacing = its_spacing;
  corners = std::move(its_corners);
  beside = std::move(its_neighbours);
  cells.assign(corners.size(), {});
  make_zeros((corners.size() + 1) * 6 * kColour, conductance);
  make_zeros((corners.size() + 1) * kSlots, diagonal);
  parallel_for(std::ssize(corners) + 1, kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::fill_n(&diagonal[begin * kSlots], (end - begin) * kSlots, 1.0f);
  });
  for (auto& neighbours : beside)
    for (std::int32_t& other : neighbours)
      if (other < 0) other = static_cast<std::int32_t>(corners.size());
}

HeatSolver::HeatSolver(const HeatSystem& system, int lanes, HeatVectors& vectors)
    : system_(system),
      lanes_(lanes),
      coarse_(coarsen(system)),
      multigrid_(std::move(coarse_.graph)),
      cycle_(multigrid_.cycle(lanes)),
      red_source_(vectors.red_source),
      red_(vectors.red),
      black_(vectors.black),
      residual_(vectors.residual),
      search_(vectors.search),
      step_(vectors.step) {
  const std::size_t slots = (system.brick_count() + 1) * lanes * HeatSystem::kColour;
  for (HeatValues* values : {&red_source_, &red_, &black_, &residual_, &search_, &step_}) make_zeros(slots, *values);
}

HeatSolver::~HeatSolver() = default;

template <class Body>
void HeatSolver::for_bricks(const Body& body) const {
  parallel_for(system_.brick_count(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick) body(brick);
  });
}

// Calls body(brick, sums) for every brick, and returns the totals of `sums`, one for each right-hand side.
template <class Body>
HeatSolver::Sums HeatSolver::sum_over_bricks(const Body& body) const {
  std::vector<Sums> part((system_.brick_count() + kGrain - 1) / kGrain, Sums{});
  parallel_for(system_.brick_count(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick) body(brick, part[begin / kGrain]);
  });
  Sums total{};
  for (const Sums& sums : part)
    for (int lane = 0; lane < lanes_; ++lane) total[lane] += sums[lane];
  return total;
}

// Calls body(lane, place, flow) for every row of one colour in a brick. `lane` is the index of a right-hand side.
// `place` is the index of the row's first cell in vectors of that colour. `flow` is the heat that the row's four cells
// receive from their neighbours of the other colour, whose temperatures are `other`.
template <bool kRed, class Body>
void HeatSolver::gather(std::int64_t brick, const HeatValues& other, const Body& body) const {
  const auto& beside = system_.beside[brick];
  const auto conductances = [&](std::int64_t of_brick, int direction, int row) {
    return load(&system_.conductance[(of_brick * 6 + direction) * HeatSystem::kColour + kRow * row]);
  };
  for (int row = 0; row < 64; ++row) {
    const int y = row & 7, z = row >> 3;
    // A row of the other colour is shifted by one voxel along x. If y + z is even, the red row has the lower first
    // voxel.
    const bool own_first = (((y + z) & 1) == 0) == kRed;
    const std::int64_t brick_of[4] = {y > 0 ? brick : beside[2], y < 7 ? brick : beside[3], z > 0 ? brick : beside[4],
                                      z < 7 ? brick : beside[5]};
    const int row_of[4] = {y > 0 ? row - 1 : row + 7, y < 7 ? row + 1 : row - 7, z > 0 ? row - 8 : row + 56,
                           z < 7 ? row + 8 : row - 56};
    Four g[6];
    if constexpr (kRed) {
      for (int direction = 0; direction < 6; ++direction) g[direction] = conductances(brick, direction, row);
    } else {
      g[0] = conductances(brick, 1, row);
      g[1] = conductances(brick, 0, row);
      if (own_first) g[0] = before(conductances(beside[0], 1, row), g[0]);
      else g[1] = after(g[1], conductances(beside[1], 0, row));
      for (int k = 0; k < 4; ++k) g[2 + k] = conductances(brick_of[k], 2 + (k ^ 1), row_of[k]);
    }
    for (int lane = 0; lane < lanes_; ++lane) {
      const auto values = [&](std::int64_t of_brick, int of_row) {
        return load(&other[at(of_brick, lane) + kRow * of_row]);
      };
      const Four same = values(brick, row);
      Four flow = own_first ? g[0] * before(values(beside[0], row), same) + g[1] * same
                            : g[0] * same + g[1] * after(same, values(beside[1], row));
      for (int k = 0; k < 4; ++k) flow += g[2 + k] * values(brick_of[k], row_of[k]);
      body(lane, at(brick, lane) + kRow * row, flow);
    }
  }
}

void HeatSolver::relax_reds(const HeatValues& blacks, bool with_sources) {
  for_bricks([&](std::int64_t brick) {
    const float* diagonal = &system_.diagonal[brick * HeatSystem::kSlots];
    gather<true>(brick, blacks, [&](int, std::int64_t place, Four flow) {
      if (with_sources) flow += load(&red_source_[place]);
      store(flow / load(diagonal + place % HeatSystem::kColour), &red_[place]);
    });
  });
}

// Computes the residual of the first guess. Returns the sum of the squared sources for each right-hand side.
HeatSolver::Sums HeatSolver::start() {
  const Sums sources = sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    for (int lane = 0; lane < lanes_; ++lane)
      for (std::int64_t i = at(brick, lane); i < at(brick, lane + 1); ++i)
        sums[lane] += double(red_source_[i]) * red_source_[i] + double(residual_[i]) * residual_[i];
  });
  relax_reds(black_, true);
  for_bricks([&](std::int64_t brick) {
    const float* diagonal = &system_.diagonal[brick * HeatSystem::kSlots + HeatSystem::kColour];
    gather<false>(brick, red_, [&](int, std::int64_t place, const Four& flow) {
      store(load(&residual_[place]) + flow - load(diagonal + place % HeatSystem::kColour) * load(&black_[place]),
            &residual_[place]);
    });
  });
  return sources;
}

// Computes step = M^-1 * residual, where M is the preconditioner. Returns the dot products of step and residual.
HeatSolver::Sums HeatSolver::precondition() {
  const auto diagonal_of = [&](std::int64_t brick) {
    return &system_.diagonal[brick * HeatSystem::kSlots + HeatSystem::kColour];
  };
  for_bricks([&](std::int64_t brick) {
    for (int lane = 0; lane < lanes_; ++lane)
      for (int slot = 0; slot < HeatSystem::kColour; slot += kRow)
        store(load(&residual_[at(brick, lane) + slot]) / load(diagonal_of(brick) + slot),
              &step_[at(brick, lane) + slot]);
  });
  relax_reds(step_, false);
  // Now only black cells have a residual: the flow from the red cells. A coarse cell lies in one brick, so no two
  // threads write to the same coarse cell.
  std::fill(cycle_->b.begin(), cycle_->b.end(), 0.0f);
  for_bricks([&](std::int64_t brick) {
    const std::int32_t* parent = &coarse_.parent_of_black[brick * HeatSystem::kColour];
    gather<false>(brick, red_, [&](int lane, std::int64_t place, const Four& flow) {
      for (int k = 0; k < kRow; ++k)
        if (const std::int32_t to = parent[place % HeatSystem::kColour + k]; to >= 0)
          cycle_->b[std::int64_t{to} * lanes_ + lane] += flow[k];
    });
  });
  const ZeroedVector<float>& correction = cycle_->run();
  for_bricks([&](std::int64_t brick) {
    const std::int32_t* parent = &coarse_.parent_of_black[brick * HeatSystem::kColour];
    for (int slot = 0; slot < HeatSystem::kColour; ++slot)
      if (const std::int32_t from = parent[slot]; from >= 0)
        for (int lane = 0; lane < lanes_; ++lane)
          step_[at(brick, lane) + slot] += correction[std::int64_t{from} * lanes_ + lane];
  });
  relax_reds(step_, false);
  return sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    gather<false>(brick, red_, [&](int lane, std::int64_t place, const Four& flow) {
      const Four residual = load(&residual_[place]);
      const Four step = (residual + flow) / load(diagonal_of(brick) + place % HeatSystem::kColour);
      store(step, &step_[place]);
      for (int k = 0; k < kRow; ++k) sums[lane] += double(residual[k]) * step[k];
    });
  });
}

// Computes step = A * search for the black cells alone, where A is the system's matrix. Returns the dot products of
// step and search.
HeatSolver::Sums HeatSolver::apply() {
  relax_reds(search_, false);
  return sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    const float* diagonal = &system_.diagonal[brick * HeatSystem::kSlots + HeatSystem::kColour];
    gather<false>(brick, red_, [&](int lane, std::int64_t place, const Four& flow) {
      const Four search = load(&search_[place]);
      const Four step = load(diagonal + place % HeatSystem::kColour) * search - flow;
      store(step, &step_[place]);
      for (int k = 0; k < kRow; ++k) sums[lane] += double(search[k]) * step[k];
    });
  });
}

MultigridReport HeatSolver::solve(double residual, int most_iterations, const Progress& progress) {
  const Sums sources = start();
  Sums remaining = sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    for (int lane = 0; lane < lanes_; ++lane)
      for (std::int64_t i = at(brick, lane); i < at(brick, lane + 1); ++i)
        sums[lane] += double(residual_[i]) * residual_[i];
  });
  MultigridReport report;
  std::array<bool, Multigrid::kMostLanes> open{};
  const auto is_open = [&] {
    bool any = false;
    report.residual = 0;
    for (int lane = 0; lane < lanes_; ++lane) {
      const double relative = sources[lane] > 0 ? std::sqrt(remaining[lane] / sources[lane]) : 0;
      report.residual = std::max(report.residual, relative);
      open[lane] = relative > residual;
      any |= open[lane];
    }
    return any;
  };
  Sums products_before{};
  while (is_open() && report.iterations < most_iterations && !progress.cancelled()) {
    const Sums products = precondition();
    Factors beta{}, alpha{};
    for (int lane = 0; lane < lanes_; ++lane)
      if (open[lane] && products_before[lane] > 0)
        beta[lane] = static_cast<float>(products[lane] / products_before[lane]);
    for_bricks([&](std::int64_t brick) {
      for (int lane = 0; lane < lanes_; ++lane)
        for (std::int64_t i = at(brick, lane); i < at(brick, lane + 1); ++i)
          search_[i] = step_[i] + beta[lane] * search_[i];
    });
    const Sums curvature = apply();
    for (int lane = 0; lane < lanes_; ++lane)
      if (open[lane] && curvature[lane] > 0) alpha[lane] = static_cast<float>(products[lane] / curvature[lane]);
    remaining = sum_over_bricks([&](std::int64_t brick, Sums& sums) {
      for (int lane = 0; lane < lanes_; ++lane)
        for (std::int64_t i = at(brick, lane); i < at(brick, lane + 1); ++i) {
          black_[i] += alpha[lane] * search_[i];
          residual_[i] -= alpha[lane] * step_[i];
          sums[lane] += double(residual_[i]) * residual_[i];
        }
    });
    products_before = products;
    ++report.iterations;
  }
  relax_reds(black_, true);
  return report;
}

}  // namespace limber
