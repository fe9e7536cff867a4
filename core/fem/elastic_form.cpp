// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/elastic_form.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/base/parallel.h"
#include "core/fem/signed_svd.h"
#include "core/fem/tet_derivatives.h"

namespace limber {

namespace {
// A chunk (a run of neighbouring patches that one thread adds up) has at least this many tets. Larger chunks share
// fewer nodes with each other; smaller chunks allow more chunks per colour to run in parallel.
constexpr std::int64_t kChunk = 48;
constexpr std::int64_t kPatches = 256;  // patches per task, in loops that do not write to nodes
constexpr std::int64_t kGrain = 2048;   // tets per task, in loops that do not write to nodes

Eigen::Matrix3d deformation_of(const ElasticForm::Tet& tet, const NodePositions& x) {
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
  // Each round assigns up to 64 new colours. Chunks whose neighbours use all 64 of them wait for the next round.
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
      for (auto e = chunk.begin; e < chunk.end; ++e)
        nodes_of(e, [&](int node) { used[node] |= std::uint64_t{1} << colour; });
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

ElasticForm::ElasticForm(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<TetEnergy>& energy,
                         std::vector<std::int64_t> first) {
  tets_.resize(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    Tet& tet = tets_[t];
    Eigen::Matrix3d D;
    for (int a = 0; a < 4; ++a) tet.node[a] = T(t, a);
    for (int a = 0; a < 3; ++a) D.col(a) = (rest.row(T(t, a + 1)) - rest.row(T(t, 0))).transpose();
    const double determinant = D.determinant();
    // The matrix D^-T: column a is the gradient of the shape function of node a + 1.
    const Eigen::Matrix3d slopes = cofactor(D) / determinant;
    for (int a = 0; a < 3; ++a) tet.slope[a + 1] = slopes.col(a);
    tet.slope[0] = -slopes.rowwise().sum();
    tet.volume = determinant / 6;
    tet.energy = energy[t];
  }

  if (first.empty()) {
    first.resize(T.rows() + 1);
    std::iota(first.begin(), first.end(), 0);
  }
  corner_.resize(T.rows());
  std::vector<std::int64_t> cut;
  std::int64_t cut_at = 0, places = 0;
  for (std::size_t p = 0; p + 1 < first.size(); ++p) {
    Patch patch{first[p], first[p + 1], std::ssize(node_), 0, places, 0};
    for (auto t = patch.begin; t < patch.end; ++t)
      for (const int node : tets_[t].node)
        if (std::find(node_.begin() + patch.node_begin, node_.end(), node) == node_.end()) node_.push_back(node);
    patch.node_end = std::ssize(node_);
    const auto nodes = patch.node_end - patch.node_begin;
    assert(nodes < 256);
    patch.place_end = places += nodes * (nodes + 1) / 2;
    patches_.push_back(patch);
    if (patch.end - cut_at >= kChunk || p + 2 == first.size()) cut.push_back(std::ssize(patches_)), cut_at = patch.end;
  }
  place_.resize(places);
  chunks_ = colour_chunks(cut, int(rest.rows()), [&](std::int64_t p, const auto& visit) {
    for (auto k = patches_[p].node_begin; k < patches_[p].node_end; ++k) visit(node_[k]);
  });
}

void ElasticForm::add_sparsity(BlockGraphBuilder& graph, std::span<const int> unknown) const {
  std::vector<int> element;
  for (const Patch& patch : patches_) {
    element.clear();
    for (auto k = patch.node_begin; k < patch.node_end; ++k) element.push_back(unknown[node_[k]]);
    graph.add(element);
  }
}

void ElasticForm::assign_nodes(const Cholesky& matrix, std::span<const int> unknown) {
  parallel_for(std::ssize(patches_), kPatches, [&](std::int64_t first, std::int64_t last) {
    std::vector<std::pair<int, int>> by_rank;
    std::vector<int> unknowns;
    for (auto p = first; p < last; ++p) {
      const Patch& patch = patches_[p];
      const auto begin = node_.begin() + patch.node_begin, end = node_.begin() + patch.node_end;
      by_rank.clear(), unknowns.clear();
      for (auto at = begin; at != end; ++at)
        by_rank.push_back({unknown[*at] < 0 ? -1 : matrix.rank(unknown[*at]), *at});
      std::sort(by_rank.begin(), by_rank.end());
      std::transform(by_rank.begin(), by_rank.end(), begin, [](const auto& each) { return each.second; });
      for (const auto& [rank, node] : by_rank) unknowns.push_back(unknown[node]);
      matrix.places(unknowns, &place_[patch.place_begin]);
      for (auto t = patch.begin; t < patch.end; ++t) {
        Tet& tet = tets_[t];
        auto& corner = corner_[t];
        for (int a = 0; a < 4; ++a) corner[a] = std::uint8_t(std::find(begin, end, tet.node[a]) - begin);
        for (int a = 1; a < 4; ++a)
          for (int b = a; b > 0 && corner[b] < corner[b - 1]; --b) {
            std::swap(corner[b], corner[b - 1]);
            std::swap(tet.node[b], tet.node[b - 1]);
            std::swap(tet.slope[b], tet.slope[b - 1]);
          }
      }
    }
  });
}

void ElasticForm::volume_ratios(const NodePositions& x, std::vector<double>& J) const {
  J.resize(tets_.size());
  parallel_for(size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto t = begin; t < end; ++t) J[t] = deformation_of(tets_[t], x).determinant();
  });
}

double ElasticForm::value(const NodePositions& x, const std::vector<double>& J) const {
  return parallel_sum(size(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto t = begin; t < end; ++t) {
      if (!(J[t] > 0)) return std::numeric_limits<double>::infinity();
      sum += tets_[t].volume * energy_density(tets_[t].energy, deformation_of(tets_[t], x), J[t]);
    }
    return sum;
  });
}

