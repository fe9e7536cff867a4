// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/solve_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "core/base/dual_quaternion.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/fem/newton.h"
#include "core/fem/solved_parts.h"

namespace limber {

namespace {
constexpr int kKeepings = 6;          // number of solves after it that keep the volumes of tissues
constexpr int kSettling = 3;          // factor on step_iterations for the last solve, at the final pose
constexpr double kStragglers = 1e-3;  // NewtonSettings::stragglers, a share of the nodes
constexpr double kStalled = 0.005;    // NewtonSettings::stalled of all solves but the last
// Factor on step_tolerance_mm when a shape is solved again before the next part is retried.
constexpr double kTight = 0.25;
constexpr double kLeastPart = 0.1;  // if objects move by less than this share of the shortest part, the part fails
// If contact or a tet about to invert allows less than this share of the way to an initial guess, the guess is
// smoothed.
constexpr double kRough = 0.5;
// Strength, kPa, of the barrier that keeps tets from becoming nearly flat. It halves the iterations of a deep bend.
constexpr double kWeakBarrier = 100;

Eigen::RowVector3d moved(const RigidTransform& transform, const Eigen::RowVector3d& p) {
  const glm::dvec3 q = transform * glm::dvec3(p[0], p[1], p[2]);
  return {q.x, q.y, q.z};
}

// All nodes of objects have this number in the list of rigid nodes; it is above the numbers of all bones. So objects
// count as one rigid body, and contact between them is ignored.
constexpr int kObjects = 1 << 20;

NodePositions with_objects(const NodePositions& body, const NodePositions& objects) {
  NodePositions all(body.rows() + objects.rows(), 3);
  all << body, objects;
  return all;
}

class PoseSolve {
 public:
  PoseSolve(const FemModel& model, const BonePath& path, const SolveSettings& settings, Progress& progress,
            const std::function<void(const SolveStep&)>& on_step, const Eigen::MatrixX3d* start)
      : model_(model),
        path_(path),
        settings_(settings),
        progress_(progress),
        on_step_(on_step),
        waiting_(worth_waiting(model)),
        nodes_(model.mesh.V.rows()),
        rest_(with_objects(model.mesh.V, model.objects.rest)),
        x_(with_objects(start ? *start : model.mesh.V, objects_at(0))) {}

  SolvedPose run(double largest_angle_degrees) {
    const double whole = settings_.step_degrees / std::max(largest_angle_degrees, 1e-9);
    const double regular = 1 / std::max(1.0, std::ceil(1 / whole - 1e-9));
    shortest_ = std::min(regular, settings_.shortest_step_degrees / std::max(largest_angle_degrees, 1e-9));
    free_for(regular);
    if (at_rest()) result_.reached = 1;
    advance(regular);
    if (result_.steps > 0 && result_.reached == 1) settle();
    result_.converged = result_.reached == 1 && result_.blocked_by.empty();
    result_.V = x_.topRows(nodes_);
    if (!model_.objects.empty()) measure_objects();
    energy_->move_slide(path_(result_.reached));
    result_.slide = energy_->slide().largest(x_);
    result_.min_det_f = energy_->min_ratio(x_);
    count_spent();
    return std::move(result_);
  }

  const FemSeconds& seconds() const { return seconds_; }

 private:
  void advance(double length) {
    while (result_.reached < 1) {
      progress_.update("solving", result_.reached);
      if (!step(result_.reached + length > 1 - 1e-9 ? 1 : result_.reached + length)) break;
    }
  }
  // Returns the positions of the objects' nodes at a position on the path.
  NodePositions objects_at(double place) const {
    return model_.objects.empty() ? NodePositions(0, 3) : model_.objects.at(place);
  }
  void measure_objects();
  ContactForm contact() const;
  void free_for(double place);
  void count_spent();
  std::vector<int> rigid_nodes() const;
  bool at_rest() const;
  bool step(double to);
  bool part(double from, double& to, NodePositions& x);
  void tell(double at, int iteration, double residual, const NodePositions& x);
  NewtonResult relax(double at, double tolerance_mm, int iterations, NodePositions& x);
  bool good(const std::vector<RigidTransform>& pose, const NodePositions& x);
  void record();
  void settle();
  bool settle_from(NodePositions x);
  void hold_at(double at, const NodePositions* less = nullptr);
  NodePositions weight_at(double at) const;
  template <class Way>
  NodePositions blend(const NodePositions& x, const Way& way) const;
  double follow(double from, double to, NodePositions& x);
  struct Drift {
    double mm = 0;
    int node = -1;
  };
  Drift bone_drift(const std::vector<RigidTransform>& pose, const NodePositions& x) const;
  std::string at(const std::array<int, 4>& nodes, const NodePositions& x) const;
  std::string obstacle(const FemEnergy::Bound& bound, const NodePositions& x) const;

