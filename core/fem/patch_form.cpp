// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/patch_form.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/parallel.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 512;  // patches
constexpr double kAlike = 1.5;        // largest ratio of shear within a patch: fat and muscle would trade their volumes

std::uint64_t spread_bits(std::uint64_t v) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < 21; ++bit) spread |= (v >> bit & 1) << (3 * bit);
  return spread;
}

std::vector<int> morton_order(const Places& rest, const Eigen::MatrixX4i& T) {
  const Eigen::RowVector3d low = rest.colwise().minCoeff();
  const double extent = std::max((rest.colwise().maxCoeff() - low).maxCoeff(), 1e-9);
  std::vector<std::uint64_t> code(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const Eigen::RowVector3d centre = 0.25 * (rest.row(T(t, 0)) + rest.row(T(t, 1)) + rest.row(T(t, 2)) + rest.row(T(t, 3)));
    for (int k = 0; k < 3; ++k) code[t] |= spread_bits(std::uint64_t((centre[k] - low[k]) / extent * ((1 << 21) - 1))) << k;
  }
  std::vector<int> order(T.rows());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return code[a] < code[b]; });
  return order;
}
}  // namespace

PatchOrder grow_patches(const Places& rest, const Eigen::MatrixX4i& T, const std::vector<double>& bulk, const std::vector<double>& shear, int size) {
  const auto neighbour = neighbours_of(T);
  const auto order = morton_order(rest, T);
  std::vector<int> patch_of(T.rows(), -1);
  std::vector<std::vector<int>> patches;
  const auto alike = [&](int a, int b) { return bulk[b] > 0 && shear[b] <= kAlike * shear[a] && shear[a] <= kAlike * shear[b]; };

  for (const int seed : order) {
    if (patch_of[seed] >= 0) continue;
    std::vector<int> patch{seed}, nodes(T.row(seed).begin(), T.row(seed).end());
    patch_of[seed] = int(patches.size());
    while (bulk[seed] > 0 && int(patch.size()) < size) {
      int best = -1, most = -1;
      for (const int t : patch)
        for (const int n : neighbour[t]) {
          if (n < 0 || patch_of[n] >= 0 || !alike(seed, n)) continue;
          // Shared nodes first; then the one that leaves fewest free neighbours behind.
          int score = 0;
          for (const int node : T.row(n)) score += 8 * int(std::count(nodes.begin(), nodes.end(), node));
          for (const int m : neighbour[n]) score += m < 0 || patch_of[m] >= 0;
          if (score > most || (score == most && n < best)) best = n, most = score;
        }
      if (best < 0) break;
      patch_of[best] = int(patches.size());
      patch.push_back(best);
      for (const int node : T.row(best))
        if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
    }
    patches.push_back(std::move(patch));
  }

  // What was left over in between joins the smallest patch beside it.
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (patches[p].empty() || 2 * int(patches[p].size()) >= size || bulk[patches[p][0]] <= 0) continue;
    int best = -1;
    for (const int t : patches[p])
      for (const int n : neighbour[t]) {
        if (n < 0 || patch_of[n] == int(p) || !alike(patches[p][0], n)) continue;
        if (best < 0 || patches[patch_of[n]].size() < patches[best].size()) best = patch_of[n];
      }
    if (best < 0) continue;
    for (const int t : patches[p]) patch_of[t] = best;
    patches[best].insert(patches[best].end(), patches[p].begin(), patches[p].end());
    patches[p].clear();
  }

  PatchOrder result;
  for (const auto& patch : patches) {
    if (patch.empty()) continue;
    result.tet.insert(result.tet.end(), patch.begin(), patch.end());
    result.first.push_back(std::ssize(result.tet));
  }
  return result;
}

PatchForm::PatchForm(const ElasticForm& tets, const std::vector<std::int64_t>& first, const std::vector<double>& bulk, std::vector<double> filled, int node_count)
    : filled_(std::move(filled)) {
  tissue_.resize(tets.size());
  corner_.resize(tets.size());
  for (std::int64_t t = 0; t < tets.size(); ++t) tissue_[t] = filled_[t] * tets.tet(t).volume;
  for (std::size_t p = 0; p + 1 < first.size(); ++p) {
    Patch patch{first[p], first[p + 1], 0, 0, std::ssize(node_), 0, 0};
    std::vector<int> nodes;
    for (auto t = patch.begin; t < patch.end; ++t) {
      patch.tissue += tissue_[t];
      patch.bulk += tissue_[t] * bulk[t];
      nodes.insert(nodes.end(), tets.tet(t).node.begin(), tets.tet(t).node.end());
    }
    patch.bulk /= patch.tissue;
    if (!(patch.bulk > 0)) continue;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    assert(nodes.size() < 256);
    node_.insert(node_.end(), nodes.begin(), nodes.end());
    patch.node_end = std::ssize(node_);
    patches_.push_back(patch);
  }

  std::vector<std::int64_t> cut;
  for (std::int64_t end = 8; end < std::ssize(patches_) + 8; end += 8) cut.push_back(std::min(end, std::ssize(patches_)));
  chunks_ = colour_chunks(cut, node_count, [&](std::int64_t p, const auto& visit) {
    for (auto k = patches_[p].node_begin; k < patches_[p].node_end; ++k) visit(node_[k]);
  });
}

