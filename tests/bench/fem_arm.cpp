// SPDX-License-Identifier: AGPL-3.0-or-later
// What finite elements cost on a real arm, as text. Called as
//   limber_fem_arm VOLUME RIG [BONE [DEGREES [SPACING_MM...]]]
// meshes the tissue that flexing BONE by DEGREES bends, and solves it with and without contact. CPU seconds of one thread;
// what the machine's other work does to them is told by the one factorization that stands beside.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/fem/solve_pose.h"
#include "core/fem/tissue_model.h"
#include "core/mesh/crossings.h"
#include "core/mesh/mesh_tissue.h"
#include "core/resample/pose_path.h"
#include "core/rig/armature_io.h"
#include "core/rig/bone_tissue.h"
#include "core/rig/fit_joint.h"
#include "core/skin/heat_diffusion.h"
#include "core/volume/volume_io.h"

namespace {
using namespace limber;

struct Arm {
  VolumeFile file;
  TissueTable tissues;
  Armature rig;
  TissueVoxels tissue;
  SkinWeights weights;
  Pose pose;
  LabelSet is_bone = LabelSet(65536, 0);

  Arm(const std::string& volume, const std::string& rig_file, const std::string& bone, double degrees)
      : file(read_volume(volume)), tissues(merge_tissue_tables(file.tissues, nullptr)), rig(read_armature_file(rig_file).armature), tissue(file.volume) {
    if (const auto guess = guess_bone_tissue(file.volume, tissues, rig)) tissues = with_bones(tissues, {tissues.find(guess->label)->file_value});
    for (const Tissue& t : tissues.tissues) is_bone[t.label] = limber::is_bone(t.kind);
    const BoneParts parts = split_bones(file.volume, tissue, tissues, rig);
    weights = diffuse_heat(file.volume, tissue, tissues, rig, parts);
    pose = rest_pose(rig);
    flex(pose, rig, require_bone(rig, bone), degrees);
    FittedPose fitted = fit_joints(file.volume, tissue, parts, rig, pose);
    rig = std::move(fitted.armature);
    pose = std::move(fitted.pose);
  }
  std::vector<RigidTransform> at(double t) const { return bone_motions(weights.bones(), rig, part_of_pose(pose, t)); }
};

void print(const SolvedPose& solved, const TissueModel& model) {
  const FemSeconds& s = solved.seconds;
  const double factorization = s.factorization / solved.factorizations;
  const auto crossings = crossing_pairs(solved.V, boundary_of(model.fem.mesh.T)).size();
  std::printf("  %s at %.0f %%: %.1f CPU s (contact %.1f, analysis %.1f, assembly %.1f, factorization %.1f, search %.1f), %d steps, %d iterations of %.2f factorizations\n",
              solved.converged ? "converged" : solved.blocked_by.c_str(), 100 * solved.reached, s.total, s.contact, s.analysis, s.assembly, s.factorization,
              s.search, solved.steps, solved.iterations, s.total / solved.iterations / factorization);
  std::printf("  smallest det F %.3f (on the way %.3f), inverted %lld, crossing pairs %zu\n", solved.min_det_f, solved.min_det_f_of_path,
              static_cast<long long>(solved.inverted), crossings);
  for (const auto& [label, change] : volume_change_percent(model, solved.V)) std::printf("  label %d %+.3f %%", int(label), change);
  std::printf("\n");
}

void measure(const Arm& arm, double spacing) {
  const BonePath path = [&](double t) { return arm.at(t); };
  const MovingTissue moving = moving_tissue(arm.file.volume, arm.tissue, arm.weights, path, {.contact = true});
  const LabelVolume regions = regions_to_mesh(arm.file.volume, arm.tissue, arm.is_bone, arm.weights, moving);
  const TissueMesh mesh = mesh_tissue(regions, {.spacing_mm = spacing});
  const TissueModel model = tissue_model(arm.file.volume, arm.tissue, arm.tissues, arm.weights, moving, mesh.mesh);
  std::printf("h %g mm: %ld nodes, %ld tets %s\n", spacing, long(mesh.mesh.V.rows()), long(mesh.mesh.T.rows()), mesh.warning.c_str());
  for (const bool contact : {false, true}) {
    std::printf(" %s contact\n", contact ? "with" : "without");
    print(solve_pose(model.fem, path, largest_angle_degrees(arm.pose), {.contact = contact}), model);
  }
}
}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) {
    std::fprintf(stderr, "usage: limber_fem_arm VOLUME RIG [BONE [DEGREES [SPACING_MM...]]]\n");
    return 2;
  }
  const std::vector<std::string> words(arguments, arguments + count);
  const double degrees = count > 4 ? std::strtod(arguments[4], nullptr) : 90;
  const ThreadCount one(1);
  const Arm arm(words[1], words[2], count > 3 ? words[3] : "Forearm", degrees);
  if (count <= 5) measure(arm, 8);
  for (int k = 5; k < count; ++k) measure(arm, std::strtod(arguments[k], nullptr));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
