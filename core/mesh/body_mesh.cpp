// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/body_mesh.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include <Eigen/Dense>

#include "core/base/error.h"
#include "core/mesh/split_at_seams.h"
#include "core/mesh/surface_net.h"

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;
constexpr int kRounds = 40;  // upper limit on the steps of Newton's method
// Newton's method ends when the volume of every label differs from its wanted volume by less than this share of it.
constexpr double kVolumeError = 2e-4;
constexpr double kLongestMove = 0.25;  // upper limit on the movement of a node along an axis in one step, voxels
constexpr int kMostLabels = 4000;

struct Triangle {
  std::array<int, 3> node;
  int behind, front;  // indices of the labels on its two sides; -1: air
};

// The nodes of the net, with the volumes of the labels as functions of their positions. Lengths are in voxels.
class Shape {
 public:
  Shape(const SurfaceNet& net, const std::vector<double>& wanted) : net_(net) {
    for (const auto& node : net.nodes()) {
      place_.push_back(node.place);
      held_.push_back({node.low.x == node.high.x, node.low.y == node.high.y, node.low.z == node.high.z});
    }
    std::unordered_map<std::uint16_t, int> index;
    const auto index_of = [&](std::uint16_t label) {
      if (label == kAir) return -1;
      const auto [known, is_new] = index.emplace(label, static_cast<int>(labels_.size()));
      if (is_new) labels_.push_back(label), wanted_.push_back(wanted[label]);
      return known->second;
    };
    net.for_each_triangle([&](int a, int b, int c, const SurfaceNet::Edge& edge) {
      const int behind = index_of(edge.first), front = index_of(edge.second);
      if (behind != front) triangles_.push_back({{a, b, c}, behind, front});
    });
  }

  const std::vector<glm::dvec3>& places() const { return place_; }
  const std::vector<std::uint16_t>& labels() const { return labels_; }

  // Smooths the surfaces by one step. First moves the node of each lattice cell to the mean of the nodes on the lattice
  // edges around the cell. Then moves each node on a lattice edge along this edge, to the mean coordinate of the nodes
  // of the cells around the edge.
  void smooth() {
    const auto& edges = net_.edges();
    std::vector<glm::dvec3> sum(place_.size(), glm::dvec3(0));
    std::vector<int> count(place_.size(), 0);
    for (const auto& edge : edges)
      for (const int cell : edge.cell) sum[cell] += place_[edge.node], ++count[cell];
    for (std::size_t v = 0; v < place_.size(); ++v)
      if (count[v] > 0) put(v, sum[v] / double(count[v]));
    for (const auto& edge : edges) {
      double along = 0;
      for (const int cell : edge.cell) along += place_[cell][edge.axis] / 4;
      glm::dvec3 place = place_[edge.node];
      place[edge.axis] = along;
      put(edge.node, place);
    }
  }

  // Returns the wanted volume minus the present volume of each label, voxels.
  Eigen::VectorXd missing() const {
    Eigen::VectorXd volume = Eigen::VectorXd::Zero(std::ssize(labels_));
    for (const Triangle& t : triangles_) {
      const double voxels = glm::dot(place_[t.node[0]], glm::cross(place_[t.node[1]], place_[t.node[2]])) / 6;
      if (t.behind >= 0) volume[t.behind] += voxels;
      if (t.front >= 0) volume[t.front] -= voxels;
    }
    return Eigen::Map<const Eigen::VectorXd>(wanted_.data(), std::ssize(wanted_)) - volume;
  }

  // Returns the largest error of a label's volume, as a share of its wanted volume, and sets `label` to that label.
  double worst(const Eigen::VectorXd& missing, std::uint16_t& label) const {
    double most = 0;
    for (Eigen::Index i = 0; i < missing.size(); ++i)
      if (const double share = std::abs(missing[i]) / wanted_[i]; share > most) most = share, label = labels_[i];
    return most;
  }