void PatchForm::connect(BlockGraphBuilder& graph, std::span<const int> unknown) const {
  std::vector<int> element;
  for (const Patch& patch : patches_) {
    element.clear();
    for (auto k = patch.node_begin; k < patch.node_end; ++k) element.push_back(unknown[node_[k]]);
    graph.add(element);
  }
}

void PatchForm::bind(const ElasticForm& tets, const Cholesky& matrix, std::span<const int> unknown) {
  place_.clear();
  std::vector<std::pair<int, int>> by_rank;
  std::vector<int> nodes;
  for (Patch& patch : patches_) {
    const auto begin = node_.begin() + patch.node_begin, end = node_.begin() + patch.node_end;
    by_rank.clear(), nodes.clear();
    for (auto at = begin; at != end; ++at) by_rank.push_back({unknown[*at] < 0 ? -1 : matrix.rank(unknown[*at]), *at});
    std::sort(by_rank.begin(), by_rank.end());
    std::transform(by_rank.begin(), by_rank.end(), begin, [](const auto& each) { return each.second; });
    for (const auto& [rank, node] : by_rank) nodes.push_back(unknown[node]);
    patch.place_begin = std::ssize(place_);
    place_.resize(place_.size() + nodes.size() * (nodes.size() + 1) / 2);
    matrix.places(nodes, &place_[patch.place_begin]);
    for (auto t = patch.begin; t < patch.end; ++t)
      for (int a = 0; a < 4; ++a) corner_[t][a] = std::uint8_t(std::find(begin, end, tets.tet(t).node[a]) - begin);
  }
}

double PatchForm::mean_ratio(const Patch& patch, const std::vector<double>& J) const {
  double sum = 0;
  for (auto t = patch.begin; t < patch.end; ++t) sum += tissue_[t] * J[t];
  return sum / patch.tissue;
}

double PatchForm::value(const std::vector<double>& J) const {
  return parallel_sum(std::ssize(patches_), kGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto p = begin; p < end; ++p) {
      const double off = mean_ratio(patches_[p], J) - 1;
      sum += 0.5 * patches_[p].bulk * patches_[p].tissue * off * off;
    }
    return sum;
  });
}

void PatchForm::pressures(const std::vector<double>& J, std::vector<double>& pressure) const {
  pressure.assign(J.size(), 0);
  for (const Patch& patch : patches_) {
    const double whole = patch.bulk * (mean_ratio(patch, J) - 1);
    for (auto t = patch.begin; t < patch.end; ++t) pressure[t] = filled_[t] * whole;
  }
}

void PatchForm::add_curvature(const ElasticForm& tets, const Places& x, std::span<double> matrix) const {
  chunks_.for_each([&](const ColouredChunks::Chunk& chunk) {
    std::vector<Eigen::Vector3d> G;
    for (auto p = chunk.begin; p < chunk.end; ++p) {
      const Patch& patch = patches_[p];
      G.assign(patch.node_end - patch.node_begin, Eigen::Vector3d::Zero());
      for (auto t = patch.begin; t < patch.end; ++t) {
        const auto& tet = tets.tet(t);
        const Eigen::Matrix3d F = tets.deformation(x, t);
        Eigen::Matrix3d C;
        C << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
        C *= tissue_[t];
        for (int a = 0; a < 4; ++a) G[corner_[t][a]] += C * tet.slope[a];
      }
      const double weight = patch.bulk / patch.tissue;
      const Cholesky::Place* place = &place_[patch.place_begin];
      for (std::size_t a = 0; a < G.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b, ++place) {
          if (place->at < 0) continue;
          double* column = matrix.data() + place->at;
          for (int c = 0; c < 3; ++c, column += place->stride) {
            const double scaled = weight * G[b][c];
            for (int r = 0; r < 3; ++r) column[r] += G[a][r] * scaled;
          }
        }
    }
  });
}

}  // namespace limber
