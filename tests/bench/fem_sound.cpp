// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks a finite element solution on a real arm. Counts inverted tets and crossing surfaces at every iteration and at
// the end, and measures how much the volume of each tissue changes, by tets and by voxels. Prints the same for a
// baseline like Bender's (one Poisson ratio of 0.3, linear tets, no contact). Called as
//   limber_fem_sound VOLUME RIG [SPACING_MM [DEGREES...]]
// Crossings are also found by CGAL, if it was installed at build time.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "core/mesh/crossings.h"
#include "core/report/metrics.h"
#include "tests/support/bent_arm.h"
#ifdef LIMBER_CGAL
#include "tests/support/crossings_cgal.h"
#endif

namespace {
using namespace limber;

constexpr std::int64_t kLarge = 5000;  // voxels; smaller tissues are not reported

long long crossings_by_cgal([[maybe_unused]] const Eigen::MatrixX3d& V, [[maybe_unused]] const Eigen::MatrixX3i& F) {
#ifdef LIMBER_CGAL
  return std::ssize(test::crossings_by_cgal(V, F));
#else
  return -1;
#endif
}

double least(const std::vector<double>& ratios, const TissueModel& model, long long& inverted) {
  double smallest = 1;
  for (std::size_t t = 0; t < ratios.size(); ++t) {
    inverted += ratios[t] <= 0;
    if (!model.joint[t] && model.fem.mesh.region[t] == TetMesh::kSoft) smallest = std::min(smallest, ratios[t]);
  }
  return smallest;
}

// Counts the inverted tets and the crossings of all iterations of a solve, and keeps the smallest volume ratio of a
// tet.
struct Path {
  TissueModel model;
  Eigen::MatrixX3i border;
  long long inverted = 0, crossings = 0, seen = 0;
  double smallest = 1;
  void see(const Eigen::MatrixX3d& V) {
    smallest = std::min(smallest, least(volume_ratios(model.fem.mesh, V), model, inverted));
    crossings += crossings_by_cgal(V, border);
    ++seen;
  }
};

struct Losses {
  // Volume changes in %: `worst` is the largest of one tissue, `sum` the mean of all tissues, weighted by their volume.
  double worst = 0, sum = 0;
};

Losses losses(const test::BentArm& arm, const std::map<Label, double>& change, const VolumeMetrics& voxels) {
  Losses result;
  double total = 0;
  for (const TissueChange& each : voxels.tissues) {
    const auto at = change.find(each.label);
    if (each.voxels_before < kLarge || arm.is_bone[each.label] || at == change.end()) continue;
    result.worst = std::max(result.worst, std::abs(at->second));
    result.sum += each.mm3_before * at->second;
    total += each.mm3_before;
  }
  result.sum /= total;
  return result;
}

// Solves the same mesh in the same steps, but as Bender does: with the same Young's modulus, a Poisson ratio of 0.3 (so
// low that tets need not share pressures), and no contact.
SolvedPose as_bender(const test::BentArm& arm, FemModel model) {
  for (TetMaterial& each : model.material) each = {each.shear_modulus * (1 + each.poisson_ratio) / 1.3, 0.3};
  return solve_pose(
      model, [&](double t) { return arm.motions(t); }, largest_angle_degrees(arm.pose));
}

void show(test::BentArm& arm, double spacing, double degrees) {
  arm.bend(degrees);
  Path path;
  const Posed posed = arm.posed(
      Fem{.contact = true,
          .spacing_mm = spacing,
          .on_mesh = [&](const TissueModel& model) { path.model = model, path.border = boundary_of(model.fem.mesh.T); },
          .on_step = [&](const SolveStep& step) { path.see(step.V); }});
  const DeformReport& report = posed.report;
  const MeshReport& mesh = *report.mesh;
  std::printf("+%g degrees, h %g mm: %s; %d steps, %d iterations\n", degrees, spacing,
              report.solve->converged ? "reached" : report.solve->blocked_by.c_str(), report.solve->steps,
              report.solve->iterations);
  std::printf(
      "  at the end: inverted %lld, det F of flesh at least %.3f, %.3f %% below 0.2, crossing pairs %lld, by CGAL "
      "%lld\n",
      static_cast<long long>(mesh.inverted), mesh.min_det_f, 100 * mesh.share_below_fifth,
      static_cast<long long>(mesh.self_intersections.value_or(-1)), crossings_by_cgal(posed.shape->V, path.border));
  std::printf(
      "  at each of %lld iterations: inverted %lld, det F of flesh at least %.3f, crossing pairs by CGAL %lld\n",
      path.seen, path.inverted, path.smallest, path.crossings);
  std::printf(
      "  air between what touches: least %.2f, median %.2f mm at %lld nodes; voxels covered twice %lld, torn open "
      "%lld\n",
      mesh.min_gap_mm.value_or(NAN), mesh.median_gap_mm.value_or(NAN), static_cast<long long>(mesh.contact_nodes),
      static_cast<long long>(report.overlap_voxels), static_cast<long long>(report.new_hole_voxels));

  const VolumeMetrics voxels = compare(arm.volume, posed.volume, arm.tissues);
  std::printf(
      "  by voxels: all tissue %+.3f %%, skin on %.3f %% of the surface (rest %.3f %%), air trapped %lld voxels\n",
      voxels.volume_change_percent, 100 * voxels.skin_share_after, 100 * voxels.skin_share_before,
      static_cast<long long>(voxels.trapped_air_voxels));
  const SolvedPose bender = as_bender(arm, path.model.fem);
  const auto bender_change = volume_change_percent(path.model, bender.V);
  std::printf("  as Bender: %s at %.0f %%, det F at least %.3f, crossing pairs %zu\n",
              bender.converged ? "reached" : bender.blocked_by.c_str(), 100 * bender.reached, bender.min_det_f,
              crossing_pairs(bender.V, path.border).size());
  std::printf("  %-24s %10s %10s %10s %10s %12s\n", "tissue", "voxels", "mesh %", "Bender %", "voxels %", "parts");
  for (const TissueChange& each : voxels.tissues) {
    const auto at = mesh.volume_change_percent.find(each.label), was = bender_change.find(each.label);
    if (each.voxels_before >= kLarge)
      std::printf("  %-24s %10lld %+10.3f %+10.3f %+10.3f %5d > %d%s\n",
                  (each.name.empty() ? std::to_string(int(each.file_value)) : each.name).c_str(),
                  static_cast<long long>(each.voxels_before), at == mesh.volume_change_percent.end() ? 0 : at->second,
                  was == bender_change.end() ? 0 : was->second, each.volume_change_percent, each.components_before,
                  each.components_after, arm.is_bone[each.label] ? "  bone" : "");
    else if (each.components_before != each.components_after)
      std::printf("  %-24g %10lld %10s %10s %+10.3f %5d > %d\n", each.file_value,
                  static_cast<long long>(each.voxels_before), "", "", each.volume_change_percent,
                  each.components_before, each.components_after);
  }
  const Losses ours = losses(arm, mesh.volume_change_percent, voxels), theirs = losses(arm, bender_change, voxels);
  std::printf(
      "  soft tissue by mesh: all %+.4f %%, as Bender %+.4f %% (%.0f times); worst %.4f %%, as Bender %.4f %% (%.0f "
      "times; goal 20)\n",
      ours.sum, theirs.sum, std::abs(theirs.sum / ours.sum), ours.worst, theirs.worst, theirs.worst / ours.worst);
  std::fflush(stdout);
}
}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) {
    std::fprintf(stderr, "usage: limber_fem_sound VOLUME RIG [SPACING_MM [DEGREES...]]\n");
    return 2;
  }
#ifndef LIMBER_CGAL
  std::printf("SKIPPED: crossings by CGAL (built without libcgal-dev)\n");
#endif
  test::BentArm arm(arguments[1], arguments[2]);
  const double spacing = count > 3 ? std::strtod(arguments[3], nullptr) : 8;
  if (count <= 4)
    for (const double degrees : {45.0, 60.0, 90.0}) show(arm, spacing, degrees);
  for (int k = 4; k < count; ++k) show(arm, spacing, std::strtod(arguments[k], nullptr));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
