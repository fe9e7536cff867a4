// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigid objects that press on a body, for example a seat, a phone at the cheek, or a cuff. An object is a surface of
// triangles. It starts away from the body and moves to its target position, pushing the skin in front of it. The nodes
// of its surface take part in contact (contact_form.h), but they are not unknowns of the solve.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/fem/node_positions.h"

namespace limber {

// The rigid objects that press on the body in a solve.
struct RigidObjects {
  NodePositions rest;             // #N: positions at rest, mm; so far away that no object touches the body
  Eigen::MatrixX3i F;             // triangles, as rows of indices into `rest`; counter-clockwise seen from outside
  std::vector<int> object;        // #N: the index of the object to which each node belongs
  std::vector<std::string> name;  // names by object, for messages
  // Returns the positions of all nodes at the position t on the solve's path, [0, 1].
  std::function<NodePositions(double t)> at;

  bool empty() const { return F.rows() == 0; }
};

}  // namespace limber
