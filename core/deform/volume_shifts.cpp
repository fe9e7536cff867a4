// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/volume_shifts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/base/parallel.h"
#include "core/volume/float_lanes.h"

namespace limber {

namespace {

constexpr double kVolume = 100;  // weight of the cells' volumes, relative to the smoothness of the shifts
constexpr double kReach = 10;    // distance over which a shift fades out, in cell edges
// The solve aims at determinants of the cells' deformation gradients between kLeast and 1 / kLeast.
constexpr double kLeast = 0.2;
constexpr double kBone = 1e4;  // weight that keeps bone in place, relative to the smoothness of the shifts
// The solve aims at no larger stretch of a cell than this, unless blending alone has stretched the cell further.
constexpr double kStretch = 2;
// Stiffness of the springs that pull a node out of bone (kPush) and out of other flesh (kPart), for a node with eight
// full cells of tissue around it; with less tissue the stiffness is proportionally lower. kPart is lower because flesh
// also gives way: a spring as stiff as kPush would tear small pieces out of a limb that is folded onto another.
constexpr double kPush = 500, kPart = 40;
// Longer shifts that pull flesh out of other flesh are shortened to this, in cell edges. Otherwise flesh without free
// space would move further in each step and overlap more and more.
constexpr double kMostApart = 2;
constexpr double kMostlySoft = 0.2;  // a node with less bone around it than this counts as soft; in cell volumes
constexpr int kLook = 2;             // number of steps between searches for flesh inside other flesh
// Number of steps. For a sitting body with voxels of 4 mm, the mean volume error of its cells is 2.6, 0.9 and 0.8 %
// after 5, 10 and 15 steps.
constexpr int kSteps = 14;
constexpr int kSolves = 10;  // iterations of conjugate gradients per step
constexpr int kGrain = 2048;

using Nodes = std::array<std::int32_t, 8>;

// Returns the gradients of the trilinear shape functions in the centre of a cell, 1 / mm.
std::array<glm::dvec3, 8> middle_gradients(const glm::dvec3& edge) {
  std::array<glm::dvec3, 8> gradients;
  for (int i = 0; i < 8; ++i) gradients[i] = glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1) / (4.0 * edge);
  return gradients;
}

// Returns the matrix of |grad c|^2, integrated over a full cell and divided by the cell's volume; 1 / mm2.
std::array<std::array<double, 8>, 8> smoothness(const glm::dvec3& edge) {
  std::array<std::array<double, 8>, 8> K{};
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b)
      for (int axis = 0; axis < 3; ++axis) {
        double share = 1;
        for (int other = 0; other < 3; ++other) {
          const bool same = (a >> other & 1) == (b >> other & 1);
          share *= other == axis ? (same ? 1 : -1) / (edge[axis] * edge[axis]) : same ? 1.0 / 3 : 1.0 / 6;
        }
        K[a][b] += share;
      }
  return K;
}

// Returns the volume of a trilinear cell, computed from its six faces. For each face, the mean of its two splits into
// triangles is used.
double volume_of(const std::array<glm::dvec3, 8>& corner) {
  constexpr int kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  const auto cone = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::dot(a, glm::cross(b, c));
  };
  double sum = 0;
  for (const auto& side : kSides) {
    const glm::dvec3 a = corner[side[0]] - corner[0], b = corner[side[1]] - corner[0], c = corner[side[2]] - corner[0],
                     d = corner[side[3]] - corner[0];
    sum += cone(a, b, c) + cone(a, c, d) + cone(a, b, d) + cone(b, c, d);
  }
  return sum / 12;
}

glm::dmat3 cofactor(const glm::dmat3& F) {
  return glm::dmat3(glm::cross(F[1], F[2]), glm::cross(F[2], F[0]), glm::cross(F[0], F[1]));
}

Eigen::Matrix3d squared(const glm::dmat3& F) {
  Eigen::Matrix3d C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = glm::dot(F[i], F[j]);
  return C;
}

// Returns the largest stretch of a deformation gradient, which is its largest singular value.
double longest_of(const glm::dmat3& F) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(squared(F), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
}

