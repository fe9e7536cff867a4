// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/slide_form.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace limber {

namespace {

Eigen::Matrix3d matrix_of(const glm::dquat& rotation) {
  const glm::dmat3 columns = glm::mat3_cast(rotation);
  Eigen::Matrix3d R;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) R(row, column) = columns[column][row];
  return R;
}

// Returns the nearest matrix without negative eigenvalues.
Eigen::Matrix3d without_negative(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(symmetric);
  return axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).asDiagonal() * axes.eigenvectors().transpose();
}

}  // namespace

Eigen::RowVector3d SlideForm::in_bone(const Node& node, const NodePositions& x) const {
  const int v = node.node;
  glm::dvec3 p(x(v, 0), x(v, 1), x(v, 2));
  if (moved.rows()) p -= glm::dvec3(moved(v, 0), moved(v, 1), moved(v, 2));
  const glm::dvec3 y = inverse(posed_from_rest[node.bone]) * p;
  return {y.x, y.y, y.z};
}

double SlideForm::value(const NodePositions& x) const {
  double sum = 0;
  for (const Node& each : nodes) {
    const Eigen::RowVector3d y = in_bone(each, x);
    const double off = surface[each.bone]->at(y).mm - each.rest_mm;
    sum += 0.5 * each.normal * off * off + 0.5 * each.fascia * (y - each.rest).squaredNorm();
  }
  return sum;
}

void SlideForm::add_gradient(const NodePositions& x, NodePositions& gradient) const {
  for (const Node& each : nodes) {
    const Eigen::RowVector3d y = in_bone(each, x);
    const DistanceAt distance = surface[each.bone]->at(y);
    const Eigen::Vector3d force =
        each.normal * (distance.mm - each.rest_mm) * distance.slope + each.fascia * (y - each.rest).transpose();
    gradient.row(each.node) += (matrix_of(posed_from_rest[each.bone].rotation) * force).transpose();
  }
}

Eigen::Matrix3d SlideForm::curvature_of(const Node& node, const NodePositions& x, HessianKind curvature) const {
  const DistanceAt distance = surface[node.bone]->at(in_bone(node, x));
  Eigen::Matrix3d bent = (distance.mm - node.rest_mm) * distance.curvature;
  if (curvature == HessianKind::Projected) bent = without_negative(bent);
  Eigen::Matrix3d H = node.normal * (distance.slope * distance.slope.transpose() + bent);
  H.diagonal().array() += node.fascia;
  const Eigen::Matrix3d R = matrix_of(posed_from_rest[node.bone].rotation);
  return R * H * R.transpose();
}

void SlideForm::add_curvature(const NodePositions& x, HessianKind curvature, const Cholesky& matrix,
                              std::span<const int> unknown, std::span<double> values) const {
  for (const Node& each : nodes) {
    const int row = unknown[each.node];
    if (row < 0) continue;
    const Eigen::Matrix3d H = curvature_of(each, x, curvature);
    const auto place = matrix.place(row, row);
    for (int column = 0; column < 3; ++column)
      for (int c = column; c < 3; ++c) values[place.at + column * place.stride + c] += H(c, column);
  }
}

SlideForm::Slide SlideForm::slide_of(const Node& node, const NodePositions& x) const {
  const Eigen::RowVector3d y = in_bone(node, x);
  return {(y - node.rest).norm(), std::abs(surface[node.bone]->at(y).mm - node.rest_mm)};
}

SlideForm::Slide SlideForm::largest(const NodePositions& x) const {
  Slide largest;
  for (const Node& each : nodes) {
    const Slide slide = slide_of(each, x);
    largest = {std::max(largest.along, slide.along), std::max(largest.off, slide.off)};
  }
  return largest;
}

}  // namespace limber
