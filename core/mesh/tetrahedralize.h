// SPDX-License-Identifier: AGPL-3.0-or-later
// Tetrahedra inside a surface: the door of TetGen [Si, TetGen, a Delaunay-based quality
// tetrahedral mesh generator, ACM TOMS 2015].
//
// TetGen ends the process, crashes or never comes back on surfaces that it does not like. It therefore runs in a child
// process with limits; whatever happens there is an answer with a reason, never more. Its answer is believed only after
// a check: the surface's nodes and triangles are all there, unmoved and uncut, and every tet lies on one side of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

// Triangles between regions. Each region is closed: whichever way one walks, crossing a triangle changes the region
// from one of its sides to the other. Triangles meet only in common edges and corners.
struct RegionSurface {
  static constexpr std::uint16_t kAir = 0xffff;

  Eigen::MatrixX3d V;                               // #V places, world, mm
  Eigen::MatrixX3i F;                               // #F corners
  std::vector<std::array<std::uint16_t, 2>> sides;  // #F regions (of TetMesh, or kAir): in front, where the normal of
                                                    // counter-clockwise corners points, and behind
};

struct TetrahedralizeLimits {
  double seconds = 30;                   // of processor time, and by the clock four times as much
  double seconds_per_triangle = 0.0005;  // added to them; what it takes is a tenth of this
  std::size_t memory_bytes = std::size_t{4} << 30;
  std::function<void()> at_start = {};  // called in the child before TetGen: where tests crash and hang it
};

struct Tetrahedralized {
  std::optional<TetMesh> mesh;
  std::string failure;  // why there is none, for a user to read; empty when there is one
};

// The regions inside the surface, with nodes of their own so that no tet's circumsphere is larger than twice its
// shortest edge (as far as the surface allows). The first #V nodes are the surface's.
//   throws Cancelled
Tetrahedralized tetrahedralize_inside(const RegionSurface& surface, const TetrahedralizeLimits& limits = {},
                                      const Progress& progress = no_progress());

}  // namespace limber
