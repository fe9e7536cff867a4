// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the shape that tissue takes when its bones move, by nonlinear finite elements on a tet mesh, in steps from
// rest to the pose. Stiff springs hold the bones' nodes at the posed positions of the rig's bones; all other nodes move
// to the shape with the lowest energy. Flesh nearly keeps its volume, without locking (patch_form.h). At every iterate,
// no tet of flesh is inverted and, with contact, no part of the skin passes through another (contact_form.h) [Li et al.
// 2020]. Every step begins with one Newton step for the bones' velocities, along the tangent of their path, and is then
// solved by projected Newton (newton.h). Lengths are in mm, stiffness in kPa. The result does not depend on the number
// of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/deform/skinning.h"
#include "core/fem/fem_energy.h"
#include "core/fem/kept_volumes.h"
#include "core/fem/material.h"
#include "core/fem/rigid_object.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct FemModel {
  TetMesh mesh;                       // the tets at rest
  std::vector<TetMaterial> material;  // #T: material of each tet
  std::vector<int> held_by;           // #V: the rig bone that holds the node, -1: free
  struct Waiting {
    int node, bone;
    double until;  // path position, [0, 1], after which the node is free
  };
  // Nodes that move rigidly with a bone up to the path position `until`, because nothing can press on them before that
  // position. Beyond it they are free.
  std::vector<Waiting> waiting;
  // Nodes of soft tissue that slide along a bone (slide_form.h). No bone holds them (held_by is -1), and they are nodes
  // of no tet of bone (TetMesh::copy_of).
  struct Sliding {
    int node, bone;
    double mm2;  // area of the surface around the node
  };
  std::vector<Sliding> sliding;
  std::vector<std::shared_ptr<const DistanceField>> bone_surface;  // by rig bone, null if nothing slides on it
  // #V lists of bone weights that sum to 1. They give the initial guess of a step; the result does not depend on them.
  std::vector<std::vector<BoneWeight>> influences;
  std::vector<std::string> bone_names;  // names for messages; a bone without a name is called "bone 3"
  std::vector<double> mass;             // #V: mass of each node in kg, for gravity; empty: none
  std::vector<KeptVolume> kept;         // tissues whose volumes the final pose keeps
  RigidObjects objects;                 // rigid objects that press on the skin, if contact is on
};

// Returns the rigid transform posed_from_rest of every rig bone at t, from 0 (where the solve starts) to 1 (the pose).
using BonePath = std::function<std::vector<RigidTransform>(double t)>;

struct SolveSettings {
  bool contact = false;
  double step_degrees = 22.5;  // largest rotation of any joint in one step
  double contact_mm = 1.4;  // parts of the skin nearer than this are pushed apart, if they were further apart at rest
  double object_mm = 0.5;   // skin nearer than this to an object is pushed away
  Eigen::RowVector3d gravity = Eigen::RowVector3d::Zero();  // acceleration of gravity, m/s2
  bool has_weight_at_start = false;                         // false: gravity grows from zero along the path
  double step_tolerance_mm = 4;        // a step ends when Newton moves no node further than this (half a tet's edge)
  double tolerance_mm = 0.3;           // the last solve, at the final pose, ends when no node moves further than this
  int step_iterations = 40;            // a step that needs more iterations is split into shorter parts
  double shortest_step_degrees = 0.9;  // shortest part of a step; if it fails, the solve stops short of the pose
  double bone_drift_mm = 2;            // if a bone's node is further than this from its rigid position, the step fails
  double size = 1;  // size of the body relative to an adult (1); the springs' stiffness is divided by its square
  // Where flesh slides along bone: the stiffness of the springs that keep the flesh at its distance from the bone, for
  // an adult's size, in kPa per mm. Flesh that presses with 50 kPa comes 0.1 mm nearer.
  double slide_kpa_per_mm = 500;
  // The loose layer between flesh and bone, for an adult: its shear modulus, kPa, and its thickness, mm.
  double fascia_kpa = 0.1, fascia_mm = 2;
};

// The state of a solve after an iteration. V is valid only during the callback.
struct SolveStep {
  double reached;   // position on the path for which this iteration solves, [0, 1]
  int iteration;    // number of iterations so far, over all steps
  double residual;  // longest motion of a node in the full Newton step, mm
  const Eigen::MatrixX3d& V;
};

struct SolvedPose {
  Eigen::MatrixX3d V;      // #V node positions in the pose, mm
  bool converged = false;  // false: V is the last solved step (at `reached`), or at the pose but not exact enough
  double reached = 0;      // position on the path that V has reached, [0, 1]
  std::string blocked_by;  // message for the user: what stopped the solve; empty if it converged
  int steps = 0, iterations = 0, factorizations = 0, analyses = 0;
  int repeated_in_double = 0;    // number of factorizations that single precision was too inexact for
  double residual = 0;           // longest motion of a node in the last full Newton step, mm
  double min_det_f = 1;          // smallest det F of the tets of flesh in V
  double min_det_f_of_path = 1;  // smallest det F of tets of flesh at the ends of all steps
  double bone_drift_mm = 0;      // largest distance in V of a bone's node from its rigidly moved position
  SlideForm::Slide slide;        // the largest slide of a node in V, and the largest change of its distance to its bone
  // Contact forces between skin and objects, mN: on each node of the mesh, and on each node of the objects. Empty if
  // there are no objects.
  NodePositions force_on_skin, force_on_objects;
  NodePositions objects;        // positions of the objects' nodes
  std::vector<int> pressed_by;  // #V: the object that presses the node most; -1: none does
  std::int64_t inverted = 0;    // tets of flesh and bone with det F <= 0, summed over the ends of all steps
  FemSeconds seconds;
};

// Solves for the shape at the end of the path.
//   start  #V positions at the start of the path (such as the result of a neighbouring frame); null: rest
//   throws Error if the model's lists disagree in length, a tet is inverted at the start, or memory does not suffice
SolvedPose solve_pose(const FemModel& model, const BonePath& path, double largest_angle_degrees,
                      const SolveSettings& settings = {}, Progress& progress = no_progress(),
                      const std::function<void(const SolveStep&)>& on_step = {},
                      const Eigen::MatrixX3d* start = nullptr);

}  // namespace limber
