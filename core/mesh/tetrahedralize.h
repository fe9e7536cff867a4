// SPDX-License-Identifier: AGPL-3.0-or-later
// Fills a surface with tetrahedra by TetGen [Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, ACM TOMS
// 2015]. No other file calls TetGen.
//
// On surfaces that TetGen cannot handle, it ends the process, crashes or never returns. It therefore runs in a child
// process with limits, and any failure there is returned as a message. TetGen's mesh is used only after a check: the
// surface's nodes and triangles are all present, unmoved and uncut, and every tet is in one region.
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

// The triangles between regions. Each region is closed: it can be left only through a triangle, which leads from the
// region on one of its sides to the region on the other. Triangles meet only at edges and corners that they share.
struct RegionSurface {
  static constexpr std::uint16_t kAir = 0xffff;

  Eigen::MatrixX3d V;  // #V positions, world, mm
  Eigen::MatrixX3i F;  // #F triangles
  // #F by 2 regions (as in TetMesh, or kAir): the region in front of each triangle (from where its corners are
  // counter-clockwise), and the region behind it.
  std::vector<std::array<std::uint16_t, 2>> sides;
};

struct TetrahedralizeLimits {
  double seconds = 30;                   // limit on CPU time; the limit on elapsed time is four times as long
  double seconds_per_triangle = 0.0005;  // added to `seconds` for each triangle; TetGen needs about a tenth of this
  std::size_t memory_bytes = std::size_t{4} << 30;
  std::function<void()> at_start = {};  // called in the child before TetGen; lets tests crash and hang the child
};

struct Tetrahedralized {
  std::optional<TetMesh> mesh;
  std::string failure;  // message for the user: why there is no mesh; empty if there is one
};

// Fills the regions inside the surface with tets. Adds nodes so that, as far as the surface allows, the radius of each
// tet's circumsphere is at most twice the tet's shortest edge. The first #V nodes are the surface's.
//   throws Cancelled
Tetrahedralized tetrahedralize_inside(const RegionSurface& surface, const TetrahedralizeLimits& limits = {},
                                      const Progress& progress = no_progress());

}  // namespace limber
