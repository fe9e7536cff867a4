// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/label_surfaces.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>

namespace limber {

namespace {
// Smoothing keeps a vertex within this distance of its cube's centre along each axis, voxels.
constexpr double kFurthest = 0.4;
// Step lengths of one smoothing step: first towards the mean of the neighbours, then slightly further back, since the
// body would shrink otherwise [Taubin, SIGGRAPH 1995]. The pass band is 0.1.
constexpr double kSteps[2] = {0.5, -0.5 / (1 - 0.5 * 0.1)};

struct Quad {
  std::array<int, 4> corner;  // vertices around the quad's two voxels, counter-clockwise seen from `above`
  // Index of the extra vertex in the middle of the edge from corner i to the next corner; -1: none. An edge gets this
  // vertex if four faces of one tissue's surface would share it (a non-manifold edge).
  std::array<int, 4> middle;
  Label below, above;  // labels of the quad's two voxels
  std::int64_t voxel;  // index of the voxel below, in the grid with a border of air
  int axis;            // axis from the voxel below to the voxel above
};

// The labels of a volume, surrounded by a border of air one voxel wide.
struct Bordered {
  explicit Bordered(const LabelVolume& volume)
      : size(volume.grid.size + 2),
        labels(std::int64_t{size.x} * size.y * size.z, Label{0}) {
    for (int z = 0; z < volume.grid.size.z; ++z)
      for (int y = 0; y < volume.grid.size.y; ++y) {
        const auto row = volume.voxels.begin() + volume.grid.index({0, y, z});
        std::copy(row, row + volume.grid.size.x, labels.begin() + index(glm::ivec3(0, y, z) + 1));
      }
    step = {1, size.x, std::int64_t{size.x} * size.y};
  }
  std::int64_t index(const glm::ivec3& v) const {
    return v.x + std::int64_t{size.x} * (v.y + std::int64_t{size.y} * v.z);
  }

  glm::ivec3 size;
  std::vector<Label> labels;
  std::array<std::int64_t, 3> step;
};

// Returns true if the surface of one tissue passes an edge of the net twice. a, b, c, d are the labels of the four
// voxels around that edge. The surface passes it twice if the tissue fills two diagonally opposite voxels and neither
// of the others.
bool passes_twice(Label a, Label b, Label c, Label d) {
  return (a == c && a != 0 && b != a && d != a) || (b == d && b != 0 && a != b && c != b);
}

class Net {
 public:
  Net(const LabelVolume& volume, Progress& progress) : volume_(volume), body_(volume) { build(progress); }

  void relax(int times);
  LabelSurfaces surfaces();

 private:
  void build(Progress& progress);
  bool is_mixed(std::int64_t cube, bool& junction) const;
  void add_quad(const std::array<int, 4>& corner, std::int64_t voxel, int axis,
                const std::array<std::int64_t, 4>& sides);
  void triangulate(const Quad& quad, int number);
  LabelSurface surface_of(Label label, const std::vector<int>& triangles) const;

  struct Triangle {
    glm::ivec3 corner;
    int quad;
  };
  // Of the two voxels beside the triangle, returns the index of the voxel that has the label.
  std::int64_t voxel_of(const Triangle& triangle, Label label) const {
    const Quad& quad = quads_[triangle.quad];
    return quad.below == label ? quad.voxel : quad.voxel + body_.step[quad.axis];
  }

