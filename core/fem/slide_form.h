// SPDX-License-Identifier: AGPL-3.0-or-later
// The energy of flesh that slides along rigid bones, per node of flesh at a bone:
//    N/2 (d(y) - d0)^2 + t/2 |y - y0|^2
// y is the node's position in the bone's frame: its posed position, moved back by the bone's motion; y0 is its place at
// rest, d the signed distance from the bone's surface (distance_field.h) and d0 the distance at rest. The first term is
// a stiff spring along the surface's normal in both directions: the node neither enters the bone nor leaves it. The
// second is the thin layer of loose tissue (fascia) between flesh and bone: a weak spring to the place at rest. This is
// contact in both directions with a rigid distance field, without a search for pairs.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/base/cholesky.h"
#include "core/base/rigid_transform.h"
#include "core/fem/distance_field.h"
#include "core/fem/elastic_form.h"
#include "core/fem/node_positions.h"

namespace limber {

struct SlideForm {
  struct Node {
    int node, bone;
    double normal, fascia;  // stiffness across and along the surface, kPa mm
    Eigen::RowVector3d rest;
    double rest_mm;  // distance of the node from the surface at rest, mm
  };
  std::vector<Node> nodes;
  std::vector<std::shared_ptr<const DistanceField>> surface;  // by bone, at rest; null: nothing slides on it
  std::vector<RigidTransform> posed_from_rest;                // motion of each rig bone from rest to the pose
  NodePositions moved;  // #nodes: motion that is subtracted from each node's position before all else; empty: none

  double value(const NodePositions& x) const;
  void add_gradient(const NodePositions& x, NodePositions& gradient) const;
  // Adds the Hessian. The projected Hessian leaves out the negative eigenvalues that come from the surface's curvature.
  void add_curvature(const NodePositions& x, HessianKind curvature, const Cholesky& matrix,
                     std::span<const int> unknown, std::span<double> values) const;
  // Returns the Hessian of one entry of `nodes`, in the world's axes.
  Eigen::Matrix3d curvature_of(const Node& node, const NodePositions& x, HessianKind curvature) const;

  // A node's distance from its rest position along the bone's surface, and the change of its distance from the surface;
  // mm.
  struct Slide {
    double along = 0, off = 0;
  };
  Slide slide_of(const Node& node, const NodePositions& x) const;
  // Returns the largest `along` and the largest `off` of all nodes; 0 without nodes.
  Slide largest(const NodePositions& x) const;

 private:
  // Returns the node's position in the bone's frame.
  Eigen::RowVector3d in_bone(const Node& node, const NodePositions& x) const;
};

}  // namespace limber
