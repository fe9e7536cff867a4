// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_net.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;
// A point stays at least this far from the borders of its cell, face or edge, as a share of their size.
constexpr double kMargin = 0.1;
// Distance by which one push moves a point outwards, as a share of the size of its cell or edge.
constexpr double kPushShare = 0.04;

// Returns the position along an edge, in [0, 1], of the border between two regions. Between tissue and air this is the
// end of the outermost tissue. Between two tissues, this is the position with the fewest samples on the wrong side.
double border_along(const VoxelLookup& voxel_at, const glm::dvec3& from, int axis, int length, std::uint16_t first,
                    std::uint16_t second) {
  const int steps = std::clamp(static_cast<int>(std::ceil(2 * length / voxel_at.voxel_along(axis))), 4, 64);
  int least_wrong = steps + 1, wrong = 0, best = 0;
  std::uint16_t seen[64];
  voxel_at.along(from, axis, length, steps, seen);
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
  for (int k = 0; k <= steps; ++k) {  // tests the border before sample k
    if (wrong < least_wrong) least_wrong = wrong, best = k;
    if (k < steps) wrong += (seen[k] == second) - (seen[k] == first);
  }
  return double(best) / steps;
}

}  // namespace

VoxelLookup::VoxelLookup(const VoxelRegions& voxels, const SampleLattice& lattice)
    : voxels_(voxels),
      offset_(lattice.fine_from_voxel.offset) {
  for (int i = 0; i < 3; ++i) scale_[i] = lattice.fine_from_voxel.linear[i][i];
}

void VoxelLookup::along(const glm::dvec3& from, int axis, int length, int count, std::uint16_t* regions) const {
  glm::ivec3 v(glm::floor((from - offset_) / scale_ + 0.5));
  for (int k = 0; k < count; ++k) {
    v[axis] = int(std::floor((from[axis] + (k + 0.5) * length / count - offset_[axis]) / scale_[axis] + 0.5));
    const std::int64_t place = voxels_.grid.contains(v) ? voxels_.tissue.index_of(v) : -1;
    regions[k] = place < 0 ? kAir : voxels_.region[place];
  }
}

Pushes::Pushes(std::size_t samples) : cell(samples, 0) {
  for (auto& of_axis : edge) of_axis.assign(samples, 0);
}

SurfaceNet::SurfaceNet(const SampleLattice& lattice, const VoxelLookup& voxel_at) : lattice_(lattice) {
  number_edges(&voxel_at);
  number_cells();
  number_faces();
  find_air();
  start_at_borders();
  shift_to_skin(voxel_at);
  fitted_.reserve(nodes_.size());
  for (const Node& node : nodes_) fitted_.push_back(node.place);
}

SurfaceNet::SurfaceNet(const SampleLattice& voxels) : lattice_(voxels) {
  number_edges(nullptr);
  number_cells();
}

// Calls body(from, at, axis, length, first, second) for each lattice edge with tissue at one or both ends. `at` is the
// index of the edge's first sample; `first` and `second` are the regions at its two ends.
template <class Body>
void SurfaceNet::for_each_edge(const Body& body) const {
  const std::int64_t strides[3] = {1, lattice_.size.x, std::int64_t{lattice_.size.x} * lattice_.size.y};
  std::int64_t at = -1;
  glm::ivec3 from;
  for (from.z = 0; from.z < lattice_.size.z; ++from.z)
    for (from.y = 0; from.y < lattice_.size.y; ++from.y)
      for (from.x = 0; from.x < lattice_.size.x; ++from.x) {
        ++at;
        for (int axis = 0; axis < 3; ++axis) {
          const std::int64_t stride = strides[axis];
          const std::uint16_t first = lattice_.label[at];
          // Skips edges in air early, since most samples are air. Cells near air are never larger than the usual size,
          // so no edge that begins there is longer.
          if (first == kAir) {
            const int reach = std::min(lattice_.usual, lattice_.size[axis] - 1 - from[axis]);
            bool is_air = true;
            for (int k = 1; k <= reach; ++k) is_air = is_air && lattice_.label[at + k * stride] == kAir;
            if (is_air) continue;
          }
          const int length = lattice_.edge_length(from, axis);
          if (length == 0) continue;
          const std::uint16_t second = lattice_.label[at + length * stride];
          if (first != kAir || second != kAir) body(from, at, axis, length, first, second);
        }
      }
}

