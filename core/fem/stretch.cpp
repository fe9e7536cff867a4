// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/stretch.h"

#include <algorithm>
#include <vector>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/fem/tissue_model.h"

namespace limber {

namespace {

constexpr std::array<double, 3> kShares{0.05, 0.5, 0.95};

struct Weighed {
  double stretch;
  double mm3;
};

std::array<double, 3> percentiles(std::vector<Weighed> values) {
  std::sort(values.begin(), values.end(), [](const Weighed& a, const Weighed& b) { return a.stretch < b.stretch; });
  double all = 0, below = 0;
  for (const Weighed& value : values) all += value.mm3;
  std::array<double, 3> result{};
  std::size_t next = 0;
  for (const Weighed& value : values) {
    below += value.mm3;
    for (; next < 3 && below >= kShares[next] * all; ++next) result[next] = value.stretch;
  }
  return result;
}

bool held_wholly(const FemModel& model, int tet) {
  const int bone = model.held_by[model.mesh.T(tet, 0)];
  bool wholly = bone >= 0;
  for (int i = 1; i < 4; ++i) wholly &= model.held_by[model.mesh.T(tet, i)] == bone;
  return wholly;
}

}  // namespace

std::map<Label, Stretch> stretches(const TissueModel& model, const Eigen::MatrixX3d& V) {
  const TetMesh& mesh = model.fem.mesh;
  const auto edges = [&](const Eigen::MatrixX3d& P, int t) {
    Eigen::Matrix3d columns;
    for (int i = 0; i < 3; ++i) columns.col(i) = (P.row(mesh.T(t, i + 1)) - P.row(mesh.T(t, 0))).transpose();
    return columns;
  };
  std::map<Label, std::array<std::vector<Weighed>, 2>> seen;
  for (int t = 0; t < mesh.T.rows(); ++t) {
    if (model.joint[t] || mesh.region[t] != TetMesh::kSoft || held_wholly(model.fem, t)) continue;
    const Eigen::Matrix3d F = edges(V, t) * edges(mesh.V, t).inverse();
    const Eigen::Vector3d signed_svd = Eigen::JacobiSVD<Eigen::Matrix3d>(F).singularValues();
    for (std::int32_t i = model.first[t]; i < model.first[t + 1]; ++i) {
      auto& [least, most] = seen[model.parts[i].label];
      least.push_back({signed_svd[2], model.parts[i].mm3});
      most.push_back({signed_svd[0], model.parts[i].mm3});
    }
  }
  std::map<Label, Stretch> result;
  for (const auto& [label, values] : seen) result[label] = {percentiles(values[0]), percentiles(values[1])};
  return result;
}

}  // namespace limber
