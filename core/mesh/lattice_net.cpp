// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/lattice_net.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "core/base/parallel.h"
#include "core/mesh/sample_lattice.h"

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;
constexpr double kMargin = 0.1;      // of a cell, face or edge: points keep this far from its ends
constexpr double kPushShare = 0.04;  // of a cell, outwards, for each time that voxels next to a point lay outside
constexpr int kPushes = 12;          // then samples become tissue
constexpr int kRounds = 90;

using Cell = SampleLattice::Cell;

// Region of the voxel at a place of the lattice, air beyond the grid.
class VoxelLookup {
 public:
  VoxelLookup(const VoxelRegions& voxels, const SampleLattice& lattice) : voxels_(voxels), offset_(lattice.fine_from_voxel.offset) {
    for (int i = 0; i < 3; ++i) scale_[i] = lattice.fine_from_voxel.linear[i][i];
  }
  std::uint16_t operator()(const glm::dvec3& fine) const {
    const glm::ivec3 v(glm::floor((fine - offset_) / scale_ + 0.5));
    if (!voxels_.grid.contains(v)) return kAir;
    const std::int64_t place = voxels_.tissue.index_of(v);
    return place < 0 ? kAir : voxels_.region[place];
  }
  // Fine steps along an axis of the lattice.
  double voxel_along(int axis) const { return scale_[axis]; }

 private:
  const VoxelRegions& voxels_;
  glm::dvec3 offset_, scale_;
};

// Where along an edge, in [0, 1], one region ends and the other begins. Between tissue and air: where the outermost tissue
// ends; between two tissues: where the fewest places are on the wrong side.
double border_along(const VoxelLookup& voxel_at, const glm::dvec3& from, int axis, int length, std::uint16_t first, std::uint16_t second) {
  const int steps = std::clamp(static_cast<int>(std::ceil(2 * length / voxel_at.voxel_along(axis))), 4, 64);
  int least_wrong = steps + 1, wrong = 0, best = 0;
  std::uint16_t seen[64];
  for (int k = 0; k < steps; ++k) {
    glm::dvec3 place = from;
    place[axis] += (k + 0.5) * length / steps;
    seen[k] = voxel_at(place);
  }
  if (second == kAir) {
    for (int k = 0; k < steps; ++k)
      if (seen[k] != kAir) best = k + 1;
    return double(best) / steps;
  }
  if (first == kAir) {
    best = steps;
    for (int k = steps; k-- > 0;)
      if (seen[k] != kAir) best = k;
    return double(best) / steps;
  }
  for (int k = 0; k < steps; ++k) wrong += seen[k] == first;
  for (int k = 0; k <= steps; ++k) {  // `first` ends before place k
    if (wrong < least_wrong) least_wrong = wrong, best = k;
    if (k < steps) wrong += (seen[k] == second) - (seen[k] == first);
  }
  return double(best) / steps;
}

// Where borders lie along edges, kept from round to round: looking them up takes longer than all the rest.
struct Borders {
  std::vector<float> share[3];  // of the edge along each axis from each sample; below 0 where nobody asked
  void forget() {
    for (auto& of_axis : share) std::fill(of_axis.begin(), of_axis.end(), -1.0f);
  }
};

struct Node {
  glm::dvec3 place, low, high;  // fine steps
};

// How often each point was pushed outwards.
struct Pushes {
  std::vector<std::uint8_t> cell, edge[3];  // the point in each cell, and that of the edge along each axis from each sample

  explicit Pushes(std::size_t samples) : cell(samples, 0) {
    for (auto& of_axis : edge) of_axis.assign(samples, 0);
  }
};

class Net {
 public:
  struct Edge {
    glm::ivec3 from;
    int axis, length, node;
    std::uint16_t first, second;
  };

  Net(const SampleLattice& lattice, const VoxelLookup& voxel_at, NetShape shape, const Pushes& pushes, Borders& borders)
      : lattice_(lattice), voxel_at_(voxel_at), shape_(shape), pushes_(pushes), borders_(borders) {
    cell_node_.assign(lattice.label.size(), -1);
    touches_air_.assign(lattice.label.size(), 0);
    for (auto& of_axis : edge_node_) of_axis.assign(lattice.label.size(), -1);
    place_edge_points();
    place_cell_points();
    place_face_points();
  }

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Edge>& edges() const { return edges_; }  // between two regions
  bool is_mixed(const Cell& cell) const { return cell_node_[lattice_.index(cell.corner)] >= 0; }

