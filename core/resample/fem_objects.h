// SPDX-License-Identifier: AGPL-3.0-or-later
// Presses rigid objects against a body that is posed by finite elements, for example a seat, a phone at the cheek, or a
// cuff around the arm. The body is posed first, while the objects are far away. Then each object moves to its target
// position, in a straight line or, around a limb, from all sides. If a force is requested, the object then moves
// further or back until it presses with this force.
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
  std::string name;      // name of the object in messages and the report
  TriangleMesh surface;  // surface of the object at its target position, world, mm
  // World direction from which the object comes; its length does not matter. None: of the six directions along the
  // world axes, the one with the shortest way.
  std::optional<glm::dvec3> from;
  // If true, every point of the object moves straight towards the object's axis, as a cuff tightens. If false, the
  // object moves as a whole.
  bool tightens = false;
  // Requested force along the object's way: force_n, N, plus share_of_weight times the body's weight. If both are zero,
  // the object stops at its target position with whatever force results.
  double force_n = 0, share_of_weight = 0;
};

// The effect of an object on the body, at the object's final position.
struct ObjectReport {
  std::string name;
  double away_mm = 0;  // distance from the target position along its way; negative: the object moved beyond it
  std::optional<double> asked_n;
  glm::dvec3 force_n{0};       // force of the object on the body, N
  double pressing_n = 0;       // force along the object's way, N; if it tightens, the sum over all sides
  double area_mm2 = 0;         // area of skin in contact
  double largest_kpa = 0;      // largest pressure on a node of the skin
  double gap_mm = 0;           // smallest distance between skin and object
  std::int64_t crossings = 0;  // number of pairs of a skin triangle and an object triangle that cross
};

// A node of the skin that an object presses on.
struct PressedNode {
  glm::dvec3 position;  // posed position of the node, world, mm
  double kpa, area_mm2;
  int object;
};

class FemObjects {
 public:
  FemObjects() = default;
  explicit FemObjects(std::vector<FemObject> objects);

  bool empty() const { return objects_.empty(); }
  // Returns each object's surface as sample points, with the directions from which the object may come. moving_tissue()
  // uses them to find the tissue that the objects press on. Throws Error if an object needs millions of points.
  //   reach_mm  upper limit on the distance between sample points
  std::vector<ObjectSweep> sweeps(double reach_mm) const;
  // Selects for each object the shortest of its ways out of the body, which moving_tissue() found. Throws Error if the
  // body blocks all of them, or if the object comes near no tissue.
  void choose(const std::vector<ObjectClearance>& clearances);
  // Adds the objects to a model, far away from the body.
  void add_to(FemModel& model) const;

  // Moves the objects to their target positions, starting from a solved pose, until they press with the requested
  // forces.
  //   model     the model with the objects; its `objects.at` is changed
  //   pose      motions of the bones, which stay as they are
  //   settings  of the solve; `spacing` is the edge length of the tets, mm
  //   weight_n  weight of the body, N
  // Returns the solved shape; its counts of steps and iterations include those of the given `solved`.
  SolvedPose press(FemModel& model, const std::vector<RigidTransform>& pose, SolvedPose solved,
                   const SolveSettings& settings, double spacing, double weight_n, Progress& progress,
                   const std::function<void(const SolveStep&)>& on_step);
  // Holds the objects at their present positions during the next solve.
  void stay(FemModel& model) const;

  std::vector<ObjectReport> report(const FemModel& model, const SolvedPose& solved) const;
  std::vector<PressedNode> pressed_nodes(const FemModel& model, const SolvedPose& solved) const;

 private:
  struct Way {
    std::vector<glm::dvec3> of_vertex;  // motion of each vertex per mm that the object moves away
    // Distance from the target position at which the object does not touch the body, mm. Its approach starts there.
    double clear_mm = 0;
  };
  std::vector<Way> ways_to(const FemObject& object) const;
  NodePositions positions(const std::vector<double>& away) const;
  void find_away(const NodePositions& there);
  SolvedPose move(FemModel& model, const std::vector<RigidTransform>& pose, const SolvedPose& from,
                  const std::vector<double>& away, const SolveSettings& settings, double spacing, Progress& progress,
                  const std::function<void(const SolveStep&)>& on_step);
  double pressing(const SolvedPose& solved, std::size_t object) const;
  // Returns, for each object, the number of pairs of a skin triangle and an object triangle that cross.
  std::vector<std::int64_t> crossings(const FemModel& model, const Eigen::MatrixX3d& body) const;

  std::vector<FemObject> objects_;
  std::vector<Way> way_;      // the selected way of each object
  std::vector<double> away_;  // distance of each object from its target position, mm
  std::vector<std::optional<double>> asked_n_;
};

// Returns the mass of each node of a mesh, kg. The mass follows from the densities of the tissues in the tets.
std::vector<double> node_masses(const TissueModel& model, const TissueTable& tissues);
// Returns the weight of the whole body, N.
double weight_of(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues);

}  // namespace limber
