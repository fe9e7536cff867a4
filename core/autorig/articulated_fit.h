// SPDX-License-Identifier: AGPL-3.0-or-later
// A jointed body drawn onto surfaces: the points of an atlas are carried rigidly by its bones, whose turns and two
// stretches (along and across) are found by Gauss-Newton on pairs of nearest points, both from the atlas to the volume
// and back, with the distance across the surface as residual and a robust weight that narrows from coarse to fine
// [articulated iterative closest points: Besl & McKay 1992, Chen & Medioni 1991, Geman & McClure 1987]. Left and right
// share their stretches, and neighbours along a limb want the same ones; turns are drawn weakly towards the atlas's own
// pose.
#pragma once

#include <vector>

#include "core/autorig/body_atlas.h"
#include "core/autorig/cut_planes.h"
#include "core/base/progress.h"
#include "core/mesh/surface_points.h"

namespace limber {

// The atlas in some pose and proportion.
class Mannequin {
 public:
  explicit Mannequin(const BodyAtlas& atlas);  // which must outlive it

  const BodyAtlas& atlas() const { return *atlas_; }
  int bone_count() const { return static_cast<int>(turn.size()); }
  int group_of(int bone) const { return group_[bone]; }
  int group_count() const { return static_cast<int>(along.size()); }

  // The free numbers; call settle() after changing them.
  glm::dvec3 root{0};
  std::vector<glm::dmat3> turn;       // per bone, world from the atlas at rest
  std::vector<double> along, across;  // per group of bones: logarithm of the stretch
  double alike = 1;                   // how many times more than usual neighbours along a limb want the same stretch

  void settle();
  const glm::dvec3& joint(int bone) const { return joint_[bone]; }
  // Where a point goes. A forearm is wrung: each of its points takes part in the hand's twist by how far down it lies.
  glm::dvec3 carried(int bone, const glm::dvec3& place) const;
  glm::dmat3 turn_at(int bone, const glm::dvec3& place) const;
  // The bone whose twist wrings this one, -1 for none, and the share of it that a point at rest takes.
  int wrung_by(int bone) const { return wrung_by_[bone]; }
  double wrung_share(int bone, const glm::dvec3& place) const;
  // Turned and stretched, for something that lies along the bone or across it.
  glm::dvec3 direction(int bone, const glm::dvec3& v) const { return moved_[bone] * v; }
  glm::dvec3 rest_axis(int bone) const { return axis_[bone]; }

  // Turns a bone and all that hangs from it.
  void turn_branch(int bone, const glm::dmat3& by);

 private:
  const BodyAtlas* atlas_;
  std::vector<int> group_, wrung_by_;
  std::vector<double> wrung_;  // radians at the far end
  std::vector<glm::dvec3> axis_, joint_;
  std::vector<glm::dmat3> moved_;
};

// A surface to fit to. Beyond its cuts nothing is known: what the atlas has there is not asked for.
struct FitSurface {
  explicit FitSurface(std::vector<SurfacePoint> all, double step, std::vector<TissueCut> where = {})
      : cuts(std::move(where)),
        points(std::move(all)),
        sparse(thinned(points, step)),
        tree(points) {}
  std::vector<TissueCut> cuts;
  std::vector<SurfacePoint> points, sparse;  // all, and some to ask from
  PointTree tree;
};

struct FitStage {
  int iterations = 10;
  double wide = 60, narrow = 10;    // mm: the distance at which a pair counts for a quarter, first and last
  std::vector<std::uint8_t> turns;  // per bone: free to turn; empty: all
  bool stretches = true;
  double bone_share = 0.5;  // of the weight, where there are bones
  int stride = 1;           // every how many points are used
  // Only these bones' points, and of the surface only what lies within `reach` mm of `around`; empty and 0: all.
  std::vector<std::uint8_t> points;
  glm::dvec3 around{0};
  double reach = 0;
};

// skin or bone may be null.
void fit(Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, const FitStage& stage);

// The same onto the axes of bones that are drawn as rods: every bone cell draws the nearest point of the rig's own
// segments towards itself, so that a segment comes to run through the middle of its rod and joints lie where rods bend.
//   cells  centres of bone cells, mm
// The skin keeps what has no rod in place.
void fit_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const FitSurface& skin,
              const FitStage& stage);

// Elbows and knees of such a body, put where a limb's rod bends or changes its thickness: there two straight lines, one
// to a side, explain the cells along the limb best.
void split_rods(Mannequin& mannequin, const std::vector<glm::dvec3>& cells);

struct RodShare {
  double near = 0;    // of the bone cells within `reach` mm of a segment
  double inside = 0;  // of the limbs' long segments: in bone
};
RodShare rod_share(const Mannequin& mannequin, const std::vector<glm::dvec3>& cells, const Occupancy& bone,
                   double reach);

// Mean squared distance in mm2 between the atlas and the surface, both ways, none counted above `cap` mm.
//   within  its stride, points, around and reach are used
double residual(const Mannequin& mannequin, const FitSurface* skin, const FitSurface* bone, double cap,
                const FitStage& within);

// Per bone of the atlas: share of its points, 0 .. 1, that lie within `near` mm of the surface; -1 where it has none to
// ask for.
std::vector<double> share_near(const Mannequin& mannequin, const FitSurface& surface, bool bones, double near);

}  // namespace limber
