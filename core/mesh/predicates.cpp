// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/predicates.h"

#include <cmath>
#include <limits>

namespace limber {

namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;

// A number as the exact sum of at most N doubles whose bits do not overlap, in ascending order of magnitude.
template <int N>
struct Expansion {
  std::array<double, N> part;
  int count = 0;

  void push(double value) {
    if (value != 0) part[count++] = value;
  }
  int sign() const { return count == 0 ? 0 : part[count - 1] > 0 ? 1 : -1; }
};

// Computes sum = a + b, rounded, and its rounding error `rest`, so that a + b = sum + rest exactly.
void two_sum(double a, double b, double& sum, double& rest) {
  sum = a + b;
  const double b_part = sum - a;
  rest = (a - (sum - b_part)) + (b - b_part);
}

template <int N>
void grow(Expansion<N>& e, double value) {
  Expansion<N> result;
  for (int i = 0; i < e.count; ++i) {
    double rest;
    two_sum(e.part[i], value, value, rest);
    result.push(rest);
  }
  result.push(value);
  e = result;
}

Expansion<2> difference(double a, double b) {
  double sum, rest;
  two_sum(a, -b, sum, rest);
  Expansion<2> e;
  e.push(rest);
  e.push(sum);
  return e;
}

template <int N, int M>
Expansion<2 * N * M> operator*(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<2 * N * M> product;
  for (int i = 0; i < a.count; ++i)
    for (int j = 0; j < b.count; ++j) {
      const double high = a.part[i] * b.part[j];
      grow(product, std::fma(a.part[i], b.part[j], -high));
      grow(product, high);
    }
  return product;
}

template <int N, int M>
Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<N + M> sum;
  for (int i = 0; i < a.count; ++i) sum.push(a.part[i]);
  for (int i = 0; i < b.count; ++i) grow(sum, b.part[i]);
  return sum;
}

template <int N>
Expansion<N> operator-(Expansion<N> a) {
  for (int i = 0; i < a.count; ++i) a.part[i] = -a.part[i];
  return a;
}

int sign_of(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

int exact_side_3d(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c,
                  const std::array<double, 3>& d) {
  Expansion<2> u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i)
    u[i] = difference(b[i], a[i]), v[i] = difference(c[i], a[i]), w[i] = difference(d[i], a[i]);
  const auto term = [&](int i, int j, int k) { return (u[j] * v[k] + -(u[k] * v[j])) * w[i]; };
  return (term(0, 1, 2) + term(1, 2, 0) + term(2, 0, 1)).sign();
}

}  // namespace

int side_2d(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
  const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]), det = left - right;
  if (std::abs(det) > 4 * kUnit * (std::abs(left) + std::abs(right))) return sign_of(det);
  return (difference(b[0], a[0]) * difference(c[1], a[1]) + -(difference(b[1], a[1]) * difference(c[0], a[0]))).sign();
}

int side_3d(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c,
            const std::array<double, 3>& d) {
  double u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) u[i] = b[i] - a[i], v[i] = c[i] - a[i], w[i] = d[i] - a[i];
  double det = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double plus = u[j] * v[k], minus = u[k] * v[j];
    det += (plus - minus) * w[i];
    size += (std::abs(plus) + std::abs(minus)) * std::abs(w[i]);
  }
  if (std::abs(det) > 10 * kUnit * size) return sign_of(det);
  return exact_side_3d(a, b, c, d);
}

}  // namespace limber