  const LabelVolume& volume_;
  Bordered body_;
  std::vector<glm::dvec3> middle_;  // centre of each vertex's cube, voxel coordinates of the volume
  std::vector<glm::dvec3> offset_;  // offset of each vertex from the centre of its cube, voxels
  std::vector<std::uint8_t> junction_;
  std::vector<Quad> quads_;
  std::map<std::array<int, 2>, int> middles_;  // number of an edge's middle vertex, by the edge's two vertices
  std::vector<Triangle> triangles_;
  std::vector<glm::dvec3> extra_;  // middle vertices of edges, then centre vertices of quads; voxel coordinates
};

bool Net::is_mixed(std::int64_t cube, bool& junction) const {
  Label seen[2] = {body_.labels[cube], body_.labels[cube]};
  bool mixed = false;
  junction = false;
  for (int corner = 1; corner < 8; ++corner) {
    const Label label = body_.labels[cube + (corner & 1) * body_.step[0] + (corner >> 1 & 1) * body_.step[1] +
                                     (corner >> 2) * body_.step[2]];
    if (label == seen[0]) continue;
    junction = junction || (mixed && label != seen[1]);
    if (!mixed) seen[1] = label;
    mixed = true;
  }
  return mixed;
}

void Net::add_quad(const std::array<int, 4>& corner, std::int64_t voxel, int axis,
                   const std::array<std::int64_t, 4>& sides) {
  const std::int64_t up = body_.step[axis];
  Quad quad{corner, {-1, -1, -1, -1}, body_.labels[voxel], body_.labels[voxel + up], voxel, axis};
  for (int i = 0; i < 4; ++i) {
    if (!passes_twice(quad.below, quad.above, body_.labels[voxel + up + sides[i]], body_.labels[voxel + sides[i]]))
      continue;
    const std::array<int, 2> ends = {std::min(corner[i], corner[(i + 1) % 4]),
                                     std::max(corner[i], corner[(i + 1) % 4])};
    quad.middle[i] = middles_.emplace(ends, static_cast<int>(middles_.size())).first->second;
  }
  quads_.push_back(quad);
}

// Visits the cubes layer by layer. Only the vertices of two layers are stored, since every quad joins vertices of one
// layer or of two successive layers.
void Net::build(Progress& progress) {
  const glm::ivec3 size = body_.size;
  const auto [sx, sy, sz] = body_.step;
  std::vector<int> below(sz, -1), here(sz, -1);
  for (int z = 0; z + 1 < size.z; ++z) {
    progress.update("surfaces", double(z) / size.z);
    std::swap(below, here);
    for (int y = 0; y + 1 < size.y; ++y)
      for (int x = 0; x + 1 < size.x; ++x) {
        const std::int64_t cube = body_.index({x, y, z}), at = x + std::int64_t{size.x} * y, row = size.x;
        bool junction = false;
        if (!is_mixed(cube, junction)) continue;
        here[at] = static_cast<int>(middle_.size());
        middle_.push_back(glm::dvec3(x, y, z) - 0.5);
        junction_.push_back(junction);
        // Adds the quads of the three pairs of voxels that begin at the cube's lowest voxel. Each quad gets the
        // vertices of the four cubes around the pair and, for each of its edges, the index step to the pair of voxels
        // beyond that edge.
        const Label label = body_.labels[cube];
        if (label != body_.labels[cube + sx])
          add_quad({below[at - row], below[at], here[at], here[at - row]}, cube, 0, {-sz, sy, sz, -sy});
        if (label != body_.labels[cube + sy])
          add_quad({below[at - 1], here[at - 1], here[at], below[at]}, cube, 1, {-sx, sz, sx, -sz});
        if (label != body_.labels[cube + sz])
          add_quad({here[at - row - 1], here[at - row], here[at], here[at - 1]}, cube, 2, {-sy, sx, sy, -sx});
      }
  }
  offset_.assign(middle_.size(), glm::dvec3(0));
}

void Net::relax(int times) {
  std::vector<glm::dvec3> sum(middle_.size());
  std::vector<int> count(middle_.size());
  for (int step = 0; step < 2 * times; ++step) {
    std::fill(sum.begin(), sum.end(), glm::dvec3(0));
    std::fill(count.begin(), count.end(), 0);
    const auto draw = [&](int vertex, int to) {
      if (junction_[vertex] && !junction_[to]) return;
      sum[vertex] += middle_[to] + offset_[to];
      ++count[vertex];
    };
    for (const Quad& quad : quads_)
      for (int i = 0; i < 4; ++i) {
        const int a = quad.corner[i], b = quad.corner[(i + 1) % 4];
        draw(a, b);
        draw(b, a);
      }
    for (std::size_t v = 0; v < middle_.size(); ++v) {
      if (count[v] == 0) continue;
      const glm::dvec3 towards = sum[v] / double(count[v]) - middle_[v] - offset_[v];
      offset_[v] = glm::clamp(offset_[v] + kSteps[step % 2] * towards, -kFurthest, kFurthest);
    }
  }
}

// Splits a quad into two triangles, or into a fan around its centre if any of its edges has a middle vertex.
void Net::triangulate(const Quad& quad, int number) {
  const auto& c = quad.corner;
  if (*std::max_element(quad.middle.begin(), quad.middle.end()) < 0) {
    triangles_.push_back({{c[0], c[1], c[2]}, number});
    triangles_.push_back({{c[0], c[2], c[3]}, number});
    return;
  }
  const int first_extra = static_cast<int>(middle_.size()), hub = first_extra + static_cast<int>(extra_.size());
  extra_.push_back(0.25 * (middle_[c[0]] + offset_[c[0]] + middle_[c[1]] + offset_[c[1]] + middle_[c[2]] +
                           offset_[c[2]] + middle_[c[3]] + offset_[c[3]]));
  for (int i = 0; i < 4; ++i) {
    const int from = c[i], to = c[(i + 1) % 4];
    if (quad.middle[i] < 0) {
      triangles_.push_back({{hub, from, to}, number});
      continue;
    }
    const int half = first_extra + quad.middle[i];
    extra_[quad.middle[i]] = 0.5 * (middle_[from] + offset_[from] + middle_[to] + offset_[to]);
    triangles_.push_back({{hub, from, half}, number});
    triangles_.push_back({{hub, half, to}, number});
  }
}

// Disjoint sets of the integers 0 .. count - 1 (union-find).
class Sets {
 public:
  explicit Sets(std::size_t count) : of_(count) { std::iota(of_.begin(), of_.end(), 0); }
  int find(int i) {
    while (of_[i] != i) i = of_[i] = of_[of_[i]];
    return i;
  }
  void join(int a, int b) {
    const int x = find(a), y = find(b);
    of_[std::max(x, y)] = std::min(x, y);
  }

