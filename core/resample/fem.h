// SPDX-License-Identifier: AGPL-3.0-or-later
// Settings and reports of posing by finite elements. The tissue that the pose bends is meshed (core/mesh), the bones
// are moved to the pose in steps, and the flesh takes the shape of least energy (core/fem). Tissue that does not bend
// moves rigidly with its bones. At the end, the voxels inside each tet move with the tet (deform/posed_tets.h).
//
// A pose may be out of reach, because bone meets bone or flesh would have to be pressed to nothing. Then the result is
// the last pose that was reached on the way from rest, and SolveReport says so.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/fem/stretch.h"
#include "core/mesh/mesh_tissue.h"
#include "core/resample/fem_error.h"
#include "core/resample/fem_objects.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SolveStep;
struct FemShape;
struct TissueModel;

enum class FemQuality { Draft, Normal, Fine };

struct Fem {
  bool contact = false;                     // true: contact stops skin from passing through skin
  FemQuality quality = FemQuality::Normal;  // tets across the thinnest bent limb: draft 8, normal 12, fine 24 at joints
  std::optional<double> spacing_mm;         // edge length of the tets; none: the quality decides
  // Length in mm that scales how far around a bent joint tissue is meshed, and how far from other bones a bone belongs
  // to a joint. None: the edge length of the tets, but at least that of normal quality.
  std::optional<double> reach_mm;
  // True: the shape depends on the pose alone and changes smoothly with it. Tissue that otherwise moves rigidly until
  // contact may reach it is then free from the start, and each solve ends only when Newton moves no node by more than a
  // tenth of the usual length.
  bool is_exact = false;
  Mesher mesher = Mesher::lattice;
  bool slides = false;  // true: loose tissue slides over bone near bent joints (sliding_nodes.h); false: it sticks
  bool estimates_error = false;    // true: a second solve with larger tets tells how large the error is (fem_error.h)
  std::vector<FemObject> objects;  // rigid objects that press on the posed body; `contact` must be true
  glm::dvec3 gravity{0};           // acceleration of gravity, m/s2, in the world
  std::function<void(const TissueModel&)> on_mesh;  // is called with the mesh before the first iteration
  std::function<void(const SolveStep&)> on_step;    // is called with the present state after every iteration
};

// Size and quality of the tet mesh, at rest and posed.
struct MeshReport {
  std::int64_t tets = 0, nodes = 0;
  // Number of inverted tets (det F <= 0), summed over the ends of all steps.
  std::int64_t inverted = 0;
  double min_det_f = 1;                            // smallest det F (volume ratio posed / rest) of all soft tets
  std::int64_t joint_tets = 0;                     // number of soft tets between two bones; min_det_f leaves them out
  double share_below_fifth = 0;                    // share of the soft tets with det F below 0.2, [0, 1]
  std::optional<std::int64_t> self_intersections;  // number of pairs of crossing triangles of the posed surface
  // Number of surface nodes that are nearer to another part of the posed surface than 1.5 times the contact distance.
  // They are counted even if contact is off.
  std::int64_t contact_nodes = 0;
  std::optional<double> min_gap_mm, median_gap_mm;  // smallest and median air gap in front of the contact nodes
  std::map<Label, double> volume_change_percent;    // volume change of each label, from the tets that hold its voxels
  std::map<Label, Stretch> stretch;                 // stretch of each soft tissue that bends, by label
  std::string fallback;  // message for the user: larger tets or another mesher were used; empty: as requested
};

// The parameters that a solve used. Limits that depend on the size of the body and of its voxels are applied.
struct SolveParameters {
  double tet_mm = 0, finest_tet_mm = 0;            // edge length of the tets, and of the smallest tets around joints
  double step_degrees = 0;                         // largest rotation of any joint in one step
  double step_tolerance_mm = 0, tolerance_mm = 0;  // tolerances of the steps and of the final pose (fem/solve_pose.h)
  double joint_mm = 0;               // ends of bones that are this near to another bone are part of a joint, mm
  std::optional<double> contact_mm;  // distance below which skin is pushed apart; none: no contact
};

struct SolveReport {
  bool converged = false;
  double reached = 0;      // share of the way from rest to the pose that was reached, [0, 1]
  std::string blocked_by;  // message for the user: what blocks the pose; empty if the solve converged
  int steps = 0, iterations = 0, factorizations = 0;
  int repeated_in_double = 0;  // number of factorizations repeated because single precision was too inexact
  int analyses = 0;            // number of analyses of the matrix's sparsity pattern; contact changes the pattern
  double residual_mm = 0;      // longest motion of a node in the last Newton step, mm
  // Largest distance of a bone's mesh node from its exact rigid position. Bone voxels have no such error, since they
  // are written at their exact positions.
  double bone_drift_mm = 0;
  // Flesh that slides along bone: the number of its nodes, the largest slide of a node, and the largest change of a
  // node's distance from its bone, mm.
  std::int64_t sliding_nodes = 0;
  double largest_slide_mm = 0, largest_slide_gap_mm = 0;
  SolveParameters parameters;
  std::optional<FemError> error;  // estimated error of the shape; none: not estimated
};

}  // namespace limber