  // Of a mixed cell.
  const glm::dvec3& vertex(const Cell& cell) const { return nodes_[cell_node_[lattice_.index(cell.corner)]].place; }

  // The region of a place, and whether it is air; the latter is sooner known.
  std::uint16_t region_at(const glm::dvec3& place) const;
  bool is_air(const glm::dvec3& place) const {
    const Cell cell = cell_of(place);
    return touches_air_[lattice_.index(cell.corner)] ? region_at(place) == kAir : lattice_.at(cell.corner) == kAir;
  }

  // Triangles around every edge between two regions, facing the sample further along the axis.
  template <class Triangle>
  void for_each_triangle(const Triangle& triangle) const {
    for (const Edge& edge : edges_) {
      const auto around = lattice_.cells_around_edge(edge.from, edge.axis);
      for (int slot = 0; slot < 4; ++slot) {
        const Cell &one = around[slot], &other = around[(slot + 1) % 4];
        if (one == other) continue;
        const int a = cell_node_[lattice_.index(one.corner)], b = cell_node_[lattice_.index(other.corner)];
        if (one.size == other.size) {
          triangle(edge.node, a, b, edge);
        } else {
          const int middle = face_node_.at(face_between(edge, slot));
          triangle(edge.node, a, middle, edge);
          triangle(edge.node, middle, b, edge);
        }
      }
    }
  }

 private:
  Cell cell_of(const glm::dvec3& place) const { return lattice_.cell(glm::clamp(glm::ivec3(glm::floor(place)), glm::ivec3(0), lattice_.size - 2)); }
  void place_edge_points();
  void place_cell_points();
  void place_face_points();
  std::int64_t face_between(const Edge& edge, int slot) const;
  std::optional<glm::dvec3> middle_of_face(const Cell& cell, const Cell& other, const glm::ivec3& corner, int axis) const;
  std::uint16_t region_on_face(const glm::dvec3& middle, const glm::dvec3& place, const glm::ivec3& corner, int axis, int size) const;

  const SampleLattice& lattice_;
  const VoxelLookup& voxel_at_;
  const NetShape shape_;
  const Pushes& pushes_;
  Borders& borders_;
  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  std::vector<std::int32_t> cell_node_, edge_node_[3];
  std::vector<std::uint8_t> touches_air_;  // mixed cells with a border to air
  std::unordered_map<std::int64_t, int> face_node_;  // 3 index of the face's lowest sample + axis
};

void Net::place_edge_points() {
  const std::int64_t strides[3] = {1, lattice_.size.x, std::int64_t{lattice_.size.x} * lattice_.size.y};
  std::int64_t at = -1;
  glm::ivec3 from;
  for (from.z = 0; from.z < lattice_.size.z; ++from.z)
    for (from.y = 0; from.y < lattice_.size.y; ++from.y)
      for (from.x = 0; from.x < lattice_.size.x; ++from.x) {
        ++at;
        for (int axis = 0; axis < 3; ++axis) {
          // Most places are far from any border.
          const std::int64_t stride = strides[axis];
          if (from[axis] + 1 >= lattice_.size[axis]) continue;
          const bool far = lattice_.block == 2 && from[axis] + 2 < lattice_.size[axis];
          if (lattice_.label[at] == lattice_.label[at + stride] && (!far || lattice_.label[at] == lattice_.label[at + 2 * stride])) continue;
          const int length = lattice_.edge_length(from, axis);
          if (length == 0) continue;
          const std::uint16_t first = lattice_.label[at], second = lattice_.label[at + length * stride];
          if (first == second) continue;

          double share = 0.5;
          if (shape_ == NetShape::fitted) {
            float& known = borders_.share[axis][at];
            if (known < 0) known = static_cast<float>(border_along(voxel_at_, from, axis, length, first, second));
            share = known;
            if (second == kAir) share += kPushShare * pushes_.edge[axis][at];
            if (first == kAir) share -= kPushShare * pushes_.edge[axis][at];
          }
          Node node{from, from, from};
          node.low[axis] += kMargin * length;
          node.high[axis] += (1 - kMargin) * length;
          node.place[axis] = std::clamp(from[axis] + share * length, node.low[axis], node.high[axis]);
          edges_.push_back({from, axis, length, static_cast<int>(nodes_.size()), first, second});
          edge_node_[axis][at] = static_cast<int>(nodes_.size());
          nodes_.push_back(node);
        }
      }
}

