// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits a jointed body to surfaces. The bones of an atlas carry its points rigidly; the rotation and two stretches
// (along and across) of each bone are found by Gauss-Newton on pairs of nearest points, from the atlas to the volume
// and back. The residual is the distance at right angles to the surface, with a robust weight that narrows from coarse
// to fine [articulated iterative closest points: Besl & McKay 1992, Chen & Medioni 1991, Geman & McClure 1987]. Left
// and right share their stretches, neighbours along a limb prefer equal stretches, and rotations are pulled weakly
// towards the atlas's own pose.
#pragma once

#include <vector>

#include "core/autorig/body_atlas.h"
#include "core/autorig/cut_planes.h"
#include "core/base/progress.h"
#include "core/mesh/surface_points.h"

namespace limber {

// The body of an atlas in some pose and with some proportions.
class Mannequin {
 public:
  explicit Mannequin(const BodyAtlas& atlas);  // the atlas must outlive the mannequin

  const BodyAtlas& atlas() const { return *atlas_; }
  int bone_count() const { return static_cast<int>(turn.size()); }
  int group_of(int bone) const { return group_[bone]; }
  int group_count() const { return static_cast<int>(along.size()); }

  // The free variables of the fit. After changing them, call settle() to update the positions.
  glm::dvec3 root{0};
  std::vector<glm::dmat3> turn;       // per bone, rotation from the atlas at rest to the world
  std::vector<double> along, across;  // per group of bones, logarithms of the stretches
  double alike = 1;  // factor on the stiffness that keeps the stretches of neighbouring bones of a limb equal

  void settle();
  const glm::dvec3& joint(int bone) const { return joint_[bone]; }
  // Returns the present position of a bone's point that is given at rest. A forearm is wrung (twisted along its
  // length): each of its points takes a share of the hand's twist that grows from the elbow to the wrist.
  glm::dvec3 carried(int bone, const glm::dvec3& place) const;
  glm::dmat3 turn_at(int bone, const glm::dvec3& place) const;
  // Returns the bone whose twist wrings this one (the hand of a forearm), or -1. wrung_share() returns a rest point's
  // share of the twist, [0, 1].
  int wrung_by(int bone) const { return wrung_by_[bone]; }
  double wrung_share(int bone, const glm::dvec3& place) const;
  // Returns a vector of the rest pose, rotated and stretched with the bone.
  glm::dvec3 direction(int bone, const glm::dvec3& v) const { return moved_[bone] * v; }
  glm::dvec3 rest_axis(int bone) const { return axis_[bone]; }

  // Rotates a bone and all its descendants.
  void turn_branch(int bone, const glm::dmat3& by);

 private:
  const BodyAtlas* atlas_;
  std::vector<int> group_, wrung_by_;
  std::vector<double> wrung_;  // twist at the far end of each bone, radians
  std::vector<glm::dvec3> axis_, joint_;
  std::vector<glm::dmat3> moved_;
};

// A surface that the atlas is fitted to. Beyond the planes at which the volume is cut off nothing is known, so atlas
// points that lie there are ignored.
struct FitSurface {
  explicit FitSurface(std::vector<SurfacePoint> all, double step, std::vector<TissueCut> where = {})
      : cuts(std::move(where)),
        points(std::move(all)),
        sparse(thinned(points, step)),
        tree(points) {}
  std::vector<TissueCut> cuts;
  // All points, and the thinned points for which the nearest atlas points are searched.
  std::vector<SurfacePoint> points, sparse;
  PointTree tree;
};

struct FitStage {
  int iterations = 10;
  double wide = 60, narrow = 10;  // distance at which a pair's weight is a quarter, in the first and last iteration, mm
  std::vector<std::uint8_t> turns;  // per bone, 1: free to rotate; empty: all are
  bool stretches = true;            // true: the bones' stretches are fitted too
  double bone_share = 0.5;          // weight of the bone surface, where there is one, [0, 1]; the skin gets the rest
  int stride = 1;                   // n: only every n-th point is used
  // Limits the fit to the atlas points of bones with a 1 in `points` (empty: all bones), and to surface points within
  // `reach` mm of `around` (0: all points).
  std::vector<std::uint8_t> points;
  glm::dvec3 around{0};
  double reach = 0;
};

// Fits the mannequin to the surfaces; skin or bone may be null.
void fit(Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, const FitStage& stage);

// Fits the mannequin to bones that a volume draws as rods (round bars along a rig). Every bone cell pulls the nearest
// point of the rig's segments towards itself, so that each segment runs through the middle of its rod and joints lie
// where rods bend. The skin keeps the other bones in place.
//   cells  centres of bone cells, mm
void fit_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const FitSurface& skin,
              const FitStage& stage);

// Moves the elbows and knees of a body whose bones are drawn as rods to where a limb's rod bends or changes its
// thickness: there two straight lines, one on each side, fit the cells along the limb best.
void split_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells);

struct RodShare {
  double near = 0;    // share of the bone cells within `reach` mm of a segment
  double inside = 0;  // share of the limbs' long segments that lies in bone
};
RodShare rod_share(const Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const Occupancy& bone,
                   double reach);

// Returns the mean squared distance between atlas and surface in both directions, mm^2. Distances are limited to `cap`
// mm.
//   within  selects the points by its stride, points, around and reach
double residual(const Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, double cap,
                const FitStage& within);

// Returns for each bone of the atlas the share of its points, [0, 1], that lie within `near` mm of the surface; -1 for
// a bone without points.
std::vector<double> share_near(const Mannequin& mannequin, const FitSurface& surface, bool bones, double near);

}  // namespace limber
