// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bake/bake_joint.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <glm/gtc/packing.hpp>

#include "core/bake/corner_fit.h"
#include "core/bake/joint_corners.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/body/glide_poses.h"
#include "core/deform/bake_source.h"
#include "core/deform/baked_flesh.h"
#include "core/resample/fem_shape.h"
#include "core/resample/pose_path.h"
#include "core/resample/posed_voxels.h"
#include "core/resample/rigid_weights.h"

namespace limber {

namespace {

// Degrees: the smallest allowed extent of the range of angles, and the largest allowed angle at either end.
constexpr double kLeastRange = 5, kWidest = 170;
// Number of lattice nodes along an edge of a tet of the solver's mesh. The lattice stores how far solved positions
// differ from blended ones. This difference is linear within a tet, but its slope changes from tet to tet. With half as
// many nodes, tens of voxels in the crease of a bent elbow overlap.
constexpr double kNodesPerTet = 4;
constexpr int kLargestStep = 8;    // largest distance between nodes, voxels
constexpr double kNothing = 0.03;  // mm: a lattice node whose shift is never larger is left out
// Weight of a voxel corner inside bone in the fit; low, as bone is posed rigidly anyway.
constexpr float kBoneCorner = 0.1f;

// One angle at which the joint is solved, on one side of rest.
struct SolvedAngle {
  double degrees = 0;
  bool is_baked = false;                // false: the solve only serves to measure the error here
  std::vector<RigidTransform> motions;  // motions of the bones that the weights name, from rest to the pose
  Eigen::MatrixX3d V;
};
// The solves on one side of rest, which share a mesh.
struct SolvedSide {
  std::vector<SolvedAngle> angles;  // solved angles, from the one nearest to rest outwards
  std::shared_ptr<const TetMesh> mesh;
  DeformingRegion moving;
  double tet_mm = 0;
};

// The body and its data, which all solves of one joint use.
struct RigidTissue {
  const Body& body;
  const BoundBody& bound;
  LabelSets labels;
  SkinWeights weights;  // in bone tissue, each voxel follows one bone
};

std::string in_degrees(double degrees) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.4g degrees", degrees);
  return text;
}

void check(const Armature& rig, int bone, const BakeSettings& settings) {
  if (rig.bones[bone].parent < 0)
    throw Error("this bone has no joint to bake", rig.bones[bone].name, "choose a bone that has a parent");
  const bool is_range = settings.low <= 0 && settings.high >= 0 && settings.low >= -kWidest &&
                        settings.high <= kWidest && settings.high - settings.low >= kLeastRange;
  if (!is_range)
    throw Error(
        "a joint cannot be baked over this range", in_degrees(settings.low) + " to " + in_degrees(settings.high),
        "write two angles from rest, such as -20,100: the first from -170 to 0, the second from 0 to 170, at least 5 "
        "degrees apart");
  if (settings.angles < 1 || settings.angles > 30)
    throw Error("a joint cannot be baked at this number of angles", std::to_string(settings.angles),
                "write a number from 1 to 30");
}

// Returns the angles to solve on one side of rest: the baked angles, and halfway before each of them an angle at which
// only the error is measured.
std::vector<SolvedAngle> angles_to(double end, const BakeSettings& settings) {
  const double share = std::abs(end) / (settings.high - settings.low);
  const int baked = end == 0 ? 0 : std::max(1, static_cast<int>(std::lround(share * settings.angles)));
  std::vector<SolvedAngle> angles;
  for (int i = 1; i <= baked; ++i)
    for (const double back : {0.5, 0.0}) {
      SolvedAngle angle;
      angle.degrees = end * (i - back) / baked;
      angle.is_baked = back == 0;
      angles.push_back(std::move(angle));
    }
  return angles;
}

// Solves the angles on one side of rest in turn, up to the first that the solver does not reach.
SolvedSide solve_side(const RigidTissue& tissue, int bone, const glm::dvec3& axis, std::vector<SolvedAngle> angles,
                      const BakeSettings& settings, JointBake& bake, Progress& progress) {
  const Body& body = tissue.body;
  const glm::dvec3 voxel = body.file.volume.grid.spacing;
  std::vector<Pose> poses;
  for (const SolvedAngle& angle : angles) {
    poses.push_back(rest_pose(body.rig));
    poses.back().rotation[bone] = glm::angleAxis(glm::radians(angle.degrees), axis);
  }
  SkinWeights weights = tissue.weights;
  if (const auto glide = glide_settings(settings.glide, std::max({voxel.x, voxel.y, voxel.z}), settings.glide))
    glide_poses(poses, *glide, body, body.rig, tissue.bound.tissue, weights, progress);
  FemSequence sequence(body.file.volume, tissue.bound.tissue, body.tissues, tissue.labels.bone, tissue.weights,
                       body.rig, poses, {.contact = settings.contact, .quality = settings.quality, .is_exact = true},
                       progress);
  SolvedSide side;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const std::shared_ptr<const FemShape> shape = sequence.next(progress);
    if (!shape)
      throw Error("the joint bends no tissue, so there is nothing to bake", body.rig.bones[bone].name,
                  "choose another bone, or check the weights");
    if (!side.mesh) {
      side.mesh = std::make_shared<const TetMesh>(shape->model.fem.mesh);
      side.moving = shape->moving;
      side.tet_mm = shape->solve.parameters.finest_tet_mm;
      if (!shape->mesh.fallback.empty()) bake.warnings.push_back(shape->mesh.fallback);
    }
    if (shape->reached < 1) {
      bake.all_reached = false;
      bake.warnings.push_back(in_degrees(angles[i].degrees) +
                              " could not be reached, so this angle and all beyond it are not baked" +
                              (shape->solve.blocked_by.empty() ? "" : ": " + shape->solve.blocked_by));
      break;
    }
    if (!shape->solve.converged)
      bake.warnings.push_back("the shape at " + in_degrees(angles[i].degrees) +
                              " has not converged: " + shape->solve.blocked_by);
    angles[i].motions = bone_motions(tissue.weights.bones(), body.rig, shape->pose);
    angles[i].V = shape->V;
    side.angles.push_back(std::move(angles[i]));
  }
  while (!side.angles.empty() && !side.angles.back().is_baked) side.angles.pop_back();
  return side;
}