void Net::place_cell_points() {
  struct Sum {
    glm::dvec3 place{0}, outwards{0};
    int count = 0;
  };
  std::vector<Sum> sums;
  std::vector<Cell> cells;
  const int first_cell = static_cast<int>(nodes_.size());
  for (const Edge& edge : edges_) {
    const auto around = lattice_.cells_around_edge(edge.from, edge.axis);
    for (int slot = 0; slot < 4; ++slot) {
      if (around[slot] == around[(slot + 3) % 4]) continue;  // a coarse cell has two slots
      int& node = cell_node_[lattice_.index(around[slot].corner)];
      if (node < 0) {
        node = static_cast<int>(nodes_.size());
        nodes_.push_back({});
        sums.push_back({});
        cells.push_back(around[slot]);
      }
      if (edge.first == kAir || edge.second == kAir) touches_air_[lattice_.index(around[slot].corner)] = 1;
      Sum& sum = sums[node - first_cell];
      sum.place += nodes_[edge.node].place;
      if (edge.second == kAir) sum.outwards[edge.axis] += 1;
      if (edge.first == kAir) sum.outwards[edge.axis] -= 1;
      ++sum.count;
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const glm::dvec3 corner(cells[i].corner);
    const double size = cells[i].size;
    Node& node = nodes_[first_cell + i];
    node.low = corner + kMargin * size;
    node.high = corner + (1 - kMargin) * size;
    node.place = corner + 0.5 * size;
    if (shape_ == NetShape::plain) continue;
    node.place = sums[i].place / double(sums[i].count);
    const double length = glm::length(sums[i].outwards);
    if (length > 0) node.place += sums[i].outwards * (kPushShare * size * pushes_.cell[lattice_.index(cells[i].corner)] / length);
    node.place = glm::clamp(node.place, node.low, node.high);
  }
}

// The face between the cells of a slot around an edge and the next one: that of the smaller cell.
std::int64_t Net::face_between(const Edge& edge, int slot) const {
  // Slots lie at (-,-), (+,-), (+,+), (-,+) of the other two axes: the faces between them at -v, +u, +v, -u.
  const int u = (edge.axis + 1) % 3, v = (edge.axis + 2) % 3;
  glm::ivec3 corner = edge.from;
  if (slot == 0) --corner[v];
  if (slot == 3) --corner[u];
  return 3 * lattice_.index(corner) + (slot % 2 == 0 ? u : v);
}

void Net::place_face_points() {
  struct Sum {
    glm::dvec3 place;
    int count, axis;
  };
  std::vector<Sum> sums;
  const int first_face = static_cast<int>(nodes_.size());
  for (const Edge& edge : edges_) {
    if (edge.length != 1 || lattice_.block == 1) continue;
    const auto around = lattice_.cells_around_edge(edge.from, edge.axis);
    for (int slot = 0; slot < 4; ++slot) {
      if (around[slot].size == around[(slot + 1) % 4].size) continue;
      const std::int64_t face = face_between(edge, slot);
      const auto [at, is_new] = face_node_.emplace(face, first_face + static_cast<int>(sums.size()));
      if (is_new) sums.push_back({glm::dvec3(0), 0, static_cast<int>(face % 3)});
      sums[at->second - first_face].place += nodes_[edge.node].place;
      ++sums[at->second - first_face].count;
    }
  }
  nodes_.resize(nodes_.size() + sums.size());
  for (const auto& [face, number] : face_node_) {
    const Sum& sum = sums[number - first_face];
    const std::int64_t at = face / 3;
    const glm::dvec3 corner(at % lattice_.size.x, at / lattice_.size.x % lattice_.size.y, at / (std::int64_t{lattice_.size.x} * lattice_.size.y));
    Node& node = nodes_[number];
    node.low = corner + kMargin, node.high = corner + (1 - kMargin);
    node.low[sum.axis] = node.high[sum.axis] = corner[sum.axis];
    node.place = shape_ == NetShape::plain ? (node.low + node.high) * 0.5 : glm::clamp(sum.place / double(sum.count), node.low, node.high);
  }
}

// Where the surface passes the face of a cell, nothing where it does not.
std::optional<glm::dvec3> Net::middle_of_face(const Cell& cell, const Cell& other, const glm::ivec3& corner, int axis) const {
  if (cell.size != other.size) {
    const auto node = face_node_.find(3 * lattice_.index(corner) + axis);
    if (node == face_node_.end()) return std::nullopt;
    return nodes_[node->second].place;
  }
  if (!is_mixed(other)) return std::nullopt;
  const glm::dvec3 &a = vertex(cell), &b = vertex(other);
  return a + (b - a) * ((corner[axis] - a[axis]) / (b[axis] - a[axis]));
}

// On a face the borders run from its middle to the points of its edges: the region is that of the rim, seen from the middle.
std::uint16_t Net::region_on_face(const glm::dvec3& middle, const glm::dvec3& place, const glm::ivec3& corner, int axis, int size) const {
  const glm::dvec3 along = place - middle;
  double reach = 1e300;
  int rim_axis = (axis + 1) % 3;
  for (int w : {(axis + 1) % 3, (axis + 2) % 3}) {
    if (along[w] == 0) continue;
    const double to = ((along[w] > 0 ? corner[w] + size : corner[w]) - middle[w]) / along[w];
    if (to < reach) reach = to, rim_axis = w;
  }
  glm::ivec3 from = corner;
  if (along[rim_axis] > 0) from[rim_axis] += size;
  const int w = 3 - axis - rim_axis;  // the rim's own direction
  const double at = reach < 1e300 ? middle[w] + along[w] * reach : middle[w];
  int length = size;
  if (size > 1 && lattice_.edge_length(from, w) == 1) {
    length = 1;
    from[w] += std::clamp(static_cast<int>(std::floor(at)) - corner[w], 0, size - 1);
  }
  const int node = edge_node_[w][lattice_.index(from)];
  if (node < 0 || at < nodes_[node].place[w]) return lattice_.at(from);
  from[w] += length;
  return lattice_.at(from);
}

std::uint16_t Net::region_at(const glm::dvec3& place) const {
  const Cell cell = cell_of(place);
  if (!is_mixed(cell)) return lattice_.at(cell.corner);
  // From the cell's vertex through the place to a face.
  const glm::dvec3& from = vertex(cell);
  const glm::dvec3 along = place - from;
  double reach = 1e300;
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    if (along[i] == 0) continue;
    const double to = ((along[i] > 0 ? cell.corner[i] + cell.size : cell.corner[i]) - from[i]) / along[i];
    if (to < reach) reach = to, axis = i;
  }
  if (reach == 1e300) return lattice_.at(cell.corner);
  const glm::dvec3 exit = from + along * reach;
  const bool high = along[axis] > 0;

  glm::ivec3 corner = cell.corner, across = cell.corner;
  if (high) corner[axis] += cell.size, across[axis] += cell.size;
  else --across[axis];
  int size = cell.size;
  if (cell.size > 1)
    for (int w : {(axis + 1) % 3, (axis + 2) % 3}) across[w] += std::clamp(static_cast<int>(std::floor(exit[w])) - cell.corner[w], 0, cell.size - 1);
  const Cell other = lattice_.cell(across);
  if (other.size < cell.size) {
    size = other.size;
    for (int w : {(axis + 1) % 3, (axis + 2) % 3}) corner[w] = across[w];
  }
  const auto middle = middle_of_face(cell, other, corner, axis);
  if (!middle) return lattice_.at(corner);
  return region_on_face(*middle, exit, corner, axis, size);
}