// The cells around each node, and the node's index among the eight nodes of each of these cells.
struct CellsOfNode {
  std::vector<std::int64_t> begin;
  std::vector<std::int32_t> place;  // entries of all nodes: 8 * cell + index of the node in the cell

  explicit CellsOfNode(const FleshCells& cells) : begin(cells.rest.size() + 1), place(8 * cells.nodes.size()) {
    for (const Nodes& nodes : cells.nodes)
      for (const std::int32_t n : nodes) ++begin[n + 1];
    for (std::size_t n = 0; n + 1 < begin.size(); ++n) begin[n + 1] += begin[n];
    std::vector<std::int64_t> end(begin.begin(), begin.end() - 1);
    for (std::size_t c = 0; c < cells.nodes.size(); ++c)
      for (int i = 0; i < 8; ++i) place[end[cells.nodes[c][i]]++] = static_cast<std::int32_t>(8 * c) + i;
  }
};

FourFloats four(const glm::vec3& v) { return FourFloats{v.x, v.y, v.z, 0}; }
glm::vec3 three(const FourFloats& v) { return {v[0], v[1], v[2]}; }

class Minimizer {
 public:
  Minimizer(const FleshCells& cells, const PosedBones* bones, FleshContact* contact)
      : cells_(cells),
        bones_(bones),
        contact_(contact),
        of_node_(cells),
        gradients_(middle_gradients(cells.edge)),
        h2_(std::pow(cells.edge.x * cells.edge.y * cells.edge.z, 2.0 / 3)),
        count_(std::ssize(cells.rest)) {
    start_.resize(cells.nodes.size());
    pull_.resize(cells.nodes.size());
    shift_.assign(count_, glm::vec3(0));
    last_ = outward_ = apart_ = shift_;
    is_inside_.assign(count_, 0);
    push_.assign(count_, 0);
    for (auto* each : {&right_, &residual_, &image_}) each->assign(count_, glm::vec3(0));
    direction_.resize(count_);
    parallel_for(std::ssize(cells.nodes), kGrain, [&](std::int64_t first, std::int64_t last) {
      for (auto c = first; c < last; ++c)
        start_[c] = glm::mat3(gradient(c, [&](std::int32_t n) { return cells_.blended[n]; }));
    });
    assemble();
  }

  const std::vector<glm::vec3>& shift() const { return shift_; }

  // Returns the mean volume error |V / V0 - 1| over the tissue of all cells.
  double error() const {
    double fill = 0;
    for (const float each : cells_.fill) fill += each;
    if (fill == 0) return 0;
    return parallel_sum(std::ssize(cells_.nodes), kGrain,
                        [&](std::int64_t first, std::int64_t last) {
                          double sum = 0;
                          for (auto c = first; c < last; ++c) sum += cells_.fill[c] * std::abs(volume_ratio(c) - 1);
                          return sum;
                        }) /
           fill;
  }