glm::ivec3 step_for(double tet_mm, const Grid& grid) {
  return glm::clamp(glm::ivec3(glm::floor(tet_mm / kNodesPerTet / grid.spacing)), glm::ivec3(1),
                    glm::ivec3(kLargestStep));
}

glm::vec3 in_half_precision(const glm::dvec3& v) {
  glm::vec3 half;
  for (int axis = 0; axis < 3; ++axis) half[axis] = glm::unpackHalf1x16(glm::packHalf1x16(static_cast<float>(v[axis])));
  return half;
}

// For each voxel corner around the joint, its position in a solve minus its position by blending of bone motions, mm.
struct SolvedCorners {
  double degrees = 0;
  bool is_baked = false;
  std::vector<glm::vec3> difference;  // one vector for each corner
};

// Fills in the baked angles, the lattice, and the shifts of its nodes, which are fitted to the solved corners.
void fit_lattice(const JointCorners& corners, const glm::ivec3& step, const std::vector<SolvedCorners>& solved,
                 BakedJoint& joint) {
  std::vector<const SolvedCorners*> baked;
  for (const SolvedCorners& each : solved)
    if (each.is_baked) baked.push_back(&each);
  std::vector<float> weight(corners.size());
  for (std::int64_t c = 0; c < corners.size(); ++c) weight[c] = corners.is_soft[c] ? 1 : kBoneCorner;
  const CornerFit fit(corners.corner, std::move(weight), step);
  std::vector<std::vector<glm::dvec3>> fitted(baked.size());
  parallel_for(std::ssize(baked), 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto a = begin; a < end; ++a) fitted[a] = fit.fit(baked[a]->difference);
  });
  joint.step = step;
  joint.first = fit.first();
  joint.size = fit.size();
  std::vector<std::size_t> kept;
  for (std::size_t n = 0; n < fit.nodes().size(); ++n) {
    const bool shifts =
        std::any_of(fitted.begin(), fitted.end(), [&](const auto& shift) { return glm::length(shift[n]) > kNothing; });
    if (!shifts) continue;
    kept.push_back(n);
    joint.nodes.push_back(fit.nodes()[n]);
  }
  for (std::size_t a = 0; a <= baked.size(); ++a) {
    const double before = a == 0 ? -INFINITY : baked[a - 1]->degrees,
                 here = a < baked.size() ? baked[a]->degrees : INFINITY;
    if (before < 0 && here > 0) {
      joint.degrees.push_back(0);
      joint.shifts.emplace_back();
    }
    if (a == baked.size()) break;
    joint.degrees.push_back(here);
    std::vector<glm::vec3>& shifts = joint.shifts.emplace_back();
    for (const std::size_t n : kept) shifts.push_back(in_half_precision(fitted[a][n]));
  }
}