// Which voxels lie outside; of those known to lie inside before, only when all are asked for.
void find_outside(const Net& net, const SampleLattice& lattice, const TissueVoxels& tissue, bool all, std::vector<std::uint8_t>& outside) {
  parallel_for(std::ssize(tissue.bricks()), 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b) {
      const TissueVoxels::Brick& brick = tissue.bricks()[b];
      const auto first = outside.begin() + brick.first;
      if (!all && std::find(first, first + brick.count(), 1) == first + brick.count()) continue;
      tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
        if (all || outside[place]) outside[place] = net.is_air(lattice.fine_from_voxel * glm::dvec3(v));
      });
    }
  });
}

struct Missed {
  Cell cell;
  glm::dvec3 sum{0};  // of the places of its voxels outside
  int count = 0;
  glm::dvec3 place() const { return sum / double(count); }
};

// The cells with voxels outside, those with most of them first.
std::vector<Missed> cells_that_miss(const SampleLattice& lattice, const TissueVoxels& tissue, const std::vector<std::uint8_t>& outside) {
  std::unordered_map<std::int64_t, std::size_t> place_of;
  std::vector<Missed> missed;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (!outside[place]) return;
    const glm::dvec3 at = lattice.fine_from_voxel * glm::dvec3(v);
    const Cell cell = lattice.cell(glm::ivec3(glm::floor(at)));
    const auto [known, is_new] = place_of.emplace(lattice.index(cell.corner), missed.size());
    if (is_new) missed.push_back({cell});
    missed[known->second].sum += at;
    ++missed[known->second].count;
  });
  std::stable_sort(missed.begin(), missed.end(), [](const Missed& a, const Missed& b) { return a.count > b.count; });
  return missed;
}

