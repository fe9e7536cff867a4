// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/patch_form.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 512;  // number of patches that one parallel task handles
// Tets whose shear moduli differ by a larger factor are not in one patch, so that fat does not shrink while muscle
// swells.
constexpr double kAlike = 1.5;

std::uint64_t spread_bits(std::uint64_t v) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < 21; ++bit) spread |= (v >> bit & 1) << (3 * bit);
  return spread;
}

std::vector<int> morton_order(const NodePositions& rest, const Eigen::MatrixX4i& T) {
  const Eigen::RowVector3d low = rest.colwise().minCoeff();
  const double extent = std::max((rest.colwise().maxCoeff() - low).maxCoeff(), 1e-9);
  std::vector<std::uint64_t> code(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const Eigen::RowVector3d centre =
        0.25 * (rest.row(T(t, 0)) + rest.row(T(t, 1)) + rest.row(T(t, 2)) + rest.row(T(t, 3)));
    for (int k = 0; k < 3; ++k)
      code[t] |= spread_bits(std::uint64_t((centre[k] - low[k]) / extent * ((1 << 21) - 1))) << k;
  }
  std::vector<int> order(T.rows());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return code[a] < code[b]; });
  return order;
}
}  // namespace

PatchOrder grow_patches(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<double>& bulk,
                        const std::vector<double>& shear, int size) {
  const auto neighbour = neighbours_of(T);
  const auto order = morton_order(rest, T);
  std::vector<int> patch_of(T.rows(), -1);
  std::vector<std::vector<int>> patches;
  const auto alike = [&](int a, int b) {
    return bulk[b] > 0 && shear[b] <= kAlike * shear[a] && shear[a] <= kAlike * shear[b];
  };

  for (const int seed : order) {
    if (patch_of[seed] >= 0) continue;
    std::vector<int> patch{seed}, nodes(T.row(seed).begin(), T.row(seed).end());
    patch_of[seed] = int(patches.size());
    while (bulk[seed] > 0 && int(patch.size()) < size) {
      int best = -1, most = -1;
      for (const int t : patch)
        for (const int n : neighbour[t]) {
          if (n < 0 || patch_of[n] >= 0 || !alike(seed, n)) continue;
          // Prefers the tet that shares most nodes with the patch. If several share equally many, prefers the tet with
          // the fewest neighbours that are in no patch yet.
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

  // Merges each patch that has less than half of the intended number of tets into its smallest neighbouring patch.
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

PatchForm::PatchForm(const ElasticForm& tets, std::vector<std::int64_t> first, const std::vector<double>& bulk,
                     std::vector<double> filled)
    : first_(std::move(first)),
      filled_(std::move(filled)),
      tissue_(tets.size()) {
  for (std::int64_t t = 0; t < tets.size(); ++t) tissue_[t] = filled_[t] * tets.tet(t).volume;
  for (std::size_t p = 0; p + 1 < first_.size(); ++p) {
    double tissue = 0, of_bulk = 0;
    for (auto t = first_[p]; t < first_[p + 1]; ++t) tissue += tissue_[t], of_bulk += tissue_[t] * bulk[t];
    patch_tissue_.push_back(tissue);
    stiffness_.push_back(of_bulk > 0 ? of_bulk / (tissue * tissue) : 0);
  }
}

double PatchForm::mean_ratio(std::size_t p, const std::vector<double>& J) const {
  double sum = 0;
  for (auto t = first_[p]; t < first_[p + 1]; ++t) sum += tissue_[t] * J[t];
  return sum / patch_tissue_[p];
}

double PatchForm::value(const std::vector<double>& J) const {
  return parallel_sum(std::ssize(stiffness_), kGrain, [&](std::int64_t begin, std::int64_t end) {
    double sum = 0;
    for (auto p = begin; p < end; ++p) {
      if (stiffness_[p] == 0) continue;
      const double off = patch_tissue_[p] * (mean_ratio(p, J) - 1);
      sum += 0.5 * stiffness_[p] * off * off;
    }
    return sum;
  });
}

void PatchForm::pressures(const std::vector<double>& J, std::vector<double>& pressure) const {
  pressure.assign(J.size(), 0);
  for (std::size_t p = 0; p < stiffness_.size(); ++p) {
    if (stiffness_[p] == 0) continue;
    const double whole = stiffness_[p] * patch_tissue_[p] * (mean_ratio(p, J) - 1);
    for (auto t = first_[p]; t < first_[p + 1]; ++t) pressure[t] = filled_[t] * whole;
  }
}

}  // namespace limber
