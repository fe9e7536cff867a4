// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/fem_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "core/base/error.h"
#include "core/fem/contact_surface.h"
#include "core/mesh/crossings.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

namespace {

constexpr double kFar = 10000;  // distance of waiting objects from their target positions, mm
// The solver derives the number of steps from the largest rotation of a joint. An object's motion by one edge length of
// the tets counts as a rotation by this angle, degrees.
constexpr double kDegreesPerEdge = 22.5;
// The solver's tolerance is multiplied by this when objects press on the body with requested forces, because an error
// of the solve changes forces more than shapes.
constexpr double kTight = 0.02;
// The search ends when the force differs from the requested one by at most this share of the requested one.
constexpr double kForceTolerance = 0.01;
constexpr int kForceTries = 20;  // largest number of solves to reach the requested force
// ForceSearch counts a larger excess of force as this multiple of the requested force.
constexpr double kMostOff = 4;
constexpr int kRounds = 4;           // largest number of times that the forces of all objects are searched
constexpr double kStuck = 0.02;      // an object that moved less than this is stuck, mm
constexpr double kFirstMove = 1;     // motion of an object from the first try to the second, mm
constexpr double kDeepest = 50;      // an object moves at most this far beyond its target position, mm
constexpr double kMostPoints = 4e6;  // an object that needs more sample points is refused
constexpr double kNearGap = 2;       // a larger gap between skin and object, mm, is not reported

Eigen::RowVector3d row_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
glm::dvec3 vec_of(const Eigen::RowVector3d& v) { return {v[0], v[1], v[2]}; }

// Returns the direction from an object's axis to each of its vertices; zero for a vertex on the axis.
std::vector<glm::dvec3> away_from_axis(const TriangleMesh& mesh) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  glm::dvec3 centre(0);
  double area = 0;
  for (const glm::ivec3& f : mesh.F) {
    const glm::dvec3 twice = glm::cross(mesh.V[f[1]] - mesh.V[f[0]], mesh.V[f[2]] - mesh.V[f[0]]);
    const double size = glm::length(twice);
    if (!(size > 0)) continue;
    const Eigen::Vector3d normal = row_of(twice / size).transpose();
    sum += size * normal * normal.transpose();
    centre += size * (mesh.V[f[0]] + mesh.V[f[1]] + mesh.V[f[2]]) / 3.0;
    area += size;
  }
  centre /= std::max(area, 1e-300);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
  // The object's axis is the eigenvector whose eigenvalue differs most from the other two, which are alike for a tube.
  const Eigen::Vector3d spread = solver.eigenvalues();
  const glm::dvec3 axis =
      vec_of(solver.eigenvectors().col(spread[1] - spread[0] >= spread[2] - spread[1] ? 0 : 2).transpose());
  std::vector<glm::dvec3> ways;
  for (const glm::dvec3& v : mesh.V) {
    const glm::dvec3 out = v - centre - glm::dot(v - centre, axis) * axis;
    ways.push_back(glm::length(out) > 1e-9 ? glm::normalize(out) : glm::dvec3(0));
  }
  return ways;
}

// Returns the number of segments of at most reach_mm into which sample points divide each edge of a triangle.
int pieces_of(const TriangleMesh& mesh, const glm::ivec3& f, double reach_mm) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(mesh.V[f[k]], mesh.V[f[(k + 1) % 3]]));
  return std::max(1, static_cast<int>(std::ceil(longest / reach_mm)));
}

// Adds sample points on a triangle to a sweep, each with its motion per mm that the object moves away.
//   ways      for each possible direction of approach, the motions of the mesh's vertices per mm
//   reach_mm  upper limit on the distance between sample points
void add_points(const TriangleMesh& mesh, const glm::ivec3& f, const std::vector<std::vector<glm::dvec3>>& ways,
                double reach_mm, ObjectSweep& sweep) {
  const int pieces = pieces_of(mesh, f, reach_mm);
  for (int i = 0; i <= pieces; ++i)
    for (int j = 0; i + j <= pieces; ++j) {
      const glm::dvec3 share = glm::dvec3(i, j, pieces - i - j) / double(pieces);
      const auto at = [&](const std::vector<glm::dvec3>& of) {
        return share.x * of[f[0]] + share.y * of[f[1]] + share.z * of[f[2]];
      };
      sweep.point.push_back(at(mesh.V));
      for (std::size_t w = 0; w < ways.size(); ++w) sweep.ways[w].push_back(at(ways[w]));
    }
}