// Of each cell that misses voxels, the edge between tissue and air whose point lies nearest to them; null where there is none.
std::vector<const Net::Edge*> nearest_edges(const Net& net, const SampleLattice& lattice, const std::vector<Missed>& missed) {
  std::unordered_map<std::int64_t, std::size_t> place_of;
  for (std::size_t m = 0; m < missed.size(); ++m) place_of[lattice.index(missed[m].cell.corner)] = m;
  std::vector<const Net::Edge*> nearest(missed.size(), nullptr);
  for (const Net::Edge& edge : net.edges()) {
    if (edge.first != kAir && edge.second != kAir) continue;
    for (const Cell& cell : lattice.cells_around_edge(edge.from, edge.axis)) {
      const auto found = place_of.find(lattice.index(cell.corner));
      if (found == place_of.end()) continue;
      const auto far = [&](const Net::Edge& from) { return glm::distance(net.nodes()[from.node].place, missed[found->second].place()); };
      const Net::Edge*& best = nearest[found->second];
      if (!best || far(edge) < far(*best)) best = &edge;
    }
  }
  return nearest;
}

// Pushes the point next to the voxels that a cell misses, or else the other one: what is further away need not give way, so
// that the surface stays close to the voxels. Late rounds are in a hurry and push both. False where none can be pushed any more.
bool push(const Net& net, const SampleLattice& lattice, const Missed& miss, const Net::Edge* edge, int round, Pushes& pushes) {
  if (!net.is_mixed(miss.cell)) return false;
  std::uint8_t none = kPushes;
  std::uint8_t& of_cell = pushes.cell[lattice.index(miss.cell.corner)];
  std::uint8_t& of_edge = edge ? pushes.edge[edge->axis][lattice.index(edge->from)] : none;
  const bool cell_first = !edge || glm::distance(miss.place(), net.vertex(miss.cell)) < glm::distance(miss.place(), net.nodes()[edge->node].place);
  std::uint8_t &first = cell_first ? of_cell : of_edge, &second = cell_first ? of_edge : of_cell;
  const bool first_can = first < kPushes, pushes_second = second < kPushes && (!first_can || round >= kRounds / 2);
  first += first_can;
  second += pushes_second;
  return first_can || pushes_second;
}