void ElasticForm::add_gradient(const NodePositions& x, std::span<const double> pressure,
                               NodePositions& gradient) const {
  chunks_.for_each([&](const ColouredChunks::Chunk& chunk) {
    for (auto t = patches_[chunk.begin].begin; t < patches_[chunk.end - 1].end; ++t) {
      const Tet& tet = tets_[t];
      const Eigen::Matrix3d F = deformation_of(tet, x), C = cofactor(F);
      const double J = F.col(0).dot(C.col(0));
      const double g = volume_term(tet.energy, J).slope + (pressure.empty() ? 0 : pressure[t]);
      const Eigen::Matrix3d P = tet.volume * (tet.energy.shear * F + g * C);
      for (int a = 0; a < 4; ++a) gradient.row(tet.node[a]) += (P * tet.slope[a]).transpose();
    }
  });
}

// Sums the Hessian's blocks of one patch at a time: first the blocks of its tets, then its own rank-one term
// (PatchStiffness). Adds the sums to the matrix.
class ElasticForm::PatchSum {
 public:
  PatchSum(const ElasticForm& form, const PatchStiffness& stiffness, std::span<double> matrix)
      : form_(form),
        stiffness_(stiffness),
        matrix_(matrix) {}

  void begin(std::int64_t p) {
    patch_ = p;
    const Patch& patch = form_.patches_[p];
    block_.assign(patch.place_end - patch.place_begin, {});
    is_stiff_ = !stiffness_.of_patch.empty() && stiffness_.of_patch[p] > 0;
    if (is_stiff_) slope_.assign(patch.node_end - patch.node_begin, Eigen::Vector3d::Zero());
  }