// Searches the distance from the target position at which an object presses with the requested force. The force grows
// as the object moves closer. The search first takes growing steps until the force has passed the requested one, then
// interpolates between the last distances with too weak and too strong a force [Illinois algorithm, Dowell & Jarratt
// 1971].
class ForceSearch {
 public:
  // Returns the next distance to try.
  //   off  force at the distance `away` minus the requested force, N
  double next(double away, double off) {
    const bool strong = off > 0;
    if (known_[strong] && known_[!strong] && strong == was_strong_) off_[!strong] /= 2;
    away_[strong] = away, off_[strong] = off, known_[strong] = true, was_strong_ = strong;
    if (known_[0] && known_[1]) return away_[0] - off_[0] * (away_[1] - away_[0]) / (off_[1] - off_[0]);
    step_ = step_ ? 2 * step_ : kFirstMove;
    return strong ? away + step_ : away - step_;
  }

 private:
  // Distance in mm and force error in N of the last try with too weak a force [0] and with too strong a force [1].
  std::array<double, 2> away_{}, off_{};
  std::array<bool, 2> known_{};
  bool was_strong_ = false;
  double step_ = 0;
};

}  // namespace

FemObjects::FemObjects(std::vector<FemObject> objects) : objects_(std::move(objects)) {
  for (const FemObject& object : objects_)
    if (object.surface.F.empty()) throw Error("the object has no surface", object.name, "give a surface of triangles");
}

std::vector<FemObjects::Way> FemObjects::ways_to(const FemObject& object) const {
  std::vector<Way> ways;
  const auto add = [&](const glm::dvec3& direction) {
    ways.push_back({std::vector<glm::dvec3>(object.surface.V.size(), glm::normalize(direction))});
  };
  if (object.tightens) {
    ways.push_back({away_from_axis(object.surface)});
    for (const glm::dvec3& way : ways.back().of_vertex)
      if (way == glm::dvec3(0))
        throw Error("an object with points on its axis cannot tighten around a limb", object.name,
                    "give a tube or a ring, or a direction");
  } else if (object.from) {
    add(*object.from);
  } else {
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        glm::dvec3 direction(0);
        direction[axis] = side;
        add(direction);
      }
  }
  return ways;
}

std::vector<ObjectSweep> FemObjects::sweeps(double reach_mm) const {
  std::vector<ObjectSweep> sweeps;
  for (const FemObject& object : objects_) {
    std::vector<std::vector<glm::dvec3>> ways;
    for (Way& way : ways_to(object)) ways.push_back(std::move(way.of_vertex));
    ObjectSweep& sweep = sweeps.emplace_back();
    sweep.ways.resize(ways.size());
    if (object.force_n + object.share_of_weight > 0) sweep.deepest_mm = kDeepest;
    double points = 0;
    for (const glm::ivec3& f : object.surface.F)
      points += 0.5 * std::pow(pieces_of(object.surface, f, reach_mm) + 1, 2);
    if (points > kMostPoints)
      throw Error("the object is too large, or has too many triangles", object.name,
                  "keep only the part near the body; coordinates are in mm");
    for (const glm::ivec3& f : object.surface.F) add_points(object.surface, f, ways, reach_mm, sweep);
  }
  return sweeps;
}

void FemObjects::choose(const std::vector<ObjectClearance>& clearances) {
  way_.clear();
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    if (!std::isfinite(clearances[k].mm))
      throw Error(objects_[k].from || objects_[k].tightens
                      ? "the object cannot reach its position: the body blocks its way for more than 1 m"
                      : "the object cannot reach its position: the body blocks every way for more than 1 m",
                  objects_[k].name,
                  "move the object to the skin, or set the direction from which it comes, as in @from=0,-1,0");
    if (!clearances[k].presses)
      throw Error("the object is not near any skin at its position", objects_[k].name,
                  "move the object to the skin, outside the body; coordinates are in mm");
    way_.push_back(std::move(ways_to(objects_[k])[clearances[k].way]));
    way_.back().clear_mm = clearances[k].mm;
  }
  away_.assign(objects_.size(), kFar);
  asked_n_.assign(objects_.size(), std::nullopt);
}

