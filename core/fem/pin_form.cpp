// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/pin_form.h"

namespace limber {

double PinForm::value(const NodePositions& x) const {
  double sum = 0;
  for (std::size_t k = 0; k < node.size(); ++k)
    sum += 0.5 * (stiffness.row(k).array() * (x.row(node[k]) - target.row(k)).array().square()).sum();
  return sum;
}

void PinForm::add_gradient(const NodePositions& x, NodePositions& gradient) const {
  for (std::size_t k = 0; k < node.size(); ++k)
    gradient.row(node[k]).array() += stiffness.row(k).array() * (x.row(node[k]) - target.row(k)).array();
}

void PinForm::add_curvature(const Cholesky& matrix, std::span<const int> unknown, std::span<double> values) const {
  for (std::size_t k = 0; k < node.size(); ++k) {
    if (unknown[node[k]] < 0) continue;
    const auto place = matrix.place(unknown[node[k]], unknown[node[k]]);
    for (int c = 0; c < 3; ++c) values[place.at + c * (place.stride + 1)] += stiffness(k, c);
  }
}

}  // namespace limber
