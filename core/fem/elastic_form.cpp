// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/elastic_form.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/base/parallel.h"
#include "core/fem/principal.h"
#include "core/fem/tet_derivatives.h"

namespace limber {

namespace {
constexpr std::int64_t kChunk = 48;    // tets: large enough to have few neighbours, small enough for many in a colour
constexpr std::int64_t kGrain = 2048;  // tets of a loop without writes to nodes

Eigen::Matrix3d deformation_of(const ElasticForm::Tet& tet, const Places& x) {
  const Eigen::Vector3d o = x.row(tet.node[0]);
  Eigen::Matrix3d F;
  F.noalias() = (x.row(tet.node[1]).transpose() - o) * tet.slope[1].transpose();
  F.noalias() += (x.row(tet.node[2]).transpose() - o) * tet.slope[2].transpose();
  F.noalias() += (x.row(tet.node[3]).transpose() - o) * tet.slope[3].transpose();
  return F;
}

Eigen::Matrix3d cofactor(const Eigen::Matrix3d& F) {
  Eigen::Matrix3d C;
  C.col(0) = F.col(1).cross(F.col(2));
  C.col(1) = F.col(2).cross(F.col(0));
  C.col(2) = F.col(0).cross(F.col(1));
  return C;
}
}  // namespace

void ColouredChunks::for_each(const std::function<void(const Chunk&)>& body) const {
  for (std::size_t c = 0; c + 1 < colour_first.size(); ++c) {
    const auto first = colour_first[c];
    parallel_for(colour_first[c + 1] - first, 4, [&](std::int64_t begin, std::int64_t end) {
      for (auto k = begin; k < end; ++k) body(chunks[first + k]);
    });
  }
}

ColouredChunks colour_chunks(const std::vector<std::int64_t>& cut, int node_count,
                             const std::function<void(std::int64_t, const std::function<void(int)>&)>& nodes_of) {
  std::vector<std::vector<ColouredChunks::Chunk>> of_colour;
  // 64 colours at a time; chunks that meet all 64 of a round wait for the next.
  std::vector<ColouredChunks::Chunk> waiting;
  for (std::size_t k = 0; k < cut.size(); ++k)
    if (const std::int64_t begin = k ? cut[k - 1] : 0; begin < cut[k]) waiting.push_back({begin, cut[k]});
  while (!waiting.empty()) {
    const auto round = of_colour.size();
    std::vector<std::uint64_t> used(node_count, 0);
    std::vector<ColouredChunks::Chunk> later;
    for (const auto& chunk : waiting) {
      std::uint64_t met = 0;
      for (auto e = chunk.begin; e < chunk.end; ++e) nodes_of(e, [&](int node) { met |= used[node]; });
      const int colour = std::countr_one(met);
      if (colour == 64) {
        later.push_back(chunk);
        continue;
      }
      for (auto e = chunk.begin; e < chunk.end; ++e) nodes_of(e, [&](int node) { used[node] |= std::uint64_t{1} << colour; });
      if (of_colour.size() < round + colour + 1) of_colour.resize(round + colour + 1);
      of_colour[round + colour].push_back(chunk);
    }
    waiting = std::move(later);
  }

  ColouredChunks result;
  for (const auto& colour : of_colour) {
    result.chunks.insert(result.chunks.end(), colour.begin(), colour.end());
    result.colour_first.push_back(std::ssize(result.chunks));
  }
  return result;
}

ElasticForm::ElasticForm(const Places& rest, const Eigen::MatrixX4i& T, const std::vector<TetEnergy>& energy, const std::vector<std::int64_t>& may_cut) {
  tets_.resize(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    Tet& tet = tets_[t];
    Eigen::Matrix3d D;
    for (int a = 0; a < 4; ++a) tet.node[a] = T(t, a);
    for (int a = 0; a < 3; ++a) D.col(a) = (rest.row(T(t, a + 1)) - rest.row(T(t, 0))).transpose();
    const double determinant = D.determinant();
    const Eigen::Matrix3d slopes = cofactor(D) / determinant;  // D^-T: column a belongs to node a + 1
    for (int a = 0; a < 3; ++a) tet.slope[a + 1] = slopes.col(a);
    tet.slope[0] = -slopes.rowwise().sum();
    tet.volume = determinant / 6;
    tet.energy = energy[t];
  }

  std::vector<std::int64_t> cut;
  std::int64_t begin = 0;
  if (may_cut.empty())
    for (begin = kChunk; begin < size() + kChunk; begin += kChunk) cut.push_back(std::min(begin, size()));
  for (std::size_t k = 0; k < may_cut.size(); ++k)
    if (may_cut[k] - begin >= kChunk || k + 1 == may_cut.size()) cut.push_back(begin = may_cut[k]);
  chunks_ = colour_chunks(cut, int(rest.rows()), [&](std::int64_t t, const auto& visit) {
    for (int node : tets_[t].node) visit(node);
  });
}

void ElasticForm::connect(BlockGraphBuilder& graph, std::span<const int> unknown) const {
  for (const Tet& tet : tets_) {
    std::array<int, 4> element;
    for (int a = 0; a < 4; ++a) element[a] = unknown[tet.node[a]];
    graph.add(element);
  }
}

void ElasticForm::bind(const Cholesky& matrix, std::span<const int> unknown) {
  places_.resize(tets_.size());
  const auto rank = [&](int node) { return unknown[node] < 0 ? -1 : matrix.rank(unknown[node]); };
  parallel_for(size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = begin; t < end; ++t) {
      Tet& tet = tets_[t];
      for (int a = 1; a < 4; ++a)
        for (int b = a; b > 0 && rank(tet.node[b]) < rank(tet.node[b - 1]); --b) {
          std::swap(tet.node[b], tet.node[b - 1]);
          std::swap(tet.slope[b], tet.slope[b - 1]);
        }
      matrix.places(std::array{unknown[tet.node[0]], unknown[tet.node[1]], unknown[tet.node[2]], unknown[tet.node[3]]}, places_[t].data());
    }
  });
}