NodePositions FemObjects::positions(const std::vector<double>& away) const {
  std::size_t count = 0;
  for (const FemObject& object : objects_) count += object.surface.V.size();
  NodePositions all(count, 3);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < objects_.size(); ++k)
    for (std::size_t v = 0; v < objects_[k].surface.V.size(); ++v)
      all.row(row++) = row_of(objects_[k].surface.V[v] + away[k] * way_[k].of_vertex[v]);
  return all;
}

void FemObjects::add_to(FemModel& model) const {
  RigidObjects& objects = model.objects;
  objects.rest = positions(std::vector<double>(objects_.size(), kFar));
  Eigen::Index faces = 0, face = 0;
  int first = 0;
  for (const FemObject& object : objects_) faces += std::ssize(object.surface.F);
  objects.F.resize(faces, 3);
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    for (const glm::ivec3& f : objects_[k].surface.F)
      objects.F.row(face++) = Eigen::RowVector3i(first + f[0], first + f[1], first + f[2]);
    first += static_cast<int>(objects_[k].surface.V.size());
    objects.object.insert(objects.object.end(), objects_[k].surface.V.size(), static_cast<int>(k));
    objects.name.push_back(objects_[k].name);
  }
  stay(model);
}

// Sets away_ to the distances that the objects reached in a solve. A solve that was blocked leaves the objects short of
// their target positions.
void FemObjects::find_away(const NodePositions& there) {
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    double along = 0, ways = 0;
    for (std::size_t v = 0; v < objects_[k].surface.V.size(); ++v, ++row) {
      const glm::dvec3& way = way_[k].of_vertex[v];
      along += glm::dot(vec_of(there.row(row)) - objects_[k].surface.V[v], way);
      ways += glm::dot(way, way);
    }
    away_[k] = along / ways;
  }
}

void FemObjects::stay(FemModel& model) const {
  if (!empty()) model.objects.at = [there = positions(away_)](double) { return there; };
}

// Moves the objects from their present distances to the distances `away`. Sets away_ to the distances that they reach.
SolvedPose FemObjects::move(FemModel& model, const std::vector<RigidTransform>& pose, const SolvedPose& from,
                            const std::vector<double>& away, const SolveSettings& settings, double spacing,
                            Progress& progress, const std::function<void(const SolveStep&)>& on_step) {
  const std::vector<double> start = away_;
  const auto between = [start, away](double t) {
    std::vector<double> now = start;
    for (std::size_t k = 0; k < now.size(); ++k) now[k] += t * (away[k] - start[k]);
    return now;
  };
  model.objects.at = [this, between](double t) { return positions(between(t)); };
  double longest = 0;
  for (std::size_t k = 0; k < away.size(); ++k) longest = std::max(longest, std::abs(away[k] - start[k]));
  SolvedPose solved = solve_pose(
      model, [&](double) { return pose; }, kDegreesPerEdge * longest / spacing, settings, progress, on_step, &from.V);
  find_away(solved.objects);
  stay(model);
  solved.steps += from.steps, solved.iterations += from.iterations, solved.factorizations += from.factorizations;
  solved.repeated_in_double += from.repeated_in_double;
  solved.analyses += from.analyses, solved.inverted += from.inverted, solved.seconds += from.seconds;
  solved.min_det_f_of_path = std::min(solved.min_det_f_of_path, from.min_det_f_of_path);
  return solved;
}

double FemObjects::pressing(const SolvedPose& solved, std::size_t object) const {
  double sum = 0;
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < objects_.size(); ++k)
    for (const glm::dvec3& way : way_[k].of_vertex) {
      const auto force = solved.force_on_objects.row(row++);
      if (k == object) sum += 1e-3 * force.dot(row_of(way));
    }
  return sum;
}