// Makes room for `to_gain` of the voxels outside, where most are: points are pushed outwards, or samples become tissue.
// Returns whether samples did.
bool make_room(const Net& net, SampleLattice& lattice, const std::vector<Missed>& missed, std::int64_t to_gain, NetShape shape, int round,
               Pushes& pushes) {
  bool any_became = false;
  const auto become_tissue = [&](const glm::ivec3& p) {
    std::uint16_t& label = lattice.label[lattice.index(p)];
    const bool was_air = label == kAir;
    if (was_air) label = TetMesh::kSoft, any_became = true;
    return was_air;
  };
  const auto nearest = nearest_edges(net, lattice, missed);
  for (std::size_t m = 0; m < missed.size() && to_gain > 0; ++m) {
    const Missed& miss = missed[m];
    const Cell& cell = miss.cell;
    to_gain -= miss.count;
    if (shape == NetShape::fitted && round < kRounds * 3 / 4 && push(net, lattice, miss, nearest[m], round, pushes)) continue;
    const glm::dvec3 inside = miss.place() - glm::dvec3(cell.corner);
    const bool nearest_was_air = become_tissue(cell.corner + glm::ivec3(glm::greaterThan(inside, glm::dvec3(0.5 * cell.size))) * cell.size);
    if (nearest_was_air && round < kRounds / 2) continue;
    for (int z = 0; z <= cell.size; ++z)
      for (int y = 0; y <= cell.size; ++y)
        for (int x = 0; x <= cell.size; ++x)
          if (lattice.has_sample(cell.corner + glm::ivec3(x, y, z))) become_tissue(cell.corner + glm::ivec3(x, y, z));
  }
  return any_became;
}

LatticeNet finished(const Net& net, const SampleLattice& lattice, const AffineTransform& world_from_lattice) {
  LatticeNet result;
  result.world_from_lattice = world_from_lattice;
  const auto count = static_cast<Eigen::Index>(net.nodes().size());
  result.surface.V.resize(count, 3), result.low.resize(count, 3), result.high.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Node& node = net.nodes()[i];
    const glm::dvec3 world = world_from_lattice * (node.place * lattice.step), low = node.low * lattice.step, high = node.high * lattice.step;
    result.surface.V.row(i) << world.x, world.y, world.z;
    result.low.row(i) << low.x, low.y, low.z;
    result.high.row(i) << high.x, high.y, high.z;
  }
  std::vector<Eigen::RowVector3i> triangles;
  const bool mirrored = glm::determinant(world_from_lattice.linear) < 0;
  net.for_each_triangle([&](int a, int b, int c, const Net::Edge& edge) {
    if (mirrored) std::swap(b, c);
    triangles.push_back({a, b, c});
    result.surface.sides.push_back({edge.second, edge.first});
  });
  result.surface.F.resize(triangles.size(), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) result.surface.F.row(i) = triangles[i];
  return result;
}

}  // namespace

LatticeNet lattice_net(const VoxelRegions& voxels, const LatticeNetSettings& settings, Progress& progress) {
  LatticeNet result;
  if (voxels.tissue.size() == 0) return result;
  progress.update("surface", 0);
  SampleLattice lattice = sample_regions(voxels, settings);
  const VoxelLookup voxel_at(voxels, lattice);
  Pushes pushes(lattice.label.size());
  Borders borders;
  for (auto& of_axis : borders.share) of_axis.assign(lattice.label.size(), -1.0f);
  const auto allowed = static_cast<std::int64_t>((1 - settings.least_covered) * double(voxels.tissue.size()));
  std::vector<std::uint8_t> outside(voxels.tissue.size(), 0);
  for (int round = 0;; ++round) {
    progress.update("surface", 1 - 1 / (1 + 0.3 * (round + 1)));
    const Net net(lattice, voxel_at, settings.shape, pushes, borders);
    find_outside(net, lattice, voxels.tissue, round == 0, outside);
    auto missed = std::count(outside.begin(), outside.end(), 1);
    if (missed <= allowed && round > 0) {  // a point that moved may have left others outside
      find_outside(net, lattice, voxels.tissue, true, outside);
      missed = std::count(outside.begin(), outside.end(), 1);
    }
    if (missed <= allowed || round == kRounds) {
      result = finished(net, lattice, lattice.world_from_lattice);
      result.spacing_mm = lattice.step * lattice.block;
      result.covered = 1 - double(missed) / double(voxels.tissue.size());
      return result;
    }
    if (make_room(net, lattice, cells_that_miss(lattice, voxels.tissue, outside), missed - allowed, settings.shape, round, pushes)) borders.forget();
  }
}

}  // namespace limber