  // Moves the nodes so that the volumes of the labels grow by `missing` to first order, with the smallest sum of
  // squared movements. A node at the border of its box moves only if the move leads into the box.
  void correct(const Eigen::VectorXd& missing) {
    gather_gradients();
    const Eigen::Index n = missing.size();
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t v = 0; v < place_.size(); ++v)
      for (int i = first_[v]; i < first_[v + 1]; ++i)
        for (int j = first_[v]; j < first_[v + 1]; ++j)
          for (int axis = 0; axis < 3; ++axis)
            if (!held_[v][axis])
              products(gradient_[i].label, gradient_[j].label) += gradient_[i].of[axis] * gradient_[j].of[axis];
    products.diagonal().array() += 1e-3;
    const Eigen::VectorXd factor = products.ldlt().solve(missing);
    for (std::size_t v = 0; v < place_.size(); ++v) {
      glm::dvec3 move(0);
      for (int i = first_[v]; i < first_[v + 1]; ++i) move += factor[gradient_[i].label] * gradient_[i].of;
      move = glm::clamp(move, -kLongestMove, kLongestMove);
      const auto& node = net_.nodes()[v];
      for (int axis = 0; axis < 3; ++axis) {
        double& at = place_[v][axis];
        const double low = node.low[axis], high = node.high[axis];
        if (low == high) continue;
        const double to = std::clamp(at + move[axis], low, high);
        if (!held_[v][axis]) at = to;
        held_[v][axis] = (to == low && move[axis] < 0) || (to == high && move[axis] > 0);
      }
    }
  }

 private:
  struct Gradient {
    int label;
    glm::dvec3 of;  // derivative of the label's volume by the node's position
  };

  void put(std::size_t v, const glm::dvec3& place) {
    place_[v] = glm::clamp(place, net_.nodes()[v].low, net_.nodes()[v].high);
  }
  void gather_gradients() {
    if (first_.empty()) number_gradients();
    for (Gradient& gradient : gradient_) gradient.of = glm::dvec3(0);
    const auto add = [&](int v, int label, const glm::dvec3& slope) {
      if (label < 0) return;
      for (int i = first_[v]; i < first_[v + 1]; ++i)
        if (gradient_[i].label == label) gradient_[i].of += slope;
    };
    for (const Triangle& t : triangles_)
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 slope = glm::cross(place_[t.node[(i + 1) % 3]] - place_[t.node[i]],
                                            place_[t.node[(i + 2) % 3]] - place_[t.node[i]]) /
                                 6.0;
        add(t.node[i], t.behind, slope);
        add(t.node[i], t.front, -slope);
      }
  }
  // Finds the labels whose volumes depend on each node.
  void number_gradients() {
    std::vector<std::array<int, 8>> labels(place_.size());
    std::vector<std::uint8_t> count(place_.size(), 0);
    for (const Triangle& t : triangles_)
      for (const int v : t.node)
        for (const int label : {t.behind, t.front}) {
          if (label < 0) continue;
          const auto end = labels[v].begin() + count[v];
          if (std::find(labels[v].begin(), end, label) == end) labels[v][count[v]++] = label;
        }
    first_.assign(place_.size() + 1, 0);
    for (std::size_t v = 0; v < place_.size(); ++v) {
      for (int i = 0; i < count[v]; ++i) gradient_.push_back({labels[v][i], glm::dvec3(0)});
      first_[v + 1] = static_cast<int>(gradient_.size());
    }
  }

  const SurfaceNet& net_;
  std::vector<glm::dvec3> place_;
  std::vector<glm::bvec3> held_;  // for each node, the axes along which it does not move at present
  std::vector<Triangle> triangles_;
  std::vector<std::uint16_t> labels_;
  std::vector<double> wanted_;  // volume of each label, voxels
  std::vector<int> first_;      // #nodes + 1: index in gradient_ of each node's first label
  std::vector<Gradient> gradient_;
};

// Returns the volume that the tets of each label must get, in voxels.
//   given  wanted volume of each label, mm3; empty: each label gets the volume of its voxels
std::vector<double> wanted_volumes(const LabelVolume& volume, const TissueVoxels& tissue,
                                   const std::vector<double>& given) {
  std::vector<double> wanted(65536, 0);
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) { ++wanted[volume.at(v)]; });
  if (given.empty()) return wanted;
  for (std::size_t label = 0; label < wanted.size(); ++label)
    if (wanted[label] > 0) wanted[label] = given[label] / volume.grid.voxel_volume();
  return wanted;
}

