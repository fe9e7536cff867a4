// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures what finite elements cost on a real arm, beside one factorization of the same matrix and a resampling by
// dual quaternions. Called as
//   limber_fem_arm VOLUME RIG [SPACING_MM:DEGREES[:free|:same]...]
//     free: without contact, on the mesh that is made for solving without contact
//     same: without contact, on the mesh that is made for solving with contact; it is larger, because it also holds
//           tissue that comes together only in the pose
// Prints CPU seconds of one thread, of this process and of TetGen's. The seconds of the factorization show how much
// other work on the machine slows the figures down.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/crossings.h"
#include "core/report/report.h"
#include "tests/bench/cpu_seconds.h"
#include "tests/support/bent_arm.h"

namespace {
using namespace limber;
using bench::cpu_seconds;

struct Row {
  double spacing, degrees;
  std::string kind;  // "contact", or "free" or "same" as on the command line
};

Row row_of(const std::string& word) {
  Row row{std::strtod(word.c_str(), nullptr), 90,
          word.ends_with(":free")   ? "free"
          : word.ends_with(":same") ? "same"
                                    : "contact"};
  if (const auto colon = word.find(':'); colon != std::string::npos)
    row.degrees = std::strtod(word.c_str() + colon + 1, nullptr);
  return row;
}

// Makes the finite element model with the mesh for contact, and stops before it is solved.
TissueModel model_with_contact(const test::BentArm& arm, double spacing) {
  struct Enough {};
  TissueModel model;
  try {
    arm.solved({.contact = true, .spacing_mm = spacing, .on_mesh = [&](const TissueModel& meshed) {
                  model = meshed;
                  throw Enough();
                }});
  } catch (const Enough&) {
  }
  return model;
}

// What one case of the command line costs. The printed row also gives the seconds of one iteration divided by those of
// one factorization, and divided by those of one factorization and one ordering together.
//   mesh  CPU seconds of meshing; 0 if the mesh was made before the measurement began
struct Cost {
  long long tets, crossings;
  double mesh, solve, min_det_f;
  FemSeconds seconds;
  int iterations, factorizations, analyses;
  std::string end;
};

void print(const Row& row, const Cost& cost) {
  const FemSeconds& s = cost.seconds;
  const double factorization = s.factorization / cost.factorizations, ordering = s.ordering / cost.analyses,
               iteration = s.total / cost.iterations;
  std::printf(
      "%4g %5g %-7s %7lld %6.3f %7.2f %6.1f%% %7.2f %5.2f %5.2f %6.2f %5.2f %5d %6d %6.2f %6.2f %6.2f %7.3f %5lld "
      "%7.0f  %s\n",
      row.spacing, row.degrees, row.kind.c_str(), cost.tets, cost.mesh, cost.solve, 100 * cost.mesh / cost.solve,
      s.factorization, s.assembly, s.contact, s.analysis, s.search, cost.iterations, cost.analyses, factorization,
      iteration / factorization, iteration / (factorization + ordering), cost.min_det_f, cost.crossings,
      peak_memory_mb(), cost.end.c_str());
  std::fflush(stdout);
}

void measure_same(const test::BentArm& arm, const Row& row) {
  const TissueModel model = model_with_contact(arm, row.spacing);
  const double start = cpu_seconds();
  const SolvedPose solved =
      solve_pose(model.fem, [&](double t) { return arm.motions(t); }, row.degrees,
                 {.step_tolerance_mm = row.spacing / 2, .bone_drift_mm = std::max(2.0, row.spacing / 2)});
  const double spent = cpu_seconds() - start;
  const auto crossings = std::ssize(crossing_pairs(solved.V, boundary_of(model.fem.mesh.T)));
  print(row, {model.fem.mesh.T.rows(), crossings, 0, spent, solved.min_det_f, solved.seconds, solved.iterations,
              solved.factorizations, solved.analyses, solved.converged ? "reached" : solved.blocked_by});
}

void measure(test::BentArm& arm, const Row& row) {
  arm.bend(row.degrees);
  if (row.kind == "same") return measure_same(arm, row);
  const double start = cpu_seconds();
  double meshed = 0;
  const auto shape =
      arm.solved({.contact = row.kind == "contact", .spacing_mm = row.spacing, .on_mesh = [&](const TissueModel&) {
                    meshed = cpu_seconds();
                  }});
  const SolveReport& solve = shape->solve;
  print(row, {shape->mesh.tets, static_cast<long long>(shape->mesh.self_intersections.value_or(-1)), meshed - start,
              cpu_seconds() - meshed, shape->mesh.min_det_f, shape->cpu, solve.iterations, solve.factorizations,
              solve.analyses, solve.converged ? "reached" : solve.blocked_by});
}
}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) {
    std::fprintf(stderr, "usage: limber_fem_arm VOLUME RIG [SPACING_MM:DEGREES[:free|:same]...]\n");
    return 2;
  }
  std::vector<std::string> words(arguments + 3, arguments + count);
  if (words.empty()) words = {"12:90", "12:90:free", "8:45", "8:90", "8:90:free", "8:90:same", "6:90", "4:15"};
  const ThreadCount one(1);
  test::BentArm arm(arguments[1], arguments[2]);
  const double start = cpu_seconds();
  arm.bend(90);
  const double fitted = cpu_seconds();
  arm.posed(Blend::DualQuaternion);
  std::printf("fitting the joint to +90: %.2f s; resampling by dual quaternions: %.2f s\n", fitted - start,
              cpu_seconds() - fitted);
  std::printf("%4s %5s %-7s %7s %6s %7s %7s %7s %5s %5s %6s %5s %5s %6s %6s %6s %6s %7s %5s %7s\n", "h mm", "angle", "",
              "tets", "mesh s", "solve s", "of it", "factor.", "assem", "cont.", "analys", "search", "iter", "analys",
              "fact.s", "it/fac", "it/new", "det F", "cross", "peak MB");
  for (const std::string& word : words) measure(arm, row_of(word));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