SolvedPose FemObjects::press(FemModel& model, const std::vector<RigidTransform>& pose, SolvedPose solved,
                             const SolveSettings& asked, double spacing, double weight_n, Progress& progress,
                             const std::function<void(const SolveStep&)>& on_step) {
  SolveSettings settings = asked;
  settings.tolerance_mm *= kTight;
  settings.has_weight_at_start = true;
  std::vector<double> place(objects_.size(), 0);
  for (std::size_t k = 0; k < objects_.size(); ++k) away_[k] = way_[k].clear_mm;
  // The solved flesh may reach further than when the clear distances were computed, so objects that cross the skin move
  // further away.
  for (int tries = 0; tries < kForceTries; ++tries) {
    const std::vector<std::int64_t> crossing = crossings(model, solved.V);
    for (std::size_t k = 0; k < crossing.size(); ++k) away_[k] += crossing[k] ? spacing : 0;
    if (std::all_of(crossing.begin(), crossing.end(), [](std::int64_t count) { return count == 0; })) break;
  }
  // The last shape in which no object presses too hard. Every further try starts from it, since a solve that starts
  // from squeezed flesh may get stuck.
  SolvedPose gentle = solved;
  std::vector<double> gentle_away = away_;
  solved = move(model, pose, solved, place, settings, spacing, progress, on_step);
  if (std::exchange(solved.reached, 1) < 1)
    solved.blocked_by = "an object stops short of its position: " + solved.blocked_by;
  for (std::size_t k = 0; k < objects_.size(); ++k)
    if (const double wanted = objects_[k].force_n + objects_[k].share_of_weight * weight_n; wanted > 0)
      asked_n_[k] = wanted;
  const auto is_off = [&](std::size_t k) {
    return asked_n_[k] && std::abs(pressing(solved, k) - *asked_n_[k]) > kForceTolerance * *asked_n_[k];
  };
  // Moving one object changes the forces of the others. So the objects' forces are searched again, in turn, until all
  // are right.
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t k = 0; k < objects_.size(); ++k) {
      ForceSearch search;
      for (int tries = 0; tries < kForceTries && is_off(k); ++tries) {
        const double wanted = *asked_n_[k], off = pressing(solved, k) - wanted;
        std::vector<double> next = away_;
        next[k] = std::max(search.next(away_[k], std::min(off, kMostOff * wanted)), -kDeepest);
        if (off < 0) {
          gentle = solved, gentle_away = away_;
        } else {
          gentle.steps = solved.steps, gentle.iterations = solved.iterations;
          gentle.factorizations = solved.factorizations, gentle.analyses = solved.analyses;
          gentle.repeated_in_double = solved.repeated_in_double;
          gentle.seconds = solved.seconds;
          solved = gentle, away_ = gentle_away;
        }
        const double before = away_[k];
        if (next[k] == before) break;
        solved = move(model, pose, solved, next, settings, spacing, progress, on_step);
        if (std::exchange(solved.reached, 1) < 1 && std::abs(away_[k] - before) < kStuck) break;
      }
    }
  for (std::size_t k = 0; k < objects_.size(); ++k)
    if (is_off(k)) {
      char text[200];
      std::snprintf(text, sizeof text, "%.60s presses with %.3g N instead of %.3g N: ", objects_[k].name.c_str(),
                    pressing(solved, k), *asked_n_[k]);
      solved.converged = false;
      solved.blocked_by =
          text + (solved.blocked_by.empty() ? "no position with this force was found" : solved.blocked_by);
    }
  return solved;
}

std::vector<PressedNode> FemObjects::pressed_nodes(const FemModel& model, const SolvedPose& solved) const {
  std::vector<PressedNode> pressed;
  if (solved.force_on_skin.rows() == 0) return pressed;
  std::vector<double> area(solved.V.rows(), 0);
  const Eigen::MatrixX3i skin = boundary_of(model.mesh);
  for (const auto& f : skin.rowwise()) {
    const Eigen::Vector3d a = solved.V.row(f[1]) - solved.V.row(f[0]), b = solved.V.row(f[2]) - solved.V.row(f[0]);
    for (const int v : f) area[v] += a.cross(b).norm() / 6;
  }
  for (Eigen::Index v = 0; v < solved.V.rows(); ++v) {
    const double force = solved.force_on_skin.row(v).norm();
    if (!(force > 0) || !(area[v] > 0)) continue;
    pressed.push_back({vec_of(solved.V.row(v)), force / area[v], area[v], solved.pressed_by[v]});
  }
  return pressed;
}