// Gives a node to each lattice edge between two regions, at the border between them; null: in the middle of the edge.
void SurfaceNet::number_edges(const VoxelLookup* voxel_at) {
  for (auto& of_axis : edge_node_) of_axis.assign(lattice_.label.size(), -1);
  for_each_edge(
      [&](const glm::ivec3& from, std::int64_t at, int axis, int length, std::uint16_t first, std::uint16_t second) {
        if (first == second && !(length == 1 && lattice_.is_cut(from, axis))) return;
        Node node{from, from, from};
        node.low[axis] += kMargin * length;
        node.high[axis] += (1 - kMargin) * length;
        const double border = voxel_at ? border_along(*voxel_at, from, axis, length, first, second) : 0.5;
        node.place[axis] += border * length;
        const int number = static_cast<int>(nodes_.size());
        edge_node_[axis][at] = number;
        nodes_.push_back(node);
        edges_.push_back({from, axis, length, number, first, second, static_cast<float>(border), {}, {-1, -1, -1, -1}});
      });
}

void SurfaceNet::number_cells() {
  cell_node_.assign(lattice_.label.size(), -1);
  for (Edge& edge : edges_) {
    const auto around = lattice_.cells_around_edge(edge.from, edge.axis);
    for (int slot = 0; slot < 4; ++slot) {
      const Cell& cell = around[slot];
      const std::int64_t at = lattice_.index(cell.corner);
      int& node = cell_node_[at];
      if (node < 0) {
        node = static_cast<int>(nodes_.size());
        const glm::dvec3 corner(cell.corner);
        nodes_.push_back({corner + 0.5 * cell.size, corner + kMargin * cell.size, corner + (1 - kMargin) * cell.size});
        cells_.push_back(cell);
      }
      edge.cell[slot] = node;
    }
  }
}

// Returns the key in face_node_ of a face at a lattice edge: the face between the cell in `slot` and the cell in the
// next slot around the edge. The face belongs to the smaller of the two cells, whose edge is `size`.
std::int64_t SurfaceNet::face_between(const glm::ivec3& from, int axis, int slot, int size) const {
  // Slots 0 to 3 are at (-,-), (+,-), (+,+), (-,+) along the other two axes u and v. The faces after slots 0 to 3 are
  // at -v, +u, +v, -u.
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  glm::ivec3 corner = from;
  if (slot == 0) corner[v] -= size;
  if (slot == 3) corner[u] -= size;
  return 3 * lattice_.index(corner) + (slot % 2 == 0 ? u : v);
}

glm::ivec3 SurfaceNet::sample_at(std::int64_t index) const {
  return {index % lattice_.size.x, index / lattice_.size.x % lattice_.size.y,
          index / (std::int64_t{lattice_.size.x} * lattice_.size.y)};
}

void SurfaceNet::number_faces() {
  if (lattice_.usual == 1) return;  // the surface passes through cells of one size only
  for (Edge& edge : edges_) {
    const auto around = lattice_.cells_around_edge(edge.from, edge.axis);
    for (int slot = 0; slot < 4; ++slot) {
      if (around[slot].size == around[(slot + 1) % 4].size) continue;
      const std::int64_t face = face_between(edge.from, edge.axis, slot, edge.length);
      const auto [known, is_new] = face_node_.emplace(face, static_cast<int>(nodes_.size()));
      if (is_new) {
        const glm::dvec3 corner(sample_at(face / 3));
        Node node{corner + 0.5 * edge.length, corner + kMargin * edge.length, corner + (1 - kMargin) * edge.length};
        const int axis = static_cast<int>(face % 3);
        node.place[axis] = node.low[axis] = node.high[axis] = corner[axis];
        nodes_.push_back(node);
      }
      edge.face[slot] = known->second;
    }
  }
}