  void step() {
    leave_bones();
    part_flesh();
    parallel_for(std::ssize(cells_.nodes), kGrain, [&](std::int64_t first, std::int64_t last) {
      for (auto c = first; c < last; ++c) {
        const glm::dmat3 F = posed_gradient(c);
        const double wanted = glm::determinant(F) + 1 - volume_ratio(c);
        const double volume = std::clamp(wanted, kLeast, 1 / kLeast);
        const glm::dmat3 start(start_[c]);
        const glm::dmat3 P = with_stretch(with_volume(F, volume), volume, start);
        pull_[c] = glm::mat3((P - start) * (kVolume * h2_ * cells_.fill[c]));
      }
    });
    parallel_for(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
      for (auto n = first; n < last; ++n) {
        glm::vec3 sum(0);
        if (!cells_.is_fixed[n])
          for (auto i = of_node_.begin[n]; i < of_node_.begin[n + 1]; ++i)
            sum += pull_[of_node_.place[i] >> 3] * glm::vec3(gradients_[of_node_.place[i] & 7]);
        right_[n] = sum + outward_[n] * push_[n];
      }
    });
    solve();
    run_on();
  }

 private:
  template <class Place>
  glm::dmat3 gradient(std::int64_t cell, const Place& place) const {
    glm::dmat3 F(0);
    for (int i = 0; i < 8; ++i) F += glm::outerProduct(glm::dvec3(place(cells_.nodes[cell][i])), gradients_[i]);
    return F;
  }
  glm::dmat3 posed_gradient(std::int64_t cell) const {
    return glm::dmat3(start_[cell]) + gradient(cell, [&](std::int32_t n) { return glm::dvec3(shift_[n]); });
  }

  // Returns the ratio of the whole cell's posed volume to its rest volume. (The determinant of the deformation gradient
  // is the ratio at the cell's centre only.)
  double volume_ratio(std::int64_t cell) const {
    std::array<glm::dvec3, 8> corner;
    for (int i = 0; i < 8; ++i)
      corner[i] = cells_.blended[cells_.nodes[cell][i]] + glm::dvec3(shift_[cells_.nodes[cell][i]]);
    return volume_of(corner) / (cells_.edge.x * cells_.edge.y * cells_.edge.z);
  }

  void assemble() {
    const auto smooth = smoothness(cells_.edge);
    std::array<std::array<double, 8>, 8> K;
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) K[a][b] = h2_ * (smooth[a][b] + kVolume * glm::dot(gradients_[a], gradients_[b]));
    const double reach = 1 / (kReach * kReach);
    // A row of the matrix has up to 27 entries, one per neighbouring node, or more if unconnected cells at the same
    // position share a node.
    std::vector<std::vector<std::pair<std::int32_t, float>>> blocks((count_ + kGrain - 1) / kGrain);
    row_.assign(count_ + 1, 0);
    diagonal_.assign(count_, 1);
    parallel_for(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
      auto& block = blocks[first / kGrain];
      for (auto n = first; n < last; ++n) {
        if (cells_.is_fixed[n]) continue;
        const auto begin = std::ssize(block);
        double own = kBone * cells_.bone[n];
        for (auto i = of_node_.begin[n]; i < of_node_.begin[n + 1]; ++i) {
          const std::int32_t cell = of_node_.place[i] >> 3;
          const int a = of_node_.place[i] & 7;
          own += cells_.fill[cell] * (K[a][a] + reach / 8);
          for (int b = 0; b < 8; ++b) {
            const std::int32_t column = cells_.nodes[cell][b];
            if (b == a || cells_.is_fixed[column]) continue;
            auto at = std::find_if(block.begin() + begin, block.end(),
                                   [&](const auto& each) { return each.first == column; });
            if (at == block.end()) at = block.insert(at, {column, 0.0f});
            at->second += static_cast<float>(cells_.fill[cell] * K[a][b]);
          }
        }
        diagonal_[n] = static_cast<float>(own);
        row_[n + 1] = std::ssize(block) - begin;
      }
    });
    for (std::int64_t n = 0; n < count_; ++n) row_[n + 1] += row_[n];
    column_.reserve(row_.back());
    entry_.reserve(row_.back());
    for (const auto& block : blocks)
      for (const auto& [column, entry] : block) column_.push_back(column), entry_.push_back(entry);
  }

  // Returns the product of row n of the matrix with the vector x.
  template <class Vector>
  Vector times(std::int64_t n, const std::vector<Vector>& x) const {
    Vector sum = diagonal_[n] * x[n];
    for (auto i = row_[n]; i < row_[n + 1]; ++i) sum += entry_[i] * x[column_[i]];
    return sum;
  }

  // Attaches springs to soft nodes inside a bone, which pull the nodes to the bone's surface.
  void leave_bones() {
    if (!bones_) return;
    parallel_for(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
      for (auto n = first; n < last; ++n) {
        diagonal_[n] -= push_[n];
        push_[n] = 0;
        if (!cells_.is_fixed[n] && cells_.bone[n] < kMostlySoft)
          if (const auto way = bones_->way_out(cells_.blended[n] + glm::dvec3(shift_[n]))) {
            push_[n] = strength(kPush, n);
            outward_[n] = shift_[n] + glm::vec3(*way);
          }
        diagonal_[n] += push_[n];
      }
    });
  }

  // Returns the stiffness of the spring on a node. It is proportional to the tissue around the node, since a small
  // piece of flesh would otherwise be pulled as strongly as full cells.
  //   full  stiffness if all cells around the node are full of tissue
  float strength(double full, std::int64_t node) const {
    double fill = 0;
    for (auto i = of_node_.begin[node]; i < of_node_.begin[node + 1]; ++i) fill += cells_.fill[of_node_.place[i] >> 3];
    return static_cast<float>(full * std::min(1.0, fill / 8));
  }

  // Attaches springs to nodes inside other flesh, which pull the nodes half of the way out of it.
  void part_flesh() {
    if (!contact_) return;
    if (taken_ % kLook == 0) {
      std::vector<glm::dvec3> posed(count_);
      for (std::int64_t n = 0; n < count_; ++n) posed[n] = cells_.blended[n] + glm::dvec3(shift_[n]);
      contact_->look(posed);
      parallel_for(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
        for (auto n = first; n < last; ++n) {
          const auto way = cells_.is_fixed[n] ? std::nullopt : contact_->way_apart(static_cast<std::int32_t>(n));
          is_inside_[n] = way.has_value();
          if (!way) continue;
          apart_[n] = shift_[n] + glm::vec3(*way);
          const float far = glm::length(apart_[n]), most = static_cast<float>(kMostApart * std::sqrt(h2_));
          if (far > most) apart_[n] *= most / far;
        }
      });
    }
    for (std::int64_t n = 0; n < count_; ++n)
      if (is_inside_[n] && push_[n] == 0) {
        push_[n] = strength(kPart, n);
        outward_[n] = apart_[n];
        diagonal_[n] += push_[n];
      }
  }

  // Extrapolates the shifts along the last step. The next step starts from the extrapolated shifts (momentum) [Beck &
  // Teboulle 2009, A fast iterative shrinkage-thresholding algorithm for linear inverse problems].
  void run_on() {
    ++taken_;
    const float momentum = float(taken_ - 1) / float(taken_ + 2);
    parallel_for(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
      for (auto n = first; n < last; ++n) {
        const glm::vec3 here = shift_[n];
        if (taken_ < kSteps) shift_[n] += momentum * (here - last_[n]);
        last_[n] = here;
      }
    });
  }

  // Solves for the shifts by conjugate gradients, starting from the current shifts.
  void solve() {
    double rho = sum([&](std::int64_t n) {
      residual_[n] = right_[n] - times(n, shift_);
      const glm::vec3 scaled = residual_[n] / diagonal_[n];
      direction_[n] = four(scaled);
      return dot(residual_[n], scaled);
    });
    for (int k = 0; k < kSolves && rho > 0; ++k) {
      const double curvature = sum([&](std::int64_t n) {
        image_[n] = three(times(n, direction_));
        return dot(image_[n], three(direction_[n]));
      });
      if (!(curvature > 0)) return;
      const auto alpha = static_cast<float>(rho / curvature);
      const double next = sum([&](std::int64_t n) {
        shift_[n] += alpha * three(direction_[n]);
        residual_[n] -= alpha * image_[n];
        return dot(residual_[n], residual_[n] / diagonal_[n]);
      });
      const auto beta = static_cast<float>(next / rho);
      rho = next;
      parallel_for(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
        for (auto n = first; n < last; ++n) direction_[n] = four(residual_[n] / diagonal_[n]) + beta * direction_[n];
      });
    }
  }

  static double dot(const glm::vec3& a, const glm::vec3& b) { return glm::dot(glm::dvec3(a), glm::dvec3(b)); }

  // Sums term(node) over all nodes, in the same order for any number of threads.
  template <class Term>
  double sum(const Term& term) const {
    return parallel_sum(count_, kGrain, [&](std::int64_t first, std::int64_t last) {
      double part = 0;
      for (auto n = first; n < last; ++n) part += term(n);
      return part;
    });
  }

  const FleshCells& cells_;
  const PosedBones* bones_;
  FleshContact* contact_;
  const CellsOfNode of_node_;
  const std::array<glm::dvec3, 8> gradients_;
  const double h2_;  // squared edge length of a cube with a cell's volume, mm2
  const std::int64_t count_;
  int taken_ = 0;
  // For each cell, the deformation gradient after blending, and kVolume h^2 fill (P - that gradient), by which the
  // cell's volume enters the right-hand side (settled_flesh.h).
  std::vector<glm::mat3> start_, pull_;
  // For each node, the current shift and the shift that the last solve found; and of the linear system, the right-hand
  // side, the residual, and the product of the matrix with the search direction.
  std::vector<glm::vec3> shift_, last_, right_, residual_, image_;
  // Search direction of each node. It is padded to four floats, which load faster, since this array is read most often.
  std::vector<FourFloats> direction_;
  std::vector<std::int64_t> row_;
  std::vector<std::int32_t> column_;
  std::vector<float> entry_, diagonal_;
  std::vector<float> push_;  // stiffness of the spring that pulls each node out of bone or flesh; 0: no spring
  std::vector<std::uint8_t> is_inside_;  // 1 for each node inside other flesh
  std::vector<glm::vec3> apart_;         // shift that moves each node inside other flesh half of the way out, mm
  std::vector<glm::vec3> outward_;       // shift towards which the spring on each node pulls it, mm
};

}  // namespace

