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
// Return the four cells of a row shifted by one cell along x. The missing cell, `previous` or `next`, is in the brick
// towards -x or +x.
Four before(float previous, const Four row) {
  Four shifted = __builtin_shufflevector(row, row, 0, 0, 1, 2);
  shifted[0] = previous;
  return shifted;
}
Four after(const Four row, float next) {
  Four shifted = __builtin_shufflevector(row, row, 1, 2, 3, 3);
  shifted[3] = next;
  return shifted;
}

// Returns `sum` plus the dot product of two rows. The products are added one after the other, in order.
double plus_product(double sum, const Four a, const Four b) {
  for (int k = 0; k < kRow; ++k) sum += double(a[k]) * b[k];
  return sum;
}

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

// Calls body(lane, slot, place, flow) for every row (four cells along x) of one colour in a brick. `lane` is the index
// of a right-hand side. `slot` is the index of the row's first cell among the brick's cells of that colour, and `place`
// its index in vectors of that colour. `flow` is the heat that the four cells receive from their neighbours of the
// other colour, whose temperatures are `other`.
template <bool kRed, class Body>
void HeatSolver::gather(std::int64_t brick, const HeatValues& other, const Body& body) const {
  constexpr std::int64_t kColour = HeatSystem::kColour;
  // Offsets, in rows, to the neighbours of a row towards -y, +y, -z and +z: within the brick, and beyond its sides.
  constexpr int kWithin[4] = {-1, 1, -8, 8}, kBeyond[4] = {7, -7, 56, -56};
  const auto& beside = system_.beside[brick];
  const int lanes = lanes_;
  const float *values = other.data(), *conductances = system_.conductance.data();
  const auto conductances_of = [](std::int64_t of_brick, int direction) {
    return (of_brick * 6 + direction) * kColour;
  };
  const std::int64_t own = at(brick, 0), lower_x = at(beside[0], 0), higher_x = at(beside[1], 0);
  std::int64_t within[4], beyond[4], conductance_within[4], conductance_beyond[4];
  for (int k = 0; k < 4; ++k) {
    within[k] = own + kRow * kWithin[k];
    beyond[k] = at(beside[2 + k], 0) + kRow * kBeyond[k];
    conductance_within[k] = conductances_of(brick, 2 + (k ^ 1)) + kRow * kWithin[k];
    conductance_beyond[k] = conductances_of(beside[2 + k], 2 + (k ^ 1)) + kRow * kBeyond[k];
  }
  for (int row = 0; row < 64; ++row) {
    const int y = row & 7, z = row >> 3, slot = kRow * row;
    const bool is_beyond[4] = {y == 0, y == 7, z == 0, z == 7};
    // Rows of the two colours are shifted by one voxel along x against each other. If y + z is even, the red row starts
    // one voxel lower.
    const bool own_first = (((y + z) & 1) == 0) == kRed;
    Four g[6];
    if constexpr (kRed) {
      for (int direction = 0; direction < 6; ++direction)
        g[direction] = load(conductances + conductances_of(brick, direction) + slot);
    } else {
      g[0] = load(conductances + conductances_of(brick, 1) + slot);
      g[1] = load(conductances + conductances_of(brick, 0) + slot);
      if (own_first) g[0] = before(conductances[conductances_of(beside[0], 1) + slot + kRow - 1], g[0]);
      else g[1] = after(g[1], conductances[conductances_of(beside[1], 0) + slot]);
      for (int k = 0; k < 4; ++k)
        g[2 + k] = load(conductances + ((is_beyond[k] ? conductance_beyond[k] : conductance_within[k]) + slot));
    }
    const float* rows[4];
    for (int k = 0; k < 4; ++k) rows[k] = values + ((is_beyond[k] ? beyond[k] : within[k]) + slot);
    const float* next = values + (own_first ? lower_x + kRow - 1 : higher_x) + slot;
    for (std::int64_t lane = 0, offset = 0; lane < lanes; ++lane, offset += kColour) {
      const Four same = load(values + own + slot + offset);
      Four flow =
          own_first ? g[0] * before(next[offset], same) + g[1] * same : g[0] * same + g[1] * after(same, next[offset]);
      for (int k = 0; k < 4; ++k) flow += g[2 + k] * load(rows[k] + offset);
      body(static_cast<int>(lane), slot, own + slot + offset, flow);
    }
  }
}