void SurfaceNet::find_air() {
  std::vector<std::uint8_t> touches_air(nodes_.size(), 0);
  for (const Edge& edge : edges_)
    if (edge.first == kAir || edge.second == kAir)
      for (const int cell : edge.cell) touches_air[cell] = 1;
  holds_.assign(lattice_.label.size(), Holds::air);
  glm::ivec3 smallest;
  for (smallest.z = 0; smallest.z + 1 < lattice_.size.z; ++smallest.z)
    for (smallest.y = 0; smallest.y + 1 < lattice_.size.y; ++smallest.y)
      for (smallest.x = 0; smallest.x + 1 < lattice_.size.x; ++smallest.x) {
        const Cell cell = lattice_.cell(smallest);
        const int node = node_of(cell);
        if (node >= 0 && touches_air[node]) holds_[lattice_.index(smallest)] = Holds::both;
        else if (lattice_.at(cell.corner) != kAir) holds_[lattice_.index(smallest)] = Holds::tissue;
      }
}

void SurfaceNet::start_at_borders() {
  struct Sum {
    glm::dvec3 place{0};
    int count = 0;
  };
  const int first_cell = static_cast<int>(edges_.size());
  std::vector<Sum> sums(nodes_.size() - edges_.size());
  const auto meet = [&](int node, const Edge& edge) {
    sums[node - first_cell].place += nodes_[edge.node].place;
    ++sums[node - first_cell].count;
  };
  for (const Edge& edge : edges_) {
    Node& node = nodes_[edge.node];
    node.place[edge.axis] =
        std::clamp(edge.from[edge.axis] + double(edge.border) * edge.length, node.low[edge.axis], node.high[edge.axis]);
    for (int slot = 0; slot < 4; ++slot) {
      if (edge.cell[slot] != edge.cell[(slot + 3) % 4])
        meet(edge.cell[slot], edge);  // a larger cell fills two slots, but counts once
      if (edge.face[slot] >= 0) meet(edge.face[slot], edge);
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    Node& node = nodes_[first_cell + i];
    node.place = glm::clamp(sums[i].place / double(sums[i].count), node.low, node.high);
  }
}

namespace {

// Returns the distance along `outwards` from a position to the nearest border between tissue and air, in lattice steps;
// negative if the position is in air. Returns nothing if no border is closer than `reach`.
std::optional<double> distance_to_skin(const VoxelLookup& voxel_at, const glm::dvec3& place, const glm::dvec3& outwards,
                                       double reach) {
  const double step = 0.5 * voxel_at.shortest_voxel();
  const bool is_air = voxel_at.is_air(place);
  const double side = is_air ? -1 : 1;
  for (double far = step; far < reach; far += step)
    if (voxel_at.is_air(place + side * far * outwards) != is_air) return side * (far - 0.5 * step);
  return std::nullopt;
}

// Returns the shift of a node by which it moves `distance` along `normal`. Along axes in which the node's box has no
// width, the node does not move; if the normal is nearly along such axes, it moves less far.
glm::dvec3 shift_in_box(const SurfaceNet::Node& node, const glm::dvec3& normal, double distance) {
  // If the part of the unit normal along the movable axes is shorter than this, the node moves less than the distance.
  constexpr double kSteepest = 0.3;
  glm::dvec3 along = normal;
  for (int i = 0; i < 3; ++i)
    if (node.low[i] == node.high[i]) along[i] = 0;
  const double length = glm::length(along);
  return length > 0 ? along * (distance / length / std::max(length, kSteepest)) : glm::dvec3(0);
}

}  // namespace

void SurfaceNet::shift_to_skin(const VoxelLookup& voxel_at) {
  constexpr int kRounds = 6;
  constexpr double kReach = 0.5;  // share of a cell's size; a border further away belongs to another part of the body
  struct Fit {
    glm::dvec3 normal{0};  // sum of the triangles' normals; the length of each is twice the triangle's area
    double gap = 0, weight = 0;
  };
  std::vector<Fit> fits;
  for (int round = 0; round < kRounds; ++round) {
    fits.assign(nodes_.size(), {});
    for_each_triangle([&](int a, int b, int c, const Edge& edge) {
      if (edge.first != kAir && edge.second != kAir) return;
      const std::array<int, 3> corner = edge.second == kAir ? std::array{a, b, c} : std::array{a, c, b};
      const glm::dvec3 &p = nodes_[corner[0]].place, &q = nodes_[corner[1]].place, &r = nodes_[corner[2]].place;
      const glm::dvec3 normal = glm::cross(q - p, r - p);
      const double area = glm::length(normal);
      for (const int node : corner) fits[node].normal += normal;
      if (area == 0) return;
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 sample = (p + q + r + 3.0 * nodes_[corner[i]].place) / 6.0;
        const auto gap = distance_to_skin(voxel_at, sample, normal / area, kReach * edge.length);
        if (!gap) continue;
        for (int k = 0; k < 3; ++k) {
          const double weight = area * (k == i ? 4 : 1);
          fits[corner[k]].gap += weight * *gap;
          fits[corner[k]].weight += weight;
        }
      }
    });
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const double length = glm::length(fits[i].normal);
      if (length == 0 || fits[i].weight == 0) continue;
      Node& node = nodes_[i];
      node.place = glm::clamp(node.place + shift_in_box(node, fits[i].normal / length, fits[i].gap / fits[i].weight),
                              node.low, node.high);
    }
  }
}

