// SPDX-License-Identifier: AGPL-3.0-or-later
// Posing by finite elements: the tissue that the pose bends is meshed (core/mesh), the bones are led to the pose in
// steps and the flesh follows at least energy (core/fem); what does not bend goes rigidly with its bones. The mesh then
// carries its voxels (deform/posed_tets.h).
//
// A pose may be out of reach: bone against bone, or flesh that would have to be pressed to nothing. Then the result is
// the last place of the way from rest that was reached, and says so.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/fem/stretch.h"
#include "core/mesh/mesh_tissue.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SolveStep;
struct FemShape;
struct TissueModel;

enum class FemQuality { Draft, Normal, Fine };

struct Fem {
  bool contact = false;                     // skin touches skin instead of passing through
  FemQuality quality = FemQuality::Normal;  // tets of 12 mm, 8 mm, or 8 mm and 4 mm around joints that bend
  std::optional<double> spacing_mm;         // another size of tets everywhere
  Mesher mesher = Mesher::lattice;
  std::function<void(const TissueModel&)> on_mesh;  // before the first iteration
  std::function<void(const SolveStep&)> on_step;    // after every iteration
};

// What the mesh is, at rest and posed.
struct MeshReport {
  std::int64_t tets = 0, nodes = 0;
  std::int64_t inverted = 0;                       // tets with det F <= 0 at the end of any step
  double min_det_f = 1;                            // of soft tets, at the end
  std::int64_t joint_tets = 0;                     // between two bones: soft, not counted in min_det_f
  double share_below_fifth = 0;                    // of soft tets, those with det F below 0.2
  std::optional<std::int64_t> self_intersections;  // pairs of triangles of the posed border
  std::int64_t contact_nodes =
      0;  // of the border: nearer to another part of it than 1.5 times what contact pushes from, without contact too
  std::optional<double> min_gap_mm, median_gap_mm;  // of the air at those nodes
  std::map<Label, double> volume_change_percent;    // of the tets that hold the label's voxels
  std::map<Label, Stretch> stretch;                 // of soft tissue that bends
  std::string fallback;  // what the mesher had to do instead of its best, empty where nothing
};

struct SolveReport {
  bool converged = false;
  double reached = 0;      // of the way from rest to the pose, [0, 1]
  std::string blocked_by;  // where it did not converge
  int steps = 0, iterations = 0, factorizations = 0;
  int analyses = 0;        // of the matrix's pattern, which contact changes
  double residual_mm = 0;  // furthest that a node wanted to move in the last iteration
  double bone_drift_mm =
      0;  // furthest that a node of the mesh is from where its bone is; voxels of bone are where it is
};

}  // namespace limber
