// SPDX-License-Identifier: AGPL-3.0-or-later
// Presses rigid objects against a body that finite elements pose: a seat, a phone at the cheek, a cuff around the arm.
// The body is posed first, while each object stays away. Then the objects come to their places, in a straight line or,
// around a limb, from all sides. If an object must press with a given force, it then moves on or back until it does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/fem/solve_pose.h"
#include "core/fem/tissue_model.h"
#include "core/mesh/surface.h"

namespace limber {

constexpr double kStandardGravity = 9.80665;  // acceleration of gravity, m/s2

struct FemObject {
  std::string name;      // for messages and the report
  TriangleMesh surface;  // in its place, world, mm
  // The direction from which the object comes, in the world; the length does not matter. None: the shortest of the
  // ways along the world's axes.
  std::optional<glm::dvec3> from;
  // true: every point of the object comes from further out, straight towards the object's axis, as a cuff tightens
  bool tightens = false;
  // The force along its way with which the object must press, N, and as a share of the body's weight; their sum counts.
  // Zero: the object stops at its place, whatever the force.
  double force_n = 0, share_of_weight = 0;
};

// What an object does to the body, at its final place.
struct ObjectReport {
  std::string name;
  double away_mm = 0;  // distance along its way from the place that was given; below 0: it went further
  std::optional<double> asked_n;
  glm::dvec3 force_n{0};       // force of the object on the body, N
  double pressing_n = 0;       // the force along the object's way, N; around a limb the sum from all sides
  double area_mm2 = 0;         // area of skin in contact
  double largest_kpa = 0;      // largest pressure on a node of the skin
  double gap_mm = 0;           // smallest distance of skin to the object
  std::int64_t crossings = 0;  // pairs of triangles of skin and object that cross
};

// A node of the skin that an object presses.
struct PressedNode {
  glm::dvec3 position;  // in the pose, world, mm
  double kpa, area_mm2;
  int object;
};

class FemObjects {
 public:
  FemObjects() = default;
  explicit FemObjects(std::vector<FemObject> objects);

  bool empty() const { return objects_.empty(); }
  // The objects' surfaces, and for each the ways that it may come, to find the tissue that they press (moving_tissue).
  //   reach_mm  upper limit on the distance between the points of a sweep
  // Throws Error for an object with millions of such points.
  std::vector<ObjectSweep> sweeps(double reach_mm) const;
  // Chooses each object's way by what moving_tissue() has found. Throws Error if no way leads an object to its place,
  // or if no tissue is near it.
  void choose(const std::vector<ObjectClearance>& clearances);
  // Puts the objects into a model, far away from the body.
  void add_to(FemModel& model) const;

  // Brings the objects to their places and lets them press as they must, starting from a solved pose.
  //   model     the model with the objects; its `objects.at` is changed
  //   pose      motions of the bones, which stay
  //   settings  of the solve; `spacing` is the edge length of the tets, mm
  //   weight_n  weight of the body, N
  // Returns the solved shape with the counts of both solves.
  SolvedPose press(FemModel& model, const std::vector<RigidTransform>& pose, SolvedPose solved,
                   const SolveSettings& settings, double spacing, double weight_n, Progress& progress,
                   const std::function<void(const SolveStep&)>& on_step);
  // Keeps the objects where they are during the next solve.
  void stay(FemModel& model) const;

  std::vector<ObjectReport> report(const FemModel& model, const SolvedPose& solved) const;
  std::vector<PressedNode> pressed_nodes(const FemModel& model, const SolvedPose& solved) const;

 private:
  struct Way {
    std::vector<glm::dvec3> of_vertex;  // motion of each vertex per mm that the object moves away
    double clear_mm = 0;                // distance at which the object does not touch the body
  };
  std::vector<Way> ways_to(const FemObject& object) const;
  NodePositions positions(const std::vector<double>& away) const;
  void find_away(const NodePositions& there);
  SolvedPose move(FemModel& model, const std::vector<RigidTransform>& pose, const SolvedPose& from,
                  const std::vector<double>& away, const SolveSettings& settings, double spacing, Progress& progress,
                  const std::function<void(const SolveStep&)>& on_step);
  double pressing(const SolvedPose& solved, std::size_t object) const;
  // Returns, for each object, the pairs of triangles of the skin and of the object that cross.
  std::vector<std::int64_t> crossings(const FemModel& model, const Eigen::MatrixX3d& body) const;

  std::vector<FemObject> objects_;
  std::vector<Way> way_;      // the chosen way of each object
  std::vector<double> away_;  // distance of each object from its place, mm
  std::vector<std::optional<double>> asked_n_;
};

// Returns the mass of each node of a mesh, kg, from the densities of the tissues in its tets.
std::vector<double> node_masses(const TissueModel& model, const TissueTable& tissues);
// Returns the weight of the whole body, N.
double weight_of(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues);

}  // namespace limber