void SurfaceNet::place(const Pushes& pushes) {
  const std::size_t first_cell = edges_.size();
  std::vector<glm::dvec3> outwards(cells_.size(), glm::dvec3(0));
  for (const Edge& edge : edges_) {
    const double side = (edge.second == kAir) - (edge.first == kAir);
    Node& node = nodes_[edge.node];
    node.place = fitted_[edge.node];
    node.place[edge.axis] += side * kPushShare * edge.length * pushes.edge[edge.axis][lattice_.index(edge.from)];
    node.place = glm::clamp(node.place, node.low, node.high);
    for (int slot = 0; slot < 4; ++slot)
      if (edge.cell[slot] != edge.cell[(slot + 3) % 4]) outwards[edge.cell[slot] - first_cell][edge.axis] += side;
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Node& node = nodes_[first_cell + i];
    node.place = fitted_[first_cell + i];
    if (const double length = glm::length(outwards[i]); length > 0)
      node.place +=
          outwards[i] * (kPushShare * cells_[i].size * pushes.cell[lattice_.index(cells_[i].corner)] / length);
    node.place = glm::clamp(node.place, node.low, node.high);
  }
}

// Returns the point where the surface crosses the face between two cells: on the line between the two cells' vertices
// or, if the cells differ in size, at the face's own node. Returns nothing if the surface does not cross the face.
std::optional<glm::dvec3> SurfaceNet::middle_of_face(const Cell& cell, const Cell& other, const glm::ivec3& corner,
                                                     int axis) const {
  if (cell.size != other.size) {
    const auto node = face_node_.find(3 * lattice_.index(corner) + axis);
    if (node == face_node_.end()) return std::nullopt;
    return nodes_[node->second].place;
  }
  if (node_of(other) < 0) return std::nullopt;
  const glm::dvec3 &a = nodes_[node_of(cell)].place, &b = nodes_[node_of(other)].place;
  return a + (b - a) * ((corner[axis] - a[axis]) / (b[axis] - a[axis]));
}

// Returns the region at a position on a face. The borders between regions run across the face from its middle to the
// points on its edges. So the region is the one at the point where the ray from the middle through the position meets
// the face's edge.
std::uint16_t SurfaceNet::region_on_face(const glm::dvec3& middle, const glm::dvec3& place, const glm::ivec3& corner,
                                         int axis, int size) const {
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
  const int w = 3 - axis - rim_axis;  // axis along the side of the face's rim that the ray crosses
  const double at = reach < 1e300 ? middle[w] + along[w] * reach : middle[w];
  const int length = size > 1
                         ? lattice_.edge_length(from, w)
                         : 1;  // length of the rim's side, or of its first half if the neighbouring cell is smaller
  if (length < size && at >= from[w] + length) from[w] += length;
  const int node = edge_node_[w][lattice_.index(from)];
  if (node < 0 || at < nodes_[node].place[w]) return lattice_.at(from);
  from[w] += length;
  return lattice_.at(from);
}