  const FemModel& model_;
  const BonePath& path_;
  const SolveSettings& settings_;
  Progress& progress_;
  const std::function<void(const SolveStep&)>& on_step_;
  const std::vector<FemModel::Waiting> waiting_;
  double freed_ = 0;          // nodes that wait until a path position before this one are free
  std::vector<int> held_by_;  // #V: the bone that currently holds each node; -1: free
  SolvedParts parts_;
  const Eigen::Index nodes_;  // number of the mesh's nodes; in rest_, held_ and x_ the objects' nodes follow them
  const NodePositions rest_;
  std::vector<char> held_;  // 1 for nodes of objects and nodes that move rigidly or by stiff springs with a bone
  NodePositions x_;
  double shortest_ = 0;  // length of the shortest step, as a share of the path
  std::optional<FemEnergy> energy_;
  FemSeconds seconds_;
  SolvedPose result_;
};

// Frees the nodes that wait until a path position before `place`: they become unknowns like other nodes of flesh. Nodes
// that wait longer move with their bone.
void PoseSolve::free_for(double place) {
  freed_ = std::max(freed_, place);
  std::vector<int> held_by = model_.held_by;
  for (const FemModel::Waiting& each : waiting_)
    if (each.until >= freed_) held_by[each.node] = each.bone;
  if (energy_ && held_by == held_by_) return;
  if (energy_) count_spent();
  energy_.reset();
  held_by_ = std::move(held_by);
  parts_ = SolvedParts(model_, held_by_, settings_.size);
  for (auto v = nodes_; v < rest_.rows(); ++v) parts_.carried.push_back(int(v));
  held_.assign(rest_.rows(), 1);
  for (std::size_t v = 0; v < held_by_.size(); ++v) held_[v] = held_by_[v] >= 0 && !parts_.in_joint[v];
  energy_.emplace(rest_, parts_.elastic, parts_.material, kWeakBarrier);
  energy_->add_inversion_guard(parts_.rigid);
  if (settings_.contact) energy_->set_contact(contact());
  if (!model_.sliding.empty()) energy_->set_slide(slide_form_of(model_, settings_));
}

ContactForm PoseSolve::contact() const {
  const Eigen::MatrixX3i skin = boundary_of(model_.mesh);
  Eigen::MatrixX3i F(skin.rows() + model_.objects.F.rows(), 3);
  F << skin, model_.objects.F.array() + int(nodes_);
  return {F,
          rest_,
          rigid_nodes(),
          {.thickness_mm = settings_.contact_mm, .object_mm = settings_.object_mm, .skin_nodes = int(nodes_)}};
}

void PoseSolve::count_spent() {
  result_.factorizations += energy_->factorizations();
  result_.analyses += energy_->analyses();
  result_.repeated_in_double += energy_->repeated_in_double();
  seconds_ += energy_->seconds();
}

// Returns true if no node has to move. The solve's result is then equal to its start, bit for bit.
bool PoseSolve::at_rest() const {
  const auto pose = path_(1);
  if (x_.bottomRows(rest_.rows() - nodes_) != objects_at(1) || settings_.gravity != Eigen::RowVector3d::Zero())
    return false;
  for (int v = 0; v < int(nodes_); ++v)
    if (const int bone = held_by_[v]; bone >= 0 && moved(pose[bone], rest_.row(v)) != x_.row(v)) return false;
  return x_.topRows(nodes_) == rest_.topRows(nodes_);
}

// Sets the target positions of the nodes that bones and objects hold, for a position on the path.
//   less  #V offsets to subtract from these target positions; null: none
void PoseSolve::hold_at(double at, const NodePositions* less) {
  const auto pose = path_(at);
  const NodePositions objects = objects_at(at);
  const auto place_of = [&](int v) {
    const Eigen::RowVector3d place =
        v < nodes_ ? moved(pose[held_by_[v]], rest_.row(v)) : Eigen::RowVector3d(objects.row(v - nodes_));
    return less ? Eigen::RowVector3d(place - less->row(v)) : place;
  };
  PinForm pins{parts_.pinned, NodePositions(parts_.pinned.size(), 3), NodePositions(parts_.pinned.size(), 3)};
  for (std::size_t k = 0; k < parts_.pinned.size(); ++k) {
    pins.stiffness.row(k).setConstant(parts_.pin_stiffness[k]);
    pins.target.row(k) = place_of(parts_.pinned[k]);
  }
  NodePositions carried(parts_.carried.size(), 3);
  for (std::size_t k = 0; k < parts_.carried.size(); ++k) carried.row(k) = place_of(parts_.carried[k]);
  energy_->set_constraints(std::move(pins), parts_.carried, std::move(carried));
  energy_->move_slide(pose);
  if (!model_.mass.empty()) energy_->set_load(weight_at(at));
}

// Returns the weight of each node, mN. Gravity grows along the path if the solve starts at rest.
NodePositions PoseSolve::weight_at(double at) const {
  NodePositions weight = NodePositions::Zero(rest_.rows(), 3);
  const double share = settings_.has_weight_at_start ? 1 : at;
  for (std::size_t v = 0; v < model_.mass.size(); ++v) weight.row(v) = 1e3 * share * model_.mass[v] * settings_.gravity;
  return weight;
}

// Returns one vector per node: way(bone, position) for a node that a bone holds, zero for nodes of objects. For other
// nodes, returns the sum of weight * way(bone, position) over the node's influences.
template <class Way>
NodePositions PoseSolve::blend(const NodePositions& x, const Way& way) const {
  NodePositions sum = NodePositions::Zero(x.rows(), 3);
  parallel_for(nodes_, 4096, [&](std::int64_t begin, std::int64_t end) {
    for (auto v = begin; v < end; ++v) {
      const glm::dvec3 p(x(v, 0), x(v, 1), x(v, 2));
      const auto add = [&](int bone, double weight) {
        const glm::dvec3 q = weight * way(bone, p);
        sum.row(v) += Eigen::RowVector3d(q.x, q.y, q.z);
      };
      if (held_by_[v] >= 0) add(held_by_[v], 1);
      else
        for (const auto& [bone, weight] : model_.influences[v]) add(bone, weight);
    }
  });
  return sum;
}

// Returns, for each node, the bone with which it moves rigidly; kObjects for nodes of objects; -1: none.
std::vector<int> PoseSolve::rigid_nodes() const {
  std::vector<int> rigid = held_by_;
  for (std::size_t v = 0; v < rigid.size(); ++v)
    if (!held_[v]) rigid[v] = -1;
  rigid.resize(rest_.rows(), kObjects);
  return rigid;
}

// Moves x, the solution at path position `from`, to an initial guess of the shape at position `to`. The guess is a
// Newton step for the bones' velocities at `from` (the path's tangent), plus the difference between the bones' motions
// and these velocities. If limits do not allow it, tries half of the way, a quarter, and so on. Returns the path
// position that x has reached; the bones are held there. Returns `from` if no step is possible.
double PoseSolve::follow(double from, double to, NodePositions& x) {
  const auto start = path_(from);
  const auto moved_to = [&](double at) {
    std::vector<RigidTransform> motion = path_(at);
    for (std::size_t b = 0; b < motion.size(); ++b) motion[b] = motion[b] * inverse(start[b]);
    return motion;
  };
  const NodePositions objects = objects_at(from);
  const auto blend_of = [&](const std::vector<RigidTransform>& motion, double at) {
    NodePositions blended = blend(x, [&](int bone, const glm::dvec3& p) { return motion[bone] * p - p; });
    blended.bottomRows(objects.rows()) = objects_at(at) - objects;
    return blended;
  };
  std::vector<RigidTransform> motion = moved_to(to);
  std::vector<Screw> screw;
  for (const RigidTransform& each : motion) screw.push_back(screw_of(each));
  NodePositions pace = blend(x, [&](int bone, const glm::dvec3& p) { return screw[bone].velocity(p); });
  NodePositions blended = blend_of(motion, to), way;
  pace.bottomRows(objects.rows()) = blended.bottomRows(objects.rows());
  const NodePositions turns = blended - pace;
  double slope = 0;
  hold_at(to, &turns);
  energy_->move_slide(start, pace);
  energy_->build_broad_phase(x);
  if (!energy_->newton_step(x, HessianKind::Projected, way, slope, &pace)) return from;
  for (double share = 1;; share /= 2) {
    const double at = share == 1 ? to : from + share * (to - from);
    if (share < 1) blended = blend_of(moved_to(at), at);
    NodePositions step = blended + share * (way - pace);
    double bound = energy_->largest_step(x, step, 1).length;
    if (bound < kRough) {
      step = energy_->limit_step(x, step, held_);
      bound = energy_->largest_step(x, step, 1).length;
    }
    if (bound < kRough && at - from > shortest_) continue;
    // Objects must be at their prescribed positions: unlike bones, they have no springs that would pull them there.
    const double there = objects.rows() ? from + bound * (at - from) : at;
    if (there < to && there - from < kLeastPart * shortest_) return from;
    x += bound * step;
    hold_at(there);
    tell(there, ++result_.iterations, std::sqrt(step.rowwise().squaredNorm().maxCoeff()), x);
    return there;
  }
}

PoseSolve::Drift PoseSolve::bone_drift(const std::vector<RigidTransform>& pose, const NodePositions& x) const {
  Drift drift;
  for (const int v : parts_.pinned)
    if (const double mm = (x.row(v) - moved(pose[held_by_[v]], rest_.row(v))).norm();
        !parts_.in_joint[v] && mm > drift.mm)
      drift = {mm, v};
  return drift;
}

// Returns text such as "between Humerus and Forearm near (1, 2, 3) mm": the two bones with most weight at the nodes,
// and the mean of the nodes' positions.
std::string PoseSolve::at(const std::array<int, 4>& nodes, const NodePositions& x) const {
  std::vector<double> share(path_(0).size(), 0);
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const int v : nodes) {
    centre += 0.25 * x.row(v);
    if (v >= nodes_) continue;
    for (const auto& [bone, weight] : model_.influences[v]) share[bone] += weight;
  }
  const auto name = [&](std::size_t bone) {
    return bone < model_.bone_names.size() ? model_.bone_names[bone] : "bone " + std::to_string(bone);
  };
  const auto first = std::size_t(std::max_element(share.begin(), share.end()) - share.begin());
  const double most = std::exchange(share[first], 0);
  const auto second = std::size_t(std::max_element(share.begin(), share.end()) - share.begin());
  char place[80];
  std::snprintf(place, sizeof place, " near (%.0f, %.0f, %.0f) mm", centre[0], centre[1], centre[2]);
  return (share[second] > 0.01 * most
              ? "between " + name(std::min(first, second)) + " and " + name(std::max(first, second))
              : "on " + name(first)) +
         place;
}

std::string PoseSolve::obstacle(const FemEnergy::Bound& bound, const NodePositions& x) const {
  if (bound.obstacle == FemEnergy::Obstacle::None) return "the solver finds no step that lowers the energy";
  std::string what =
      bound.obstacle == FemEnergy::Obstacle::Contact ? "skin presses against skin " : "tissue is squeezed flat ";
  for (const int v : bound.node)
    if (v >= nodes_) what = "skin presses against " + model_.objects.name[model_.objects.object[v - nodes_]] + " ";
  return what + at(bound.node, x);
}

void PoseSolve::tell(double at, int iteration, double residual, const NodePositions& x) {
  progress_.update("solving", result_.reached);
  if (!on_step_) return;
  const Eigen::MatrixX3d V = x.topRows(nodes_);
  on_step_({at, iteration, residual, V});
}

// Minimises the energy, starting at x, with bones at the targets of hold_at(). The last broad phase must be valid at x.
NewtonResult PoseSolve::relax(double at, double tolerance_mm, int iterations, NodePositions& x) {
  const int before = result_.iterations;
  const NewtonResult solved =
      minimise(*energy_, x, {tolerance_mm, kStragglers, result_.reached == 1 ? 0 : kStalled, iterations, held_},
               progress_, [&](int iteration, double residual) { tell(at, before + iteration, residual, x); });
  result_.iterations += solved.iterations;
  result_.residual = solved.residual;
  return solved;
}

// Solves at the final pose again, to the final tolerance, which is finer than that of the steps. A shape that does not
// converge is kept, because it is as good as the result of a step. Then keeps the volumes of tissues.
void PoseSolve::settle() {
  result_.blocked_by.clear();
  hold_at(1);
  if (result_.residual >= settings_.tolerance_mm && !settle_from(x_)) return;
  VolumeKeeper keeper(model_.mesh, model_.kept, model_.material);
  for (int round = 0; round < kKeepings && result_.blocked_by.empty(); ++round) {
    const std::vector<double> pressures = keeper.pressures_at(x_);
    if (pressures.empty()) return;
    energy_->set_pressures(pressures, parts_.elastic_tet);
    const NodePositions before = x_;
    const double residual = result_.residual, drift = result_.bone_drift_mm;
    if (settle_from(x_) && result_.blocked_by.empty()) continue;
    // Without a solution, the shape before stays; its volumes are in the report.
    x_ = before;
    result_.residual = residual;
    result_.bone_drift_mm = drift;
    result_.blocked_by.clear();
    return;
  }
}

// Solves at the final pose, starting at x, and keeps the result if it is good. Otherwise returns false.
bool PoseSolve::settle_from(NodePositions x) {
  energy_->build_broad_phase(x);
  const NewtonResult solved = relax(1, settings_.tolerance_mm, kSettling * settings_.step_iterations, x);
  if (!good(path_(1), x)) return false;
  x_ = std::move(x);
  record();
  if (solved.converged) return true;
  char moves[60];
  std::snprintf(moves, sizeof moves, "nodes would still move by %.1f mm: ", solved.residual);
  result_.blocked_by = moves + obstacle(solved.bound, x_);
  return true;
}

// Returns true if all bones' nodes are close to their bones. Otherwise sets blocked_by and returns false.
bool PoseSolve::good(const std::vector<RigidTransform>& pose, const NodePositions& x) {
  const Drift drift = bone_drift(pose, x);
  if (drift.mm > settings_.bone_drift_mm) {
    char by[40];
    std::snprintf(by, sizeof by, "bone would bend by %.1f mm ", drift.mm);
    result_.blocked_by = by + at({drift.node, drift.node, drift.node, drift.node}, x);
    return false;
  }
  result_.bone_drift_mm = drift.mm;
  return true;
}

// Measures the forces between skin and objects.
void PoseSolve::measure_objects() {
  energy_->build_broad_phase(x_);
  const auto [forces, pressed_by] = energy_->object_forces(x_);
  result_.pressed_by.assign(nodes_, -1);
  for (Eigen::Index v = 0; v < nodes_; ++v)
    if (pressed_by[v] >= 0) result_.pressed_by[v] = model_.objects.object[pressed_by[v] - nodes_];
  result_.objects = x_.bottomRows(rest_.rows() - nodes_);
  result_.force_on_skin = forces.topRows(nodes_);
  result_.force_on_objects = forces.bottomRows(rest_.rows() - nodes_);
}

void PoseSolve::record() {
  result_.inverted += count_inverted(energy_->volume_tets(), x_);
  result_.min_det_f_of_path = std::min(result_.min_det_f_of_path, energy_->min_ratio(x_));
}

// Solves one part of a step: moves x from the solution at path position `from` to the solution at `to`. If no guess for
// `to` is possible, lowers `to` to a nearer position. Returns false if no solution was found.
bool PoseSolve::part(double from, double& to, NodePositions& x) {
  const double at = follow(from, to, x);
  if (at == from) {
    result_.blocked_by = obstacle({}, x);
    return false;
  }
  to = at;
  const NewtonResult solved = relax(at, settings_.step_tolerance_mm, settings_.step_iterations, x);
  if (!solved.converged) {
    result_.blocked_by = obstacle(solved.bound, x);
    return false;
  }
  return good(path_(at), x);
}

// Solves from the path position reached so far towards `to`, as far as possible. If the whole way fails, solves it in
// shorter parts. Returns false if not even the shortest part can be solved.
bool PoseSolve::step(double to) {
  free_for(to);
  const double begin = result_.reached;
  double& from = result_.reached;
  double way = to - from;
  bool loose = from > 0;
  while (from < to) {
    double next = way < 0.999 * (to - from) ? from + way : to;
    NodePositions x = x_;
    if (part(from, next, x)) {
      x_ = std::move(x);
      way = 2 * (next - from);
      from = next;
      loose = result_.residual > kTight * settings_.step_tolerance_mm;
    } else if (std::exchange(loose, false)) {
      // Solves the current shape more precisely, since the next part fails more often if tissue lags behind its bones.
      hold_at(from);
      energy_->build_broad_phase(x_);
      relax(from, kTight * settings_.step_tolerance_mm, settings_.step_iterations, x_);
    } else if ((way = 0.5 * (next - from)) < 0.5 * shortest_) {
      if (held_by_ == model_.held_by) break;
      free_for(INFINITY);  // the step may fail because nodes that are not free yet cannot yield
      way = to - from;
    }
  }
  if (from == begin) return false;

  ++result_.steps;
  record();
  return true;
}
}  // namespace

SolvedPose solve_pose(const FemModel& model, const BonePath& path, double largest_angle_degrees,
                      const SolveSettings& settings, Progress& progress,
                      const std::function<void(const SolveStep&)>& on_step, const Eigen::MatrixX3d* start) {
  check(model, start);
  FemSeconds seconds;
  SolvedPose result;
  {
    const CpuTimer timer(seconds.total);
    PoseSolve solve(model, path, settings, progress, on_step, start);
    result = solve.run(largest_angle_degrees);
    seconds = solve.seconds();
  }
  result.seconds = seconds;
  return result;
}

}  // namespace limber
