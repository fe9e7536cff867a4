// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <ostream>

#include "core/report/report.h"

namespace limber {

namespace {

// Returns one line of a table, formatted as by printf, of any length.
[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  std::string text(static_cast<size_t>(std::vsnprintf(nullptr, 0, format, values)) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  va_end(values);
  text.back() = '\n';
  return text;
}

std::string components_of(const TissueChange& tissue) {
  const std::string before = std::to_string(tissue.components_before);
  if (tissue.components_before == tissue.components_after) return before;
  return before + " -> " + std::to_string(tissue.components_after);
}

void print_stretch(std::ostream& out, const VolumeMetrics& metrics, const MeshReport& mesh) {
  out << line("%8s  %-28s %36s", "label", "stretch of bent tissue", "smallest, largest: median (5-95 %)");
  for (const TissueChange& tissue : metrics.tissues)
    if (const auto found = mesh.stretch.find(tissue.label); found != mesh.stretch.end()) {
      const auto& [least, most] = found->second;
      out << line("%8.0f  %-28.28s   %5.2f (%.2f to %.2f), %5.2f (%.2f to %.2f)", tissue.file_value,
                  tissue.name.c_str(), least[1], least[0], least[2], most[1], most[0], most[2]);
    }
}

void print_glide(std::ostream& out, const std::vector<GlidedJoint>& joints) {
  if (joints.empty()) return;
  out << line("%-24s %-24s %10s %10s %12s %10s", "shifted joint", "overlapped bone", "shift, mm", "limit, mm",
              "overlap, mm", "after, mm");
  for (const GlidedJoint& joint : joints)
    out << line("%-24.24s %-24.24s %10.1f %10.1f %12.1f %10.1f %s", joint.bone.c_str(), joint.against.c_str(),
                glm::length(joint.shift), joint.most_mm, joint.depth_before, joint.depth_after,
                joint.free ? "separated" : "STILL OVERLAPS");
}

void print_tissues(std::ostream& out, const VolumeMetrics& metrics) {
  out << line("%8s  %-28s %12s %12s %10s %12s", "label", "tissue", "voxels", "after", "change, %", "components");
  for (const TissueChange& tissue : metrics.tissues)
    out << line("%8.0f  %-28.28s %12lld %12lld %+10.2f %12s", tissue.file_value, tissue.name.c_str(),
                static_cast<long long>(tissue.voxels_before), static_cast<long long>(tissue.voxels_after),
                tissue.volume_change_percent, components_of(tissue).c_str());
  out << line("%8s  %-28s %12lld %12lld %+10.2f", "", "all tissue", static_cast<long long>(metrics.voxels_before),
              static_cast<long long>(metrics.voxels_after), metrics.volume_change_percent);
}

void print_error(std::ostream& out, const FemError& error) {
  if (!error.unknown.empty()) {
    out << line("error of the solve: no estimate, %s", error.unknown.c_str());
    return;
  }
  out << line(
      "error of the solve, estimated by a second solve with tets of %.3g mm: %.2f mm rms, 95 %% of the flesh below "
      "%.2f mm, largest %.1f mm at (%.0f, %.0f, %.0f)",
      error.coarse_tet_mm, error.rms_mm, error.most_mm, error.largest_mm, error.place.x, error.place.y, error.place.z);
}

void print_solve(std::ostream& out, const Report& report, const DeformReport& deform) {
  if (deform.mesh) {
    const MeshReport& mesh = *deform.mesh;
    out << line("mesh of %lld tets, %lld inverted, smallest volume ratio (det F) %.3f, %.2f %% of soft tets below 0.2",
                static_cast<long long>(mesh.tets), static_cast<long long>(mesh.inverted), mesh.min_det_f,
                100 * mesh.share_below_fifth);
    if (report.metrics && !mesh.stretch.empty()) print_stretch(out, *report.metrics, mesh);
  }
  if (deform.solve) {
    const SolveReport& solve = *deform.solve;
    out << line("%s %.1f %% of the pose in %d steps, %d iterations, residual %.3f mm",
                solve.converged ? "solved:" : "NOT SOLVED, ended at", 100 * solve.reached, solve.steps,
                solve.iterations, solve.residual_mm);
    if (solve.repeated_in_double > 0)
      out << line("%d of %d factorizations repeated in double precision, as single precision was too inexact",
                  solve.repeated_in_double, solve.factorizations);
    if (solve.sliding_nodes > 0)
      out << line(
          "slides: %lld nodes of flesh slide over bone, the furthest by %.1f mm, and leave it by %.2f mm at most",
          static_cast<long long>(solve.sliding_nodes), solve.largest_slide_mm, solve.largest_slide_gap_mm);
    if (solve.error) print_error(out, *solve.error);
  }
  for (const ObjectReport& object : deform.objects)
    out << line(
        "%.60s presses with %.3g N on %.3g cm2, at most %.3g kPa, %.1f mm from its position, %lld crossing triangles",
        object.name.c_str(), object.pressing_n, object.area_mm2 / 100, object.largest_kpa, object.away_mm,
        static_cast<long long>(object.crossings));
}

}  // namespace

void print_report(std::ostream& out, const Report& report) {
  if (!report.method.empty()) out << "method " << report.method << "\n";
  if (report.metrics) {
    print_tissues(out, *report.metrics);
    if (report.metrics->has_skin)
      out << line("\nskin covers %.1f %% of the surface before and %.1f %% after",
                  100 * report.metrics->skin_share_before, 100 * report.metrics->skin_share_after);
    out << line("air trapped by the pose: %lld voxels", static_cast<long long>(report.metrics->trapped_air_voxels));
  }
  if (report.glide) print_glide(out, *report.glide);
  if (report.deform) {
    const DeformReport& deform = *report.deform;
    out << line("voxels: outside the grid %lld, new holes %lld, overlap %lld, bone in bone %lld, repaired %lld",
                static_cast<long long>(deform.dropped_voxels), static_cast<long long>(deform.new_hole_voxels),
                static_cast<long long>(deform.overlap_voxels), static_cast<long long>(deform.bone_overlap_voxels),
                static_cast<long long>(deform.mended_voxels));
    if (deform.settled && deform.settled->cells > 0)
      out << line(
          "volume of flesh restored: mean error of cells %.1f %% before, %.1f %% after; flesh moved by up to %.1f mm",
          100 * deform.settled->volume_error_before, 100 * deform.settled->volume_error_after,
          deform.settled->largest_shift_mm);
    for (const BakedJointReport& joint : deform.baked)
      out << line(
          "baked %.60s at %+.1f degrees: between baked angles 95 %% of flesh is within %.2f mm of finite elements",
          joint.bone.c_str(), joint.degrees, joint.worst_between.flesh_mm);
    std::int64_t moved = 0;
    for (const auto& [_, voxels] : deform.kept_organs) moved += std::abs(voxels);
    if (moved > 0)
      out << line("organs: %lld with a volume error of more than 5 %% gained or lost %lld voxels at their surface",
                  static_cast<long long>(deform.kept_organs.size()), static_cast<long long>(moved));
    if (deform.mass_exact)
      out << line("mass-exact: %lld voxels changed their label",
                  static_cast<long long>(deform.mass_exact->changed_voxels));
    double worst = 0;
    for (const auto& bone : deform.bones) worst = std::max(worst, bone.rigid_residual_mm);
    if (!deform.bones.empty())
      out << line("bone parts of %zu rig bones are rigid within %.4f mm", deform.bones.size(), worst);
  }
  if (report.deform) print_solve(out, report, *report.deform);
  if (const auto stages = stages_of(report.seconds); !stages.empty()) {
    out << "seconds";
    for (const auto& [stage, value] : stages) {
      const std::string text = line(" %.2f", value);
      out << "  " << stage << text.substr(0, text.size() - 1);
    }
    out << "\n";
  }
  out << line("peak memory %.0f MB", peak_memory_mb());
  if (!report.gates.empty()) out << "\n";
  for (const QualityGate& gate : report.gates)
    out << line("%-11s %s", gate.state == GateState::Failed ? "FAILED" : std::string(to_string(gate.state)).c_str(),
                gate.sentence.c_str());
}

}  // namespace limber
