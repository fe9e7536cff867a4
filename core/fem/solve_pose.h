// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the shape that tissue takes when its bones move, by nonlinear finite elements on a tet mesh, in steps from
// rest to the pose. Stiff springs hold bones where their rig bones are; everything else finds the shape of least
// energy. Flesh keeps its volume (nearly incompressible, without the locking of plain tets, patch_form.h) and is not
// inverted at any iterate. With contact no part of the skin passes through another at any iterate (contact_form.h) [Li
// et al. 2020]. Every step begins with one iteration along the tangent of the path, which takes the tissue's Hessian
// into account, and is then solved by projected Newton (newton.h). Lengths are in mm, stiffness in kPa. The result does
// not depend on the number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/deform/skinning.h"
#include "core/fem/fem_energy.h"
#include "core/fem/material.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct FemModel {
  TetMesh mesh;                       // the tets at rest
  std::vector<TetMaterial> material;  // #T
  std::vector<int> held_by;           // #V: the rig bone that holds the node, -1: free
  struct Waiting {
    int node, bone;
    double until;  // position on the path, [0, 1]
  };
  // The free nodes that a bone holds until a position on the path, since nothing can press on them before.
  std::vector<Waiting> waiting;
  // #V lists of weights that sum to 1. They give the first guess of a step; the result does not depend on them.
  std::vector<std::vector<BoneWeight>> influences;
  std::vector<std::string> bone_names;  // for messages; a bone without a name is "bone 3"
};

// Returns posed_from_rest of every rig bone at t, from 0 (where the solve starts) to 1 (the pose).
using BonePath = std::function<std::vector<RigidTransform>(double t)>;

struct SolveSettings {
  bool contact = false;
  double step_degrees = 22.5;          // largest turn of any joint in one step
  double contact_mm = 1.4;             // skin nearer than this is pushed apart, if it was further apart at rest
  double step_tolerance_mm = 4;        // a step ends when no node would move further than this (half a tet)
  double tolerance_mm = 0.3;           // the same tolerance at the pose
  int step_iterations = 40;            // a step that needs more iterations is done in parts: half of it, a quarter, ...
  double shortest_step_degrees = 0.9;  // if even a part this short fails, the pose is out of reach
  double bone_drift_mm = 2;            // a step fails if it moves a bone's nodes further than this from the bone
};

// The state of a solve after an iteration. V is valid only during the call.
struct SolveStep {
  double reached;   // position on the path that this iteration works at, [0, 1]
  int iteration;    // number of iterations so far, over all steps
  double residual;  // longest move of a node in the iteration's full step, mm
  const Eigen::MatrixX3d& V;
};

struct SolvedPose {
  Eigen::MatrixX3d V;      // #V posed nodes
  bool converged = false;  // false: V is the last good step (at `reached`), or a shape at the pose that has not settled
  double reached = 0;      // position on the path, [0, 1]
  std::string blocked_by;  // tells the user what stopped the solve; empty if it converged
  int steps = 0, iterations = 0, factorizations = 0, analyses = 0;
  double residual = 0;           // longest move of a node in the last iteration's full step, mm
  double min_det_f = 1;          // smallest det F of tets with flesh, at the end
  double min_det_f_of_path = 1;  // the smallest at the end of any step
  double bone_drift_mm = 0;      // largest distance of a bone's node from where its bone would put it, at the end
  std::int64_t inverted = 0;     // number of tets with det F <= 0 at the ends of all steps, flesh and bone
  FemSeconds seconds;
};

// Solves for the pose at the end of the path.
//   start  #V positions at the start of the path (such as the result of a neighbouring frame), null: rest
//   throws Error if the model's lists disagree in length, a tet is inverted at the start, or memory does not suffice
SolvedPose solve_pose(const FemModel& model, const BonePath& path, double largest_angle_degrees,
                      const SolveSettings& settings = {}, Progress& progress = no_progress(),
                      const std::function<void(const SolveStep&)>& on_step = {},
                      const Eigen::MatrixX3d* start = nullptr);

}  // namespace limber