void check_size(const TissueVoxels& tissue, const LabelVolume& volume) {
  if (tissue.size() == 0) throw Error("the volume has no tissue to mesh", "VOLUME", "give a volume with labels");
  glm::ivec3 low = volume.grid.size, high(-1);
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) { low = glm::min(low, v), high = glm::max(high, v); });
  const glm::dvec3 size = glm::dvec3(high - low) + 7.0;
  const double samples = size.x * size.y * size.z;
  if (samples <= double(kMostMeshSamples)) return;
  const double spacing = std::cbrt(volume.grid.voxel_volume() * samples / double(kMostMeshSamples));
  throw Error("the body has too many voxels to be meshed at their own size", std::to_string(tissue.size()) + " voxels",
              "mesh the body at a spacing of " + std::to_string(int(std::ceil(spacing))) + " mm or more");
}

}  // namespace

BodyMesh mesh_body(const LabelVolume& volume, const TissueVoxels& tissue, const BodyMeshSettings& settings,
                   Progress& progress) {
  check_size(tissue, volume);
  progress.update("meshing the body", 0);
  std::vector<std::uint16_t> region(tissue.size());
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { region[place] = volume.at(v); });
  const SampleLattice lattice = sample_voxels({volume.grid, tissue, region});
  const SurfaceNet net(lattice);
  progress.update("meshing the body", 0.2);

  Shape shape(net, wanted_volumes(volume, tissue, settings.volumes));
  if (std::ssize(shape.labels()) > kMostLabels)
    throw Error("the volume has too many labels to be meshed", std::to_string(shape.labels().size()) + " labels",
                "merge labels (limber prepare --merge)");
  for (int i = 0; i < settings.relaxations; ++i) shape.smooth();
  BodyMesh body;
  for (int round = 0;; ++round) {
    progress.update("meshing the body", 0.3 + 0.4 * round / kRounds);
    const Eigen::VectorXd missing = shape.missing();
    body.largest_volume_error = shape.worst(missing, body.worst_label);
    if (body.largest_volume_error < kVolumeError || round == kRounds) break;
    shape.correct(missing);
  }

  body.mesh = net.tets();
  progress.update("meshing the body", 0.8);
  // The net's nodes come first. Of the other nodes, those at whole coordinates are the centres of voxels, also in large
  // cells.
  body.voxel_corner.resize(body.mesh.T.rows());
  for (Eigen::Index t = 0; t < body.mesh.T.rows(); ++t)
    for (int i = 0; i < 4; ++i) {
      const auto place = body.mesh.V.row(body.mesh.T(t, i));
      if ((place.array() == place.array().round()).all() && body.mesh.T(t, i) >= std::ssize(shape.places()))
        body.voxel_corner[t] = static_cast<std::uint8_t>(i);
    }
  const AffineTransform to_world = world_from_voxel(volume.grid);
  for (std::size_t v = 0; v < shape.places().size(); ++v)
    body.mesh.V.row(v) << shape.places()[v].x, shape.places()[v].y, shape.places()[v].z;
  for (Eigen::Index v = 0; v < body.mesh.V.rows(); ++v) {
    const glm::dvec3 voxel(body.mesh.V(v, 0), body.mesh.V(v, 1), body.mesh.V(v, 2));
    const glm::dvec3 world = to_world * (voxel + glm::dvec3(lattice.first_voxel));
    body.mesh.V.row(v) << world.x, world.y, world.z;
  }
  if (glm::determinant(to_world.linear) < 0) {
    body.mesh.T.col(2).swap(body.mesh.T.col(3));
    for (std::uint8_t& corner : body.voxel_corner)
      if (corner >= 2) corner = static_cast<std::uint8_t>(5 - corner);
  }
  if (lattice.seams) body.at_seam = split_at_seams(body.mesh, lattice, net);
  progress.update("meshing the body", 1);
  return body;
}

}  // namespace limber