  // Adds the Hessian blocks of tet t, which are entry l of `derivatives`.
  void add(std::int64_t t, const Eigen::Matrix3d& F, const TetDerivatives& derivatives, int l) {
    const auto& corner = form_.corner_[t];
    for (int a = 0, pair = 0; a < 4; ++a) {
      Block* row = &block_[corner[a] * (corner[a] + 1) / 2];
      for (int b = 0; b <= a; ++b, ++pair) {
        double* block = row[corner[b]].data();
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) *block++ += derivatives.block[pair][c][r][l];
      }
    }
    if (!is_stiff_) return;
    const Eigen::Matrix3d C = stiffness_.of_tet[t] * cofactor(F);
    for (int a = 0; a < 4; ++a) slope_[corner[a]] += C * form_.tets_[t].slope[a];
  }

  void end() {
    const Patch& patch = form_.patches_[patch_];
    const auto nodes = patch.node_end - patch.node_begin;
    if (is_stiff_) {
      auto block = block_.begin();
      for (std::int64_t a = 0; a < nodes; ++a) {
        const Eigen::Vector3d row = stiffness_.of_patch[patch_] * slope_[a];
        for (std::int64_t b = 0; b <= a; ++b, ++block)
          for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) (*block)[3 * c + r] += row[r] * slope_[b][c];
      }
    }
    const Cholesky::Place* place = &form_.place_[patch.place_begin];
    for (const Block& block : block_) {
      if (const auto [at, stride] = *place++; at >= 0) {
        double* column = matrix_.data() + at;
        for (int c = 0; c < 3; ++c, column += stride)
          for (int r = 0; r < 3; ++r) column[r] += block[3 * c + r];
      }
    }
  }

 private:
  using Block = std::array<double, 9>;  // a 3x3 matrix, column by column
  const ElasticForm& form_;
  const PatchStiffness& stiffness_;
  std::span<double> matrix_;
  std::int64_t patch_ = 0;
  bool is_stiff_ = false;
  std::vector<Block> block_;  // blocks of the patch's node pairs (lower triangle, row by row)
  std::vector<Eigen::Vector3d>
      slope_;  // for each node of the patch, G (see PatchStiffness): the weighted derivative of det F
};

void ElasticForm::add_derivatives(const NodePositions& x, std::span<const double> pressure,
                                  const PatchStiffness& stiffness, HessianKind curvature, NodePositions& gradient,
                                  std::span<double> matrix) const {
  constexpr int kTets = TetDerivatives::kTets;
  chunks_.for_each([&](const ColouredChunks::Chunk& chunk) {
    const auto first = patches_[chunk.begin].begin, last = patches_[chunk.end - 1].end;
    const auto count = std::size_t(last - first);
    std::vector<Eigen::Matrix3d> deformation(count);
    for (auto t = first; t < last; ++t) deformation[t - first] = deformation_of(tets_[t], x);
    std::vector<Principal> axes_of(curvature == HessianKind::Projected ? count : 0);
    if (curvature == HessianKind::Projected) signed_svd(deformation, axes_of);

    std::array<TetState, kTets> states;
    TetDerivatives derivatives;
    PatchSum sum(*this, stiffness, matrix);
    auto patch = chunk.begin;
    sum.begin(patch);
    for (auto begin = first; begin < last; begin += kTets) {
      const int some = int(std::min<std::int64_t>(kTets, last - begin));
      for (int l = 0; l < some; ++l) {
        const auto t = begin + l;
        const Tet& tet = tets_[t];
        const Eigen::Matrix3d& F = deformation[t - first];
        const VolumeTerm term = volume_term(tet.energy, F.determinant());
        const double p = pressure.empty() ? 0 : pressure[t];
        TetState& state = states[l];
        state.slopes = &tet.slope;
        state.F = F;
        state.volume = tet.volume;
        state.shear = tet.energy.shear;
        state.force_slope = term.slope + p;
        state.slope = curvature == HessianKind::Exact ? term.slope + p : term.slope;
        state.curvature = term.curvature;
        if (curvature == HessianKind::Projected) {
          state.axes = &axes_of[t - first];
          const NegativeCurvature negative =
              negative_curvature(tet.energy.shear, term.slope, term.curvature, state.axes->sigma);
          state.negative.count = negative.count;
          std::copy_n(negative.direction, negative.count, state.negative.direction);
        }
      }
      tet_derivatives({states.data(), std::size_t(some)}, derivatives);
      for (int l = 0; l < some; ++l) {
        const auto t = begin + l;
        for (int a = 0; a < 4; ++a)
          for (int k = 0; k < 3; ++k) gradient(tets_[t].node[a], k) += derivatives.force[a][k][l];
        if (t == patches_[patch].end) {
          sum.end();
          sum.begin(++patch);
        }
        sum.add(t, states[l].F, derivatives, l);
      }
    }
    sum.end();
  });
}

}  // namespace limber
