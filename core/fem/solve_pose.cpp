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

namespace limber {

namespace {
// Stiffness of the springs at bones' nodes per volume around the node, for an adult's size (1), kPa/mm2. With it a bone
// gives way by 0.01 mm where flesh pulls with 50 kPa.
constexpr double kPinStiffness = 1000;
// Spring stiffness in kPa/mm2 at nodes of tets between two bones. With stiffer springs bones' ends often cannot pass.
constexpr double kJointPinStiffness = 0.1;
constexpr TetMaterial kBoneTet{100, 0.3};  // material of tets that one bone holds but that share nodes with flesh
constexpr int kSettling = 3;               // factor on step_iterations for the last solve, at the pose
constexpr double kStragglers = 1e-3;       // NewtonSettings::stragglers of the last solve, a share of the nodes
constexpr double kTight = 0.25;   // factor on step_tolerance_mm for the solve that precedes a second try of a part
constexpr double kWorth = 0.125;  // least number of nodes to free at a time, as a share of the free nodes
constexpr double kRough = 0.5;    // if bounds allow less than this share of a first guess, the guess is smoothed
// Strength, kPa, of the barrier that keeps tets from getting nearly flat. It halves the iterations of a deep bend.
constexpr double kWeakBarrier = 100;

Eigen::RowVector3d moved(const RigidTransform& transform, const Eigen::RowVector3d& p) {
  const glm::dvec3 q = transform * glm::dvec3(p[0], p[1], p[2]);
  return {q.x, q.y, q.z};
}

void check(const FemModel& model, const Eigen::MatrixX3d* start) {
  const auto wrong = [](const char* what) {
    throw Error("a model for finite elements does not fit together", what, "give one entry for each");
  };
  if (std::ssize(model.material) != model.mesh.T.rows()) wrong("materials and tets");
  if (std::ssize(model.held_by) != model.mesh.V.rows()) wrong("held nodes and nodes");
  if (std::any_of(model.waiting.begin(), model.waiting.end(), [&](const FemModel::Waiting& each) {
        return each.node < 0 || each.node >= std::ssize(model.held_by) || each.bone < 0 ||
               model.held_by[each.node] >= 0;
      }))
    wrong("waiting nodes and free nodes");
  if (std::ssize(model.influences) != model.mesh.V.rows()) wrong("influences and nodes");
  if (start && start->rows() != model.mesh.V.rows()) wrong("nodes at the start and nodes");
  if (count_inverted(model.mesh.T, model.mesh.V))
    throw Error("a tet mesh has inverted tets", "at rest", "mesh the volume again");
  if (start && count_inverted(model.mesh.T, *start))
    throw Error("a tet mesh has inverted tets", "at the start of the solve", "start from rest");
}

bool held_by_one(const std::vector<int>& held_by, const Eigen::RowVector4i& tet) {
  const int bone = held_by[tet[0]];
  return bone >= 0 && std::all_of(tet.begin(), tet.end(), [&](int v) { return held_by[v] == bone; });
}

// Returns the nodes that wait until a position on the path before they become free. Small groups of nodes become free
// earlier, together with the group before, since each group that becomes free costs a new analysis of the matrix.
std::vector<FemModel::Waiting> worth_waiting(const FemModel& model) {
  std::vector<FemModel::Waiting> waiting = model.waiting;
  std::stable_sort(waiting.begin(), waiting.end(), [](const auto& a, const auto& b) { return a.until < b.until; });
  double solved_for = double(std::count(model.held_by.begin(), model.held_by.end(), -1)) - double(waiting.size()),
         more = 0, since = 0;
  for (auto begin = waiting.begin(); begin != waiting.end() && begin->until < 1;) {
    const auto end = std::find_if(begin, waiting.end(), [&](const auto& each) { return each.until > begin->until; });
    more += double(end - begin);
    if (more < kWorth * solved_for) {
      for (auto each = begin; each != end; ++each) each->until = since;
    } else {
      since = begin->until;
      solved_for += std::exchange(more, 0);
    }
    begin = end;
  }
  return waiting;
}

// The mesh's tets that deform and its rigid tets; the nodes that bones hold by springs, and the nodes that move exactly
// with a bone (carried). A tet that one bone holds at every node is rigid, unless it shares a node with flesh: that
// node may give way.
struct Parts {
  Eigen::MatrixX4i elastic, rigid;
  std::vector<TetMaterial> material;  // per elastic tet
  std::vector<char> is_flesh;         // 1 for each elastic tet whose nodes are not all held by one bone
  std::vector<int> pinned, carried;   // nodes that bones hold: those of elastic tets, those of rigid tets only
  std::vector<double> pin_stiffness;
  std::vector<char> in_joint;  // #V: 1 for nodes of tets between two bones