double most_of(std::vector<double> distances, double share) {
  if (distances.empty()) return 0;
  const auto at = distances.begin() + static_cast<std::ptrdiff_t>(share * (std::ssize(distances) - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return *at;
}

// Returns the error of the baked joint at a solved angle.
//   difference  for each corner: its solved position minus its blended position, mm
BakeError error_at(const std::shared_ptr<const BakedJoint>& joint, double degrees, const JointCorners& corners,
                   const std::vector<glm::vec3>& difference, const TissueVoxels& tissue, const Grid& grid) {
  const BakedFlesh flesh(tissue, grid, {{.baked = joint, .degrees = degrees}});
  const glm::dmat3 to_world = world_from_voxel(grid).linear;
  std::vector<double> all, skin;
  for (std::int64_t c = 0; c < corners.size(); ++c) {
    if (!corners.is_soft[c]) continue;
    const glm::dvec3 shift = to_world * glm::dvec3(flesh.shift_at(glm::dvec3(corners.corner[c])));
    const double mm = glm::distance(shift, glm::dvec3(difference[c]));
    // Corners that neither the solve nor the baked joint shifts are no part of the joint: counting them would make the
    // error look smaller.
    if (mm < kNothing && glm::length(difference[c]) < kNothing) continue;
    all.push_back(mm);
    if (corners.is_skin[c]) skin.push_back(mm);
  }
  return {.degrees = degrees,
          .flesh_mm = most_of(all, 0.95),
          .skin_mm = most_of(skin, 0.95),
          .largest_mm = most_of(all, 1)};
}

// Solves the joint on both sides of rest, on each side up to the first angle that the solver does not reach.
std::vector<SolvedSide> solve_sides(const RigidTissue& tissue, int bone, const BakeSettings& settings, JointBake& bake,
                                    Progress& progress) {
  std::vector<SolvedSide> sides;
  for (const double end : {settings.low, settings.high})
    if (end != 0)
      sides.push_back(solve_side(tissue, bone, bake.joint.axis, angles_to(end, settings), settings, bake, progress));
  std::erase_if(sides, [](const SolvedSide& side) { return side.angles.empty(); });
  if (sides.empty())
    throw Error("no angle of the joint could be reached, so nothing is baked", bake.joint.bone,
                bake.warnings.empty() ? "choose another range" : bake.warnings.front());
  return sides;
}

// Returns for each solved angle, in ascending order, how far the solved voxel corners are from the blended ones.
std::vector<SolvedCorners> solved_corners(const RigidTissue& tissue, const std::vector<SolvedSide>& sides,
                                          const JointCorners& corners) {
  std::vector<SolvedCorners> solved;
  for (const SolvedSide& side : sides) {
    const CarriedCorners carried(corners, tissue.body.file.volume, tissue.bound.tissue, tissue.weights, side.moving,
                                 side.mesh, side.tet_mm);
    for (const SolvedAngle& angle : side.angles) {
      const std::vector<glm::dvec3> blended = blended_corners(corners, angle.motions),
                                    posed = carried.posed(angle.V, angle.motions);
      SolvedCorners& each = solved.emplace_back(SolvedCorners{angle.degrees, angle.is_baked, {}});
      each.difference.resize(corners.size());
      for (std::int64_t c = 0; c < corners.size(); ++c) each.difference[c] = posed[c] - blended[c];
    }
  }
  std::sort(solved.begin(), solved.end(), [](const auto& a, const auto& b) { return a.degrees < b.degrees; });
  return solved;
}

const char* word_of(FemQuality quality) {
  return quality == FemQuality::Draft ? "draft" : quality == FemQuality::Fine ? "fine" : "normal";
}

}  // namespace

JointBake bake_joint(const Body& body, const BoundBody& bound, int bone, const BakeSettings& settings,
                     Progress& progress) {
  check(body.rig, bone, settings);
  const LabelVolume& volume = body.file.volume;
  const LabelSets labels(body.tissues);
  JointBake bake;
  BakedJoint& joint = bake.joint;
  joint.bone = body.rig.bones[bone].name;
  joint.axis = flex_axis(body.rig, bone);
  joint.source = bake_source(volume, bound.tissue, labels.bone, body.rig, bound.weights);
  joint.glide = settings.glide;
  joint.quality = word_of(settings.quality);
  joint.contact = settings.contact;

  const RigidTissue tissue{
      body, bound, labels,
      with_rigid_bones(bound.weights, volume, bound.tissue, body.tissues, labels.bone, body.rig, progress)};
  const std::vector<SolvedSide> sides = solve_sides(tissue, bone, settings, bake, progress);
  std::vector<std::vector<RigidTransform>> ends;
  std::vector<const TissueMask*> meshed;
  double tet_mm = INFINITY;
  for (const SolvedSide& side : sides) {
    ends.push_back(side.angles.back().motions);
    meshed.push_back(&side.moving.meshed);
    tet_mm = std::min(tet_mm, side.tet_mm);
  }
  progress.update("bake", 0);
  const JointCorners corners =
      joint_corners(volume, bound.tissue, tissue.weights, labels.bone, labels.skin, ends, meshed);
  const std::vector<SolvedCorners> solved = solved_corners(tissue, sides, corners);
  fit_lattice(corners, step_for(tet_mm, volume.grid), solved, joint);
  progress.update("bake", 0.8);
  const auto shared = std::make_shared<const BakedJoint>(joint);
  for (const SolvedCorners& each : solved)
    (each.is_baked ? joint.at_baked : joint.between)
        .push_back(error_at(shared, each.degrees, corners, each.difference, bound.tissue, volume.grid));
  progress.update("bake", 1);
  return bake;
}

}  // namespace limber