glm::dmat3 with_volume(const glm::dmat3& F, double volume) {
  constexpr int kMost = 6;
  constexpr double kNear = 1e-3, kLongest = 0.5;
  glm::dmat3 P = F;
  for (int k = 0; k < kMost; ++k) {
    const double off = volume - glm::determinant(P);
    if (std::abs(off) < kNear) break;
    const glm::dmat3 slope = cofactor(P);
    const double steep = glm::dot(slope[0], slope[0]) + glm::dot(slope[1], slope[1]) + glm::dot(slope[2], slope[2]);
    const double step = off / std::max(steep, 1e-3), longest = kLongest / std::sqrt(std::max(steep, 1e-12));
    P += slope * std::clamp(step, -longest, longest);
  }
  return P;
}

glm::dmat3 with_stretch(const glm::dmat3& F, double volume, const glm::dmat3& blended) {
  if (glm::dot(F[0], F[0]) + glm::dot(F[1], F[1]) + glm::dot(F[2], F[2]) <= kStretch * kStretch) return F;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(squared(F));
  const Eigen::Vector3d have = solver.eigenvalues().cwiseMax(1e-12).cwiseSqrt();
  if (have[2] <= kStretch) return F;
  const double most = std::max(kStretch, longest_of(blended));
  if (have[2] <= most) return F;
  const double area = volume / most;  // product of the other two stretches
  Eigen::Vector3d wanted;
  wanted[2] = most;
  wanted[1] = std::min(have[1] * std::sqrt(area / std::max(have[0] * have[1], 1e-9)), most);
  wanted[0] = std::min(area / wanted[1], most);
  const Eigen::Matrix3d along = solver.eigenvectors();
  const Eigen::Matrix3d S = along * wanted.cwiseQuotient(have).asDiagonal() * along.transpose();
  glm::dmat3 limited(0);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) limited[j] += F[i] * S(i, j);
  return limited;
}

VolumeShifts volume_shifts(const FleshCells& cells, const PosedBones* bones, FleshContact* contact,
                           Progress& progress) {
  VolumeShifts found;
  if (cells.nodes.empty()) return found;
  Minimizer minimizer(cells, bones, contact);
  found.error_before = minimizer.error();
  for (int k = 0; k < kSteps; ++k) {
    progress.update("flesh", double(k) / kSteps);
    minimizer.step();
  }
  found.error_after = minimizer.error();
  found.shift = minimizer.shift();
  return found;
}

}  // namespace limber