std::vector<std::int64_t> FemObjects::crossings(const FemModel& model, const Eigen::MatrixX3d& body) const {
  const Eigen::MatrixX3i skin = boundary_of(model.mesh);
  const NodePositions there = positions(away_);
  Eigen::MatrixX3d V(body.rows() + there.rows(), 3);
  V << body, there;
  Eigen::MatrixX3i F(skin.rows() + model.objects.F.rows(), 3);
  F << skin, model.objects.F.array() + int(body.rows());
  const auto object_of = [&](int face) {
    return face < skin.rows() ? -1 : model.objects.object[model.objects.F(face - skin.rows(), 0)];
  };
  std::vector<std::int64_t> count(objects_.size(), 0);
  for (const auto& [a, b] : crossing_pairs(V, F))
    if (const int one = object_of(a), other = object_of(b); (one < 0) != (other < 0)) ++count[std::max(one, other)];
  return count;
}

std::vector<ObjectReport> FemObjects::report(const FemModel& model, const SolvedPose& solved) const {
  std::vector<ObjectReport> reports;
  const Eigen::MatrixX3i skin = boundary_of(model.mesh);
  const NodePositions there = positions(away_);
  Eigen::MatrixX3d V(solved.V.rows() + there.rows(), 3);
  V << solved.V, there;
  Eigen::MatrixX3i F(skin.rows() + model.objects.F.rows(), 3);
  F << skin, model.objects.F.array() + int(solved.V.rows());
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    ObjectReport& report = reports.emplace_back();
    report.name = objects_[k].name;
    report.away_mm = away_[k];
    report.asked_n = asked_n_[k];
    if (solved.force_on_objects.rows()) report.pressing_n = pressing(solved, k);
    for (Eigen::Index v = 0; v < solved.force_on_objects.rows(); ++v)
      if (model.objects.object[v] == int(k)) report.force_n -= 1e-3 * vec_of(solved.force_on_objects.row(v));
  }
  for (const PressedNode& node : pressed_nodes(model, solved)) {
    ObjectReport& report = reports[node.object];
    report.area_mm2 += node.area_mm2;
    report.largest_kpa = std::max(report.largest_kpa, node.kpa);
  }
  const std::vector<std::int64_t> crossing = crossings(model, solved.V);
  for (std::size_t k = 0; k < reports.size(); ++k) reports[k].crossings = crossing[k];
  std::vector<double> gap(reports.size(), INFINITY);
  const std::vector<int> free(V.rows(), -1);
  for (const ContactPair& pair :
       ContactSurface(F, V, free).near(V, NodePositions::Zero(V.rows(), 3), 0, {.reach = kNearGap})) {
    int object = -1;
    bool has_skin = false;
    for (const int v : pair.node)
      if (v < solved.V.rows()) has_skin = true;
      else object = model.objects.object[v - solved.V.rows()];
    if (has_skin && object >= 0) gap[object] = std::min(gap[object], nearest_points(pair, V).distance);
  }
  for (std::size_t k = 0; k < reports.size(); ++k) reports[k].gap_mm = gap[k];
  return reports;
}

std::vector<double> node_masses(const TissueModel& model, const TissueTable& tissues) {
  std::vector<double> density(65536, 0), mass(model.fem.mesh.V.rows(), 0);
  for (const Tissue& tissue : tissues.tissues) density[tissue.label] = tissue.density;
  for (Eigen::Index t = 0; t < model.fem.mesh.T.rows(); ++t)
    for (std::int32_t i = model.first[t]; i < model.first[t + 1]; ++i) {
      const auto& [label, mm3] = model.parts[i];
      for (const int v : model.fem.mesh.T.row(t)) mass[v] += 1e-6 * density[label] * mm3 / 4;
    }
  return mass;
}

double weight_of(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues) {
  std::vector<double> density(65536, 0);
  for (const Tissue& each : tissues.tissues) density[each.label] = each.density;
  double sum = 0;
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) { sum += density[volume.at(v)]; });
  return 1e-6 * sum * volume.grid.voxel_volume() * kStandardGravity;
}

}  // namespace limber