Eigen::Matrix3d ElasticForm::deformation(const Places& x, std::int64_t t) const { return deformation_of(tets_[t], x); }

void ElasticForm::volume_ratios(const Places& x, std::vector<double>& J) const {
  J.resize(tets_.size());
  parallel_for(size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = begin; t < end; ++t) J[t] = deformation_of(tets_[t], x).determinant();
  });
}

double ElasticForm::value(const Places& x, const std::vector<double>& J) const {
  return parallel_sum(size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto t = begin; t < end; ++t) {
      if (!(J[t] > 0)) return std::numeric_limits<double>::infinity();
      sum += tets_[t].volume * energy_density(tets_[t].energy, deformation_of(tets_[t], x), J[t]);
    }
    return sum;
  });
}

void ElasticForm::add_gradient(const Places& x, std::span<const double> pressure, Places& gradient) const {
  chunks_.for_each([&](const ColouredChunks::Chunk& chunk) {
    for (auto t = chunk.begin; t < chunk.end; ++t) {
      const Tet& tet = tets_[t];
      const Eigen::Matrix3d F = deformation_of(tet, x), C = cofactor(F);
      const double J = F.col(0).dot(C.col(0));
      const double g = volume_term(tet.energy, J).slope + (pressure.empty() ? 0 : pressure[t]);
      const Eigen::Matrix3d P = tet.volume * (tet.energy.shear * F + g * C);
      for (int a = 0; a < 4; ++a) gradient.row(tet.node[a]) += (P * tet.slope[a]).transpose();
    }
  });
}

void ElasticForm::add_derivatives(const Places& x, std::span<const double> pressure, Curvature curvature, Places& gradient,
                                  std::span<double> matrix) const {
  constexpr int kTets = TetDerivatives::kTets;
  chunks_.for_each([&](const ColouredChunks::Chunk& chunk) {
    const auto count = std::size_t(chunk.end - chunk.begin);
    std::vector<Eigen::Matrix3d> deformation(count);
    for (auto t = chunk.begin; t < chunk.end; ++t) deformation[t - chunk.begin] = deformation_of(tets_[t], x);
    std::vector<Principal> axes_of(curvature == Curvature::Projected ? count : 0);
    if (curvature == Curvature::Projected) principal(deformation, axes_of);

    std::array<TetState, kTets> states;
    TetDerivatives derivatives;
    for (auto begin = chunk.begin; begin < chunk.end; begin += kTets) {
      const int some = int(std::min<std::int64_t>(kTets, chunk.end - begin));
      for (int l = 0; l < some; ++l) {
        const auto t = begin + l;
        const Tet& tet = tets_[t];
        const Eigen::Matrix3d& F = deformation[t - chunk.begin];
        const VolumeTerm term = volume_term(tet.energy, F.determinant());
        const double p = pressure.empty() ? 0 : pressure[t];
        TetState& state = states[l];
        state.slopes = &tet.slope;
        state.F = F;
        state.volume = tet.volume;
        state.shear = tet.energy.shear;
        state.force_slope = term.slope + p;
        state.slope = curvature == Curvature::Exact ? term.slope + p : term.slope;
        state.curvature = term.curvature;
        if (curvature == Curvature::Projected) {
          state.axes = &axes_of[t - chunk.begin];
          const NegativeCurvature negative = negative_curvature(tet.energy.shear, term.slope, term.curvature, state.axes->sigma);
          state.negative.count = negative.count;
          std::copy_n(negative.direction, negative.count, state.negative.direction);
        }
      }
      tet_derivatives({states.data(), std::size_t(some)}, derivatives);
      for (int l = 0; l < some; ++l) {
        for (int a = 0; a < 4; ++a)
          for (int k = 0; k < 3; ++k) gradient(tets_[begin + l].node[a], k) += derivatives.force[a][k][l];
        for (int pair = 0; pair < 10; ++pair) {
          const Cholesky::Place& place = places_[begin + l][pair];
          if (place.at < 0) continue;
          double* column = matrix.data() + place.at;
          for (int c = 0; c < 3; ++c, column += place.stride)
            for (int r = 0; r < 3; ++r) column[r] += derivatives.block[pair][c][r][l];
        }
      }
    }
  });
}

}  // namespace limber
