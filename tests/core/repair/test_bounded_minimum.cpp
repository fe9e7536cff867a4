// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/bounded_minimum.h"

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("bounded minimum: a quadratic function's minimum is found, on the bounds where it lies outside") {
  // Minimizes sum a_i (x_i - c_i)^2: each variable has its own minimum, clamped to [0, 1].
  const std::vector<double> a{1, 50, 3, 7, 400}, c{0.3, 1.4, -0.2, 0.999, 0.5};
  const auto function = [&](std::span<const double> x, std::span<double> gradient) {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += a[i] * (x[i] - c[i]) * (x[i] - c[i]);
      gradient[i] = 2 * a[i] * (x[i] - c[i]);
    }
    return sum;
  };
  int steps = 0;
  const BoundedMinimum found =
      bounded_minimum(function, std::vector<double>(5, 0.9), 200, 1e-14, [&](int step) { steps = step; });
  for (std::size_t i = 0; i < c.size(); ++i)
    CHECK(found.x[i] == doctest::Approx(std::clamp(c[i], 0.0, 1.0)).epsilon(1e-4));
  CHECK(steps == found.iterations);
}

TEST_CASE("bounded minimum: Rosenbrock's curved valley is followed to its end, or to the bound across it") {
  // Minimizes (1 - u)^2 + 100 (v - u^2)^2 with u = scale x, v = scale y. The minimum is at u = v = 1.
  const auto rosenbrock = [](double scale) {
    return [scale](std::span<const double> x, std::span<double> gradient) {
      const double u = scale * x[0], v = scale * x[1], bend = v - u * u;
      gradient[0] = scale * (-2 * (1 - u) - 400 * u * bend);
      gradient[1] = scale * 200 * bend;
      return (1 - u) * (1 - u) + 100 * bend * bend;
    };
  };
  const BoundedMinimum inside = bounded_minimum(rosenbrock(2), {0.05, 0.9}, 500, 0, [](int) {});
  CHECK(inside.x[0] == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(inside.x[1] == doctest::Approx(0.5).epsilon(1e-3));
  // With u and v bounded by 0.8, the minimum is at u = 0.8, v = 0.64.
  const BoundedMinimum bounded = bounded_minimum(rosenbrock(0.8), {0.1, 0.9}, 500, 0, [](int) {});
  CHECK(bounded.x[0] == doctest::Approx(1).epsilon(1e-3));
  CHECK(bounded.x[1] == doctest::Approx(0.8).epsilon(1e-3));
}

TEST_CASE("bounded minimum: from a minimum nothing moves") {
  const auto flat = [](std::span<const double> x, std::span<double> gradient) {
    for (double& each : gradient) each = 0;
    return 3.0 + 0 * x[0];
  };
  const BoundedMinimum found = bounded_minimum(flat, {0.2, 0.7}, 50, 1e-9, [](int) {});
  CHECK(found.x == std::vector<double>{0.2, 0.7});
  CHECK(found.value == 3);
}
