// SPDX-License-Identifier: AGPL-3.0-or-later
// The shape that tissue takes when its bones move: nonlinear finite elements on a tet mesh, from rest to the pose in
// steps. Bones are held by stiff springs to where their rig bones are; everything else finds the shape of least energy.
// Flesh keeps its volume (nearly incompressible, without the locking of plain tets, patch_form.h) and is never turned
// inside out at any iterate. With contact no part of the skin passes through another, at any iterate (contact_form.h)
// [Li et al. 2020]. Every step begins along the tangent of the path, which is one iteration, and is solved by projected
// Newton (newton.h): the first guess knows by the tissue's curvature what presses where. Lengths in mm, stiffness in
// kPa. The same for any number of threads.
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
  TetMesh mesh;                       // at rest
  std::vector<TetMaterial> material;  // #T
  std::vector<int> held_by;           // #V: the rig bone that holds the node, -1 free
  struct Waiting {
    int node, bone;
    double until;  // place on the path
  };
  std::vector<Waiting> waiting;  // of the free nodes, those that a bone holds until then: nothing can press them before
  std::vector<std::vector<BoneWeight>>
      influences;                       // #V, sums of 1: what turns far from its bone; the result does not hang on them
  std::vector<std::string> bone_names;  // for messages; "bone 3" where there is none
};

// posed_from_rest of every rig bone at t, from 0 (where the solve starts) to 1 (the pose).
using BonePath = std::function<std::vector<RigidTransform>(double t)>;

struct SolveSettings {
  bool contact = false;
  double step_degrees = 22.5;          // at most, of the joint that turns furthest
  double contact_mm = 1.4;             // from this distance on skin is pushed apart, where it was further apart at rest
  double step_tolerance_mm = 4;        // a step ends when no node would move further than this: half a tet
  double tolerance_mm = 0.3;           // at the pose
  int step_iterations = 40;            // a step that needs more is done in parts: half of it, a quarter, ...
  double shortest_step_degrees = 0.9;  // much shorter parts are not tried: the pose is out of reach
  double bone_drift_mm = 2;  // a step that bends a bone's nodes further than this from the bone is out of reach too
};

// What is known while solving, after every iteration. V lives only during the call.
struct SolveStep {
  double reached;   // of the path, [0, 1]: that this iteration works at
  int iteration;    // so far, over all steps
  double residual;  // furthest that a node wanted to move in it, mm
  const Eigen::MatrixX3d& V;
};

struct SolvedPose {
  Eigen::MatrixX3d V;      // #V posed nodes
  bool converged = false;  // false: V is the last good step, `reached` of the path, or what has not settled at its end
  double reached = 0;      // [0, 1]
  std::string blocked_by;  // what stands in the way, where it did not converge; else empty
  int steps = 0, iterations = 0, factorizations = 0, analyses = 0;
  double residual = 0;           // furthest that a node wanted to move in the last iteration, mm
  double min_det_f = 1;          // of tets with flesh, at the end
  double min_det_f_of_path = 1;  // at the end of any step
  double bone_drift_mm = 0;      // furthest that a bone's node is from where its bone is, at the end
  std::int64_t inverted = 0;     // tets with det F <= 0 at the end of any step, flesh and bone
  FemSeconds seconds;
};

// start  #V nodes that the path begins at (a neighbouring frame's result), none: rest
// throws Error when the model's lists disagree in length, a tet is inverted at the start, or memory does not suffice
SolvedPose solve_pose(const FemModel& model, const BonePath& path, double largest_angle_degrees,
                      const SolveSettings& settings = {}, Progress& progress = no_progress(),
                      const std::function<void(const SolveStep&)>& on_step = {},
                      const Eigen::MatrixX3d* start = nullptr);

}  // namespace limber