  Parts() = default;
  Parts(const FemModel& model, const std::vector<int>& held_by, double size) {
    const auto& T = model.mesh.T;
    std::vector<char> in_flesh(model.mesh.V.rows(), 0), in_elastic(model.mesh.V.rows(), 0);
    for (Eigen::Index t = 0; t < T.rows(); ++t)
      if (!held_by_one(held_by, T.row(t)))
        for (const int v : T.row(t)) in_flesh[v] = 1;

    in_joint.assign(model.mesh.V.rows(), 0);
    for (Eigen::Index t = 0; t < T.rows(); ++t) {
      int first = -1;
      bool joint = false;
      for (const int v : T.row(t))
        if (const int bone = held_by[v]; bone >= 0) joint = joint || (first >= 0 && bone != first), first = bone;
      if (joint)
        for (const int v : T.row(t)) in_joint[v] = 1;
    }

    std::vector<Eigen::Index> elastic_tet, rigid_tet;
    std::vector<double> volume(model.mesh.V.rows(), 0);
    const NodePositions rest = model.mesh.V;
    for (Eigen::Index t = 0; t < T.rows(); ++t) {
      const bool one = held_by_one(held_by, T.row(t));
      if (one && std::none_of(T.row(t).begin(), T.row(t).end(), [&](int v) { return in_flesh[v]; })) {
        rigid_tet.push_back(t);
        continue;
      }
      elastic_tet.push_back(t);
      is_flesh.push_back(!one);
      material.push_back(one ? kBoneTet : model.material[t]);
      for (const int v : T.row(t)) {
        in_elastic[v] = 1;
        volume[v] += determinant(rest, T(t, 0), T(t, 1), T(t, 2), T(t, 3)) / 24;
      }
    }
    elastic = T(elastic_tet, Eigen::all);
    rigid = T(rigid_tet, Eigen::all);
    for (int v = 0; v < int(model.mesh.V.rows()); ++v) {
      if (held_by[v] < 0) continue;
      (in_elastic[v] ? pinned : carried).push_back(v);
      const double spring = (in_joint[v] ? kJointPinStiffness : kPinStiffness) / (size * size);
      if (in_elastic[v]) pin_stiffness.push_back(spring * volume[v]);
    }
  }
};

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
        rest_(model.mesh.V),
        x_(start ? NodePositions(*start) : rest_) {}

