// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits a jointed body of known shape (an atlas) to the surfaces of a volume. The atlas's points move with its bones;
// the rotation and two stretches (along and across) of each bone are found by Gauss-Newton on pairs of nearest points,
// from the atlas to the volume and back. The residual is the distance perpendicular to the surface, with a robust
// weight whose width decreases from coarse to fine [articulated iterative closest points: Besl & McKay 1992, Chen &
// Medioni 1991, Geman & McClure 1987]. Left and right bones have common stretches, a prior prefers equal stretches of
// neighbouring bones of a limb, and a weak prior pulls rotations towards the atlas's own pose.
#pragma once

#include <vector>

#include "core/autorig/body_atlas.h"
#include "core/autorig/cut_planes.h"
#include "core/base/progress.h"
#include "core/mesh/surface_points.h"

namespace limber {

// A body that can be posed and stretched: an atlas (body of known shape) in a pose and with changed proportions.
class Mannequin {
 public:
  explicit Mannequin(const BodyAtlas& atlas);  // the atlas must outlive the mannequin

  const BodyAtlas& atlas() const { return *atlas_; }
  int bone_count() const { return static_cast<int>(turn.size()); }
  int group_of(int bone) const { return group_[bone]; }
  int group_count() const { return static_cast<int>(along.size()); }

  // The variables that the fit changes. After a change, call settle() to update the positions of joints.
  glm::dvec3 root{0};
  std::vector<glm::dmat3> turn;  // rotation of each bone from the atlas's rest pose to world axes
  // Logarithms of the stretches along and across a bone, for each group (left and right pair).
  std::vector<double> along, across;
  double alike = 1;  // factor on the prior that keeps the lengthwise stretches of neighbouring bones equal

  void settle();
  const glm::dvec3& joint(int bone) const { return joint_[bone]; }
  // Returns the present position of a point that moves with a bone; `place` is the point's position at rest. A forearm
  // is twisted along its length: each of its points takes a share of the hand's twist, which grows from the elbow to
  // the wrist.
  glm::dvec3 carried(int bone, const glm::dvec3& place) const;
  glm::dmat3 turn_at(int bone, const glm::dvec3& place) const;
  // wrung_by() returns the hand whose twist also twists the forearm `bone`; -1 for other bones. wrung_share() returns
  // the share of the twist that a rest point of the forearm takes, [0, 1].
  int wrung_by(int bone) const { return wrung_by_[bone]; }
  double wrung_share(int bone, const glm::dvec3& place) const;
  // Returns a vector of the rest pose after the rotation and stretch of a bone.
  glm::dvec3 direction(int bone, const glm::dvec3& v) const { return moved_[bone] * v; }
  glm::dvec3 rest_axis(int bone) const { return axis_[bone]; }

  // Rotates a bone and all its descendants.
  void turn_branch(int bone, const glm::dmat3& by);

 private:
  const BodyAtlas* atlas_;
  std::vector<int> group_, wrung_by_;
  std::vector<double> wrung_;  // twist of the hand at the end of each forearm, radians; 0 for other bones
  std::vector<glm::dvec3> axis_, joint_;
  std::vector<glm::dmat3> moved_;
};

// A surface of the volume to which the atlas is fitted. Atlas points beyond the planes at which the volume cuts the
// body off are ignored, because the surface there is unknown.
struct FitSurface {
  explicit FitSurface(std::vector<SurfacePoint> all, double step, std::vector<TissueCut> where = {})
      : cuts(std::move(where)),
        points(std::move(all)),
        sparse(thinned(points, step)),
        tree(points) {}
  std::vector<TissueCut> cuts;
  // All points of the surface, and the subset of points that are matched with their nearest atlas points.
  std::vector<SurfacePoint> points, sparse;
  PointTree tree;
};

struct FitStage {
  int iterations = 10;
  // Distance at which the weight of a point pair has dropped to a quarter, in the first and in the last iteration, mm.
  double wide = 60, narrow = 10;
  std::vector<std::uint8_t> turns;  // a byte per bone, 1: the bone is free to rotate; empty: all bones are free
  bool stretches = true;            // true: the fit may also stretch bones
  // Weight of the bone surface; the skin has the rest, [0, 1]. Without a bone surface the skin has all weight.
  double bone_share = 0.5;
  int stride = 1;  // only every stride-th point of a surface is used
  // Selects the points to fit: atlas points of the bones that have a 1 in `points` (empty: of all bones), and surface
  // points within `reach` mm of `around` (reach 0: all surface points).
  std::vector<std::uint8_t> points;
  glm::dvec3 around{0};
  double reach = 0;
};

// Fits the mannequin to the surfaces of a volume; skin or bone may be null.
void fit(Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, const FitStage& stage);

// Fits the mannequin to bones that are rods (round bars along a rig) in the volume. Every cell of bone tissue pulls the
// nearest point of the rig's segments towards itself, so that each segment runs through the middle of its rod and
// joints are where rods bend. The skin determines the remaining bones.
//   cells  centres of the cells of bone tissue, mm
void fit_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const FitSurface& skin,
              const FitStage& stage);

// Moves the elbows and knees of a body whose bones are rods in the volume. In each limb the joint is moved to the point
// where the rod bends or changes its thickness: two straight lines, one on each side of that point, fit the limb's bone
// cells best.
void split_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells);

struct RodShare {
  double near = 0;    // share of the bone cells that are within `reach` mm of a segment of the rig
  double inside = 0;  // share of the length of upper arms, forearms, thighs and shanks that is in bone tissue
};
RodShare rod_share(const Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const Occupancy& bone,
                   double reach);

// Returns the mean squared distance between atlas and surfaces, mm2: from atlas points to the surfaces and back. Each
// distance is capped at `cap` mm.
//   within  its stride, points, around and reach select the points that are compared
double residual(const Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, double cap,
                const FitStage& within);

// Returns for each bone of the atlas the share of its points that are within `near` mm of the surface, [0, 1]; -1 for a
// bone without points.
//   bones  true: the atlas's points on bones are compared; false: those on the skin
std::vector<double> share_near(const Mannequin& mannequin, const FitSurface& surface, bool bones, double near);

}  // namespace limber
