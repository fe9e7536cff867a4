// SPDX-License-Identifier: AGPL-3.0-or-later
// What finite elements cost on a real arm, beside one factorization of the same matrix and a resampling by dual quaternions. Called as
//   limber_fem_arm VOLUME RIG [SPACING_MM:DEGREES[:free]...]     free: without contact
// CPU seconds of one thread, of this process and of TetGen's; what other work on the machine does to them is told by the factorization.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/report/report.h"
#include "tests/bench/cpu_seconds.h"
#include "tests/support/bent_arm.h"

namespace {
using namespace limber;
using bench::cpu_seconds;

struct Row {
  double spacing, degrees;
  bool contact;
};

Row row_of(const std::string& word) {
  Row row{std::strtod(word.c_str(), nullptr), 90, !word.ends_with(":free")};
  if (const auto colon = word.find(':'); colon != std::string::npos) row.degrees = std::strtod(word.c_str() + colon + 1, nullptr);
  return row;
}

void measure(test::BentArm& arm, const Row& row) {
  arm.bend(row.degrees);
  const double start = cpu_seconds();
  double meshed = 0;
  const auto shape = arm.solved({.contact = row.contact, .spacing_mm = row.spacing, .on_mesh = [&](const TissueModel&) { meshed = cpu_seconds(); }});
  const double mesh = meshed - start, solve = cpu_seconds() - meshed;
  const FemSeconds& s = shape->cpu;
  const double factorization = s.factorization / shape->solve.factorizations;
  std::printf("%4g %5g %-7s %7lld %6.2f %7.1f %6.1f%% %7.1f %5.1f %5.1f %6.2f %5.1f %5d %6.2f %6.2f %7.3f %5lld %7.0f  %s\n", row.spacing, row.degrees,
              row.contact ? "contact" : "free", static_cast<long long>(shape->mesh.tets), mesh, solve, 100 * mesh / solve, s.factorization, s.assembly, s.contact,
              s.analysis, s.search, shape->solve.iterations, factorization, s.total / shape->solve.iterations / factorization, shape->mesh.min_det_f,
              static_cast<long long>(shape->mesh.self_intersections.value_or(-1)), peak_memory_mb(),
              shape->solve.converged ? "reached" : shape->solve.blocked_by.c_str());
  std::fflush(stdout);
}
}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) {
    std::fprintf(stderr, "usage: limber_fem_arm VOLUME RIG [SPACING_MM:DEGREES[:free]...]\n");
    return 2;
  }
  std::vector<std::string> words(arguments + 3, arguments + count);
  if (words.empty()) words = {"12:90", "12:90:free", "8:45", "8:90", "8:90:free", "6:90", "4:15"};
  const ThreadCount one(1);
  test::BentArm arm(arguments[1], arguments[2]);
  const double start = cpu_seconds();
  arm.bend(90);
  const double fitted = cpu_seconds();
  arm.posed(DualQuaternion{});
  std::printf("fitting the joint to +90: %.2f s; resampling by dual quaternions: %.2f s\n", fitted - start, cpu_seconds() - fitted);
  std::printf("%4s %5s %-7s %7s %6s %7s %7s %7s %5s %5s %6s %5s %5s %6s %6s %7s %5s %7s\n", "h mm", "angle", "", "tets", "mesh s", "solve s", "of it", "factor.", "assem",
              "cont.", "analys", "search", "iter", "fact.s", "it/fac", "det F", "cross", "peak MB");
  for (const std::string& word : words) measure(arm, row_of(word));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