  SolvedPose run(double largest_angle_degrees) {
    const double whole = settings_.step_degrees / std::max(largest_angle_degrees, 1e-9);
    const double regular = 1 / std::max(1.0, std::ceil(1 / whole - 1e-9));
    shortest_ = std::min(regular, settings_.shortest_step_degrees / std::max(largest_angle_degrees, 1e-9));
    free_for(regular);
    if (at_rest()) result_.reached = 1;
    advance(regular);
    if (result_.steps > 0 && result_.reached == 1) settle();
    result_.converged = result_.reached == 1 && result_.blocked_by.empty();
    result_.V = x_;
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
  void hold_at(const std::vector<RigidTransform>& pose, const NodePositions* less = nullptr);
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
  double freed_ = 0;          // path position; nodes that wait until an earlier position are free
  std::vector<int> held_by_;  // #V: the bone that holds each node at present, -1: free
  Parts parts_;
  const NodePositions rest_;
  std::vector<char> held_;  // #V: 1 for nodes that a bone carries, or holds by stiff springs
  NodePositions x_;
  double shortest_ = 0;  // length of the shortest step, as a share of the path
  std::optional<FemEnergy> energy_;
  FemSeconds seconds_;
  SolvedPose result_;
};

// Frees the nodes that wait until a position before `place` on the path: they become unknowns, as other nodes of flesh.
// Nodes that still wait move with their bone.
void PoseSolve::free_for(double place) {
  freed_ = std::max(freed_, place);
  std::vector<int> held_by = model_.held_by;
  for (const FemModel::Waiting& each : waiting_)
    if (each.until >= freed_) held_by[each.node] = each.bone;
  if (energy_ && held_by == held_by_) return;
  if (energy_) count_spent();
  energy_.reset();
  held_by_ = std::move(held_by);
  parts_ = Parts(model_, held_by_, settings_.size);
  held_.resize(held_by_.size());
  for (std::size_t v = 0; v < held_.size(); ++v) held_[v] = held_by_[v] >= 0 && !parts_.in_joint[v];
  energy_.emplace(rest_, parts_.elastic, parts_.material, kWeakBarrier);
  energy_->add_inversion_guard(parts_.rigid);
  if (settings_.contact)
    energy_->set_contact(
        ContactForm(boundary_of(model_.mesh.T), rest_, rigid_nodes(), {.thickness_mm = settings_.contact_mm}));
}

void PoseSolve::count_spent() {
  result_.factorizations += energy_->factorizations();
  result_.analyses += energy_->analyses();
  seconds_ += energy_->seconds();
}

// Returns true if no node has to move. The solve's result is then equal to its start, bit for bit.
bool PoseSolve::at_rest() const {
  const auto pose = path_(1);
  for (int v = 0; v < int(rest_.rows()); ++v)
    if (const int bone = held_by_[v]; bone >= 0 && moved(pose[bone], rest_.row(v)) != x_.row(v)) return false;
  return x_ == rest_;
}

// Sets the target positions of the nodes that bones hold to where `pose` moves them.
//   less  #V offsets to subtract from these positions; null: none
void PoseSolve::hold_at(const std::vector<RigidTransform>& pose, const NodePositions* less) {
  const auto place_of = [&](int v) {
    const Eigen::RowVector3d place = moved(pose[held_by_[v]], rest_.row(v));
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
}

// Returns one vector per node, computed by way(bone, position): for a held node with the bone that holds it, for others
// the sum over the bones of the node's influences, with their weights.
template <class Way>
NodePositions PoseSolve::blend(const NodePositions& x, const Way& way) const {
  NodePositions sum = NodePositions::Zero(x.rows(), 3);
  parallel_for(x.rows(), 4096, [&](std::int64_t begin, std::int64_t end) {
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

// Returns, for each node, the bone with which it moves rigidly; -1: none.
std::vector<int> PoseSolve::rigid_nodes() const {
  std::vector<int> rigid = held_by_;
  for (std::size_t v = 0; v < rigid.size(); ++v)
    if (!held_[v]) rigid[v] = -1;
  return rigid;
}

// Moves x, the solution at position `from` on the path, to a first guess of the shape at position `to`. The guess is a
// Newton step for the bones' velocities at `from` (the path's tangent), plus the difference between the bones' turning
// motion and these velocities. If bounds do not allow it, tries half of the way, a quarter, and so on. Returns the
// position that x has reached, at which the bones are then held; `from` if no step is possible.
double PoseSolve::follow(double from, double to, NodePositions& x) {
  const auto start = path_(from);
  const auto moved_to = [&](double at) {
    std::vector<RigidTransform> motion = path_(at);
    for (std::size_t b = 0; b < motion.size(); ++b) motion[b] = motion[b] * inverse(start[b]);
    return motion;
  };
  const auto blend_of = [&](const std::vector<RigidTransform>& motion) {
    return blend(x, [&](int bone, const glm::dvec3& p) { return motion[bone] * p - p; });
  };
  std::vector<RigidTransform> motion = moved_to(to);
  std::vector<Screw> screw;
  for (const RigidTransform& each : motion) screw.push_back(screw_of(each));
  const NodePositions pace = blend(x, [&](int bone, const glm::dvec3& p) { return screw[bone].velocity(p); });
  NodePositions blended = blend_of(motion), way;
  const NodePositions turns = blended - pace;
  double slope = 0;
  hold_at(path_(to), &turns);
  energy_->build_broad_phase(x);
  if (!energy_->newton_step(x, HessianKind::Projected, way, slope, &pace)) return from;
  for (double share = 1;; share /= 2) {
    const double at = share == 1 ? to : from + share * (to - from);
    if (share < 1) blended = blend_of(moved_to(at));
    NodePositions step = blended + share * (way - pace);
    double bound = energy_->largest_step(x, step, 1).length;
    if (bound < kRough) {
      step = energy_->limit_step(x, step, held_);
      bound = energy_->largest_step(x, step, 1).length;
    }
    if (bound < kRough && at - from > shortest_) continue;
    x += bound * step;
    hold_at(path_(at));
    tell(at, ++result_.iterations, std::sqrt(step.rowwise().squaredNorm().maxCoeff()), x);
    return at;
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

// Returns text such as "between Humerus and Forearm near (1, 2, 3) mm": the two bones with most weight at the nodes.
std::string PoseSolve::at(const std::array<int, 4>& nodes, const NodePositions& x) const {
  std::vector<double> share(path_(0).size(), 0);
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const int v : nodes) {
    centre += 0.25 * x.row(v);
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
  if (bound.obstacle == FemEnergy::Obstacle::None) return "the solver finds no lower energy";
  const char* what =
      bound.obstacle == FemEnergy::Obstacle::Contact ? "skin presses against skin " : "tissue is squeezed flat ";
  return what + at(bound.node, x);
}

void PoseSolve::tell(double at, int iteration, double residual, const NodePositions& x) {
  progress_.update("solving", result_.reached);
  if (!on_step_) return;
  const Eigen::MatrixX3d V = x;
  on_step_({at, iteration, residual, V});
}

// Minimises the energy from x on, with bones held as hold_at() set. The last broad phase must be valid at x.
NewtonResult PoseSolve::relax(double at, double tolerance_mm, int iterations, NodePositions& x) {
  const int before = result_.iterations;
  const NewtonResult solved =
      minimise(*energy_, x, {tolerance_mm, result_.reached == 1 ? kStragglers : 0, iterations, held_}, progress_,
               [&](int iteration, double residual) { tell(at, before + iteration, residual, x); });
  result_.iterations += solved.iterations;
  result_.residual = solved.residual;
  return solved;
}

// Solves again at the pose, to the final tolerance; steps end at a coarser tolerance. A shape that does not converge is
// kept, because it is as good as the result of a step.
void PoseSolve::settle() {
  result_.blocked_by.clear();
  if (result_.residual < settings_.tolerance_mm) return;
  const auto pose = path_(1);
  hold_at(pose);
  NodePositions x = x_;
  energy_->build_broad_phase(x);
  const NewtonResult solved = relax(1, settings_.tolerance_mm, kSettling * settings_.step_iterations, x);
  if (!good(pose, x)) return;
  x_ = std::move(x);
  record();
  if (solved.converged) return;
  char moves[60];
  std::snprintf(moves, sizeof moves, "nodes would still move by %.1f mm: ", solved.residual);
  result_.blocked_by = moves + obstacle(solved.bound, x_);
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

void PoseSolve::record() {
  result_.inverted += count_inverted(energy_->volume_tets(), x_);
  result_.min_det_f_of_path = std::min(result_.min_det_f_of_path, energy_->min_ratio(x_));
}

// Solves one part of a step: moves x from the solution at path position `from` to the solution at `to`. If that is too
// far, lowers `to` to a nearer position. Returns false if no solution was found.
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

// Solves from the reached path position towards `to`, as far as possible. If the whole way fails, solves it in shorter
// parts. Returns false if not even the shortest part can be solved.
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
      // Solves the current shape more precisely, since tissue that lags behind its bones is a poor start for a part.
      hold_at(path_(from));
      energy_->build_broad_phase(x_);
      relax(from, kTight * settings_.step_tolerance_mm, settings_.step_iterations, x_);
    } else if ((way = 0.5 * (next - from)) < 0.5 * shortest_) {
      if (held_by_ == model_.held_by) break;
      free_for(INFINITY);  // the step may fail because nodes that still wait cannot give way
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