void HeatSolver::relax_reds(const HeatValues& blacks, bool with_sources) {
  for_bricks([&](std::int64_t brick) {
    const float *diagonal = &system_.diagonal[brick * HeatSystem::kSlots], *sources = red_source_.data();
    float* red = red_.data();
    gather<true>(brick, blacks, [=](int, int slot, std::int64_t place, Four flow) {
      if (with_sources) flow += load(sources + place);
      store(flow / load(diagonal + slot), red + place);
    });
  });
}

// Computes the residual of the initial guess. Returns the sum of the squared sources for each right-hand side.
HeatSolver::Sums HeatSolver::start() {
  const Sums sources = sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    for (int lane = 0; lane < lanes_; ++lane)
      for (std::int64_t i = at(brick, lane); i < at(brick, lane + 1); ++i)
        sums[lane] += double(red_source_[i]) * red_source_[i] + double(residual_[i]) * residual_[i];
  });
  relax_reds(black_, true);
  for_bricks([&](std::int64_t brick) {
    const float *diagonal = diagonal_of_blacks(brick), *black = black_.data();
    float* residual = residual_.data();
    gather<false>(brick, red_, [=](int, int slot, std::int64_t place, const Four flow) {
      store(load(residual + place) + flow - load(diagonal + slot) * load(black + place), residual + place);
    });
  });
  return sources;
}

// Computes step = M^-1 * residual, where M is the preconditioner. Returns the dot products of step and residual.
HeatSolver::Sums HeatSolver::precondition() {
  const int lanes = lanes_;
  const float* residual = residual_.data();
  float* step = step_.data();
  for_bricks([&](std::int64_t brick) {
    const float* diagonal = diagonal_of_blacks(brick);
    for (int lane = 0; lane < lanes; ++lane)
      for (std::int64_t slot = 0, place = at(brick, lane); slot < HeatSystem::kColour; slot += kRow)
        store(load(residual + place + slot) / load(diagonal + slot), step + place + slot);
  });
  relax_reds(step_, false);
  // Now only black cells have a residual: the flow from the red cells. A coarse cell is in only one brick, so no two
  // threads write to the same coarse cell.
  std::fill(cycle_->b.begin(), cycle_->b.end(), 0.0f);
  for_bricks([&](std::int64_t brick) {
    const std::int32_t* parent = &coarse_.parent_of_black[brick * HeatSystem::kColour];
    float* b = cycle_->b.data();
    gather<false>(brick, red_, [=](int lane, int slot, std::int64_t, const Four flow) {
      for (int k = 0; k < kRow; ++k)
        if (const std::int32_t to = parent[slot + k]; to >= 0) b[std::int64_t{to} * lanes + lane] += flow[k];
    });
  });
  const float* correction = cycle_->run().data();
  for_bricks([&](std::int64_t brick) {
    const std::int32_t* parent = &coarse_.parent_of_black[brick * HeatSystem::kColour];
    float* here = step + at(brick, 0);
    for (int slot = 0; slot < HeatSystem::kColour; ++slot)
      if (const std::int32_t from = parent[slot]; from >= 0)
        for (int lane = 0; lane < lanes; ++lane)
          here[lane * HeatSystem::kColour + slot] += correction[std::int64_t{from} * lanes + lane];
  });
  relax_reds(step_, false);
  return sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    const float* diagonal = diagonal_of_blacks(brick);
    gather<false>(brick, red_, [&, residual, step, diagonal](int lane, int slot, std::int64_t place, const Four flow) {
      const Four left = load(residual + place), stepped = (left + flow) / load(diagonal + slot);
      store(stepped, step + place);
      sums[lane] = plus_product(sums[lane], left, stepped);
    });
  });
}

// Computes step = A * search for the black cells alone, where A is the system's matrix. Returns the dot products of
// step and search.
HeatSolver::Sums HeatSolver::apply() {
  relax_reds(search_, false);
  return sum_over_bricks([&](std::int64_t brick, Sums& sums) {
    const float *diagonal = diagonal_of_blacks(brick), *search = search_.data();
    float* step = step_.data();
    gather<false>(brick, red_, [&, search, step, diagonal](int lane, int slot, std::int64_t place, const Four flow) {
      const Four searched = load(search + place), stepped = load(diagonal + slot) * searched - flow;
      store(stepped, step + place);
      sums[lane] = plus_product(sums[lane], searched, stepped);
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