 private:
  std::vector<int> of_;
};

LabelSurface Net::surface_of(Label label, const std::vector<int>& triangles) const {
  // The edges of all triangles, sorted so that edges between the same two vertices are adjacent. If there are four of
  // them, the two that belong to the same voxel of the tissue are adjacent.
  struct Side {
    int low, high;
    std::int64_t voxel;
    int at_low, at_high;  // the triangle's corners at the edge's ends, as 3 * triangle + corner
    auto key() const { return std::tie(low, high, voxel, at_low); }
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    const Triangle& triangle = triangles_[triangles[t]];
    for (int i = 0; i < 3; ++i) {
      int a = i, b = (i + 1) % 3;
      if (triangle.corner[a] > triangle.corner[b]) std::swap(a, b);
      sides.push_back({triangle.corner[a], triangle.corner[b], voxel_of(triangle, label), 3 * t + a, 3 * t + b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.key() < b.key(); });

  // Joins the corners of two triangles at each end of their common edge into one vertex.
  Sets corners(3 * triangles.size());
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].low == sides[first].low && sides[end].high == sides[first].high) ++end;
    for (std::size_t i = first; i + 1 < end; i += 2) {
      corners.join(sides[i].at_low, sides[i + 1].at_low);
      corners.join(sides[i].at_high, sides[i + 1].at_high);
    }
  }

  LabelSurface surface{.label = label, .vertex = {}, .F = {}};
  std::vector<int> vertex_of(3 * triangles.size(), -1);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    const Triangle& triangle = triangles_[triangles[t]];
    glm::ivec3 f;
    for (int i = 0; i < 3; ++i) {
      int& vertex = vertex_of[corners.find(3 * t + i)];
      if (vertex < 0) {
        vertex = static_cast<int>(surface.vertex.size());
        surface.vertex.push_back(triangle.corner[i]);
      }
      f[i] = vertex;
    }
    const bool outwards = quads_[triangle.quad].below == label;
    surface.F.push_back(outwards ? f : glm::ivec3(f.x, f.z, f.y));
  }
  return surface;
}

LabelSurfaces Net::surfaces() {
  extra_.resize(middles_.size());
  for (std::size_t q = 0; q < quads_.size(); ++q) triangulate(quads_[q], static_cast<int>(q));
  std::map<Label, std::vector<int>> of_label;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    const Quad& quad = quads_[triangles_[t].quad];
    if (quad.below != 0) of_label[quad.below].push_back(t);
    if (quad.above != 0) of_label[quad.above].push_back(t);
  }

  LabelSurfaces all;
  const AffineTransform to_world = world_from_voxel(volume_.grid);
  const bool mirrored = glm::determinant(to_world.linear) < 0;
  for (std::size_t v = 0; v < middle_.size(); ++v) all.V.push_back(to_world * (middle_[v] + offset_[v]));
  for (const glm::dvec3& place : extra_) all.V.push_back(to_world * place);
  for (const auto& [label, triangles] : of_label) {
    all.surfaces.push_back(surface_of(label, triangles));
    if (mirrored)
      for (glm::ivec3& f : all.surfaces.back().F) std::swap(f.y, f.z);
  }
  return all;
}

}  // namespace

LabelSurfaces label_surfaces(const LabelVolume& volume, const LabelSurfaceSettings& settings, Progress& progress) {
  Net net(volume, progress);
  net.relax(settings.relaxations);
  LabelSurfaces all = net.surfaces();
  progress.update("surfaces", 1);
  return all;
}

double enclosed_volume(const LabelSurfaces& all, const LabelSurface& surface) {
  if (surface.F.empty()) return 0;
  // Uses a point of the surface as the origin, so that large coordinates do not reduce the precision.
  const glm::dvec3 about = all.V[surface.vertex[0]];
  double six_volumes = 0;
  for (const glm::ivec3& f : surface.F) {
    const glm::dvec3 a = all.V[surface.vertex[f.x]] - about, b = all.V[surface.vertex[f.y]] - about,
                     c = all.V[surface.vertex[f.z]] - about;
    six_volumes += glm::dot(a, glm::cross(b, c));
  }
  return six_volumes / 6;
}

}  // namespace limber