std::uint16_t SurfaceNet::region_at(const glm::dvec3& place) const {
  const Cell cell = lattice_.cell(smallest_at(place));
  if (node_of(cell) < 0) return lattice_.at(cell.corner);
  // Finds the face where the ray from the cell's vertex through the position leaves the cell. The region there is the
  // region at the position.
  const glm::dvec3& from = nodes_[node_of(cell)].place;
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
    for (int w : {(axis + 1) % 3, (axis + 2) % 3})
      across[w] += std::clamp(static_cast<int>(std::floor(exit[w])) - cell.corner[w], 0, cell.size - 1);
  const Cell other = lattice_.cell(across);
  if (other.size < cell.size) {
    size = other.size;
    for (int w : {(axis + 1) % 3, (axis + 2) % 3}) corner[w] = other.corner[w];
  }
  const auto middle = middle_of_face(cell, other, corner, axis);
  if (!middle) return lattice_.at(corner);
  return region_on_face(*middle, exit, corner, axis, size);
}

TetMesh SurfaceNet::tets() const {
  std::vector<glm::dvec3> places;
  places.reserve(3 * nodes_.size());
  for (const Node& node : nodes_) places.push_back(node.place);
  std::vector<std::int32_t> sample_node(lattice_.label.size(), -1), cell_node = cell_node_;
  auto face_node = face_node_;
  const auto number = [&](std::int32_t& node, const glm::dvec3& place) {
    if (node < 0) node = static_cast<std::int32_t>(places.size()), places.push_back(place);
    return node;
  };
  const auto of_cell = [&](const Cell& cell) {
    return number(cell_node[lattice_.index(cell.corner)], glm::dvec3(cell.corner) + 0.5 * cell.size);
  };
  const auto of_face = [&](std::int64_t face, int size) {
    glm::dvec3 middle = glm::dvec3(sample_at(face / 3)) + 0.5 * size;
    middle[int(face % 3)] -= 0.5 * size;
    return number(face_node.try_emplace(face, -1).first->second, middle);
  };

  TetMesh mesh;
  std::vector<std::array<int, 4>> tets;
  const bool mirrored = glm::determinant(lattice_.world_from_lattice.linear) < 0;
  const auto add = [&](int from, int to, int a, int b, std::uint16_t region) {
    if (mirrored) std::swap(a, b);
    tets.push_back({from, to, a, b});
    mesh.region.push_back(region);
  };
  for_each_edge(
      [&](const glm::ivec3& from, std::int64_t at, int axis, int length, std::uint16_t first, std::uint16_t second) {
        glm::ivec3 to = from;
        to[axis] += length;
        const int point = edge_node_[axis][at];
        const int begin = first == kAir ? -1 : number(sample_node[at], from),
                  end = second == kAir ? -1 : number(sample_node[lattice_.index(to)], to);
        const auto stand = [&](int a, int b) {
          if (point < 0) return add(begin, end, a, b, first);
          if (first != kAir) add(begin, point, a, b, first);
          if (second != kAir) add(point, end, a, b, second);
        };
        const auto around = lattice_.cells_around_edge(from, axis);
        for (int slot = 0; slot < 4; ++slot) {
          const Cell &one = around[slot], &other = around[(slot + 1) % 4];
          if (one == other) continue;
          const int a = of_cell(one), b = of_cell(other);
          if (one.size == other.size) {
            stand(a, b);
          } else {
            const int middle = of_face(face_between(from, axis, slot, length), length);
            stand(a, middle);
            stand(middle, b);
          }
        }
      });

  mesh.V.resize(places.size(), 3);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const glm::dvec3 world = lattice_.world_from_lattice * (places[i] * lattice_.step);
    mesh.V.row(i) << world.x, world.y, world.z;
  }
  mesh.T.resize(tets.size(), 4);
  for (std::size_t i = 0; i < tets.size(); ++i) mesh.T.row(i) << tets[i][0], tets[i][1], tets[i][2], tets[i][3];
  return mesh;
}

}  // namespace limber
