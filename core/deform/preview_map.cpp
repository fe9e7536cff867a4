// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/preview_map.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/deform/rasterize.h"

namespace limber {

namespace {

constexpr int kTile = 8;             // number of nodes along the edge of a tile; whole tiles are recomputed
constexpr int kMargin = 3;           // rest points can be stored up to this distance outside the grid, cells
constexpr double kFurthest = 32000;  // a pose that moves a vertex further is refused, cells; fixed point allows 32 768
constexpr std::int64_t kMostNodes = std::int64_t{1} << 26;
constexpr double kHeld = 2;  // vertices up to this distance from a tet mesh move with it, cells
// Errors of a cell's trilinear map, in cells. An error below kNear is not corrected, an error up to kFar is corrected
// by one Newton step, and a larger one by two.
constexpr double kNear = 1.0 / 32;
constexpr double kFar = 1.0 / 8;
// Two nodes lie on different sheets of the body, as on the two sides of a fold, if the distance of their rest points is
// more than this multiple of the nodes' own distance.
constexpr float kAcross = 2.5;
constexpr std::int8_t kMostApart = CellPart::kStepApart;  // larger values are stored as this in PreviewMap::apart
constexpr std::array<glm::ivec3, 8> kCorners = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }
glm::ivec3 tile_of(const glm::ivec3& node) {
  return {floor_div(node.x, kTile), floor_div(node.y, kTile), floor_div(node.z, kTile)};
}

// The range of rest coordinates. Nodes store rest points as 16-bit fractions of this range. The distance between nodes
// is a whole number of fractions, and `low` is a whole number of steps away from a node, so the rest pose is exact.
struct Span {
  glm::dvec3 low, extent;
};
Span span_of(const PreviewLattice& lattice) {
  const double step = lattice.step;
  const glm::dvec3 least = glm::dvec3(lattice.grid.size) + (2 * kMargin + 1) * step;
  return {glm::dvec3(-(kMargin + 0.5) * step - 0.5),
          PreviewMap::kFullFraction * step / glm::floor(PreviewMap::kFullFraction * step / least)};
}

// Returns a node's rest point (16-bit fractions) as integers in one SIMD register.
Lanes lanes_of(const glm::u16vec4& node) { return Lanes{node.x, node.y, node.z, 0}; }
Lanes most(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
Lanes least(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
Lanes apart(const Lanes& a, const Lanes& b) { return most(a - b, b - a); }

bool any_beyond(const Lanes& a, const Lanes& limit) { return a[0] > limit[0] || a[1] > limit[1] || a[2] > limit[2]; }

}  // namespace

std::optional<glm::dvec3> PreviewMap::rest_at(const glm::dvec3& posed) const {
  const glm::dvec3 place = node_from_voxel(posed), corner = glm::floor(place);
  if (!(glm::all(glm::greaterThanEqual(corner, glm::dvec3(0))) &&
        glm::all(glm::lessThan(corner, glm::dvec3(size - 1)))))
    return std::nullopt;
  const std::uint8_t cube = cubes[index(glm::ivec3(corner))];
  if (cube == kNothing) return std::nullopt;
  const glm::dvec3 nearest = glm::floor(place + 0.5);
  if (cube < kBroken) return cube >= kBordered && apart_between(place) < 0 ? std::nullopt : between(place);
  if (!covers(glm::ivec3(nearest))) return std::nullopt;
  const glm::dvec3 here = rest_of_node(glm::ivec3(nearest));
  glm::dvec3 slope = here - between(2.0 * nearest - place).value_or(here);
  if (!glm::all(glm::lessThan(glm::abs(slope), glm::dvec3(steepest())))) slope = glm::dvec3(0);
  const int border = apart[index(glm::ivec3(nearest))];
  if (border < kMostApart && glm::length(slope) * CellPart::kStepApart > double(border) * step) return std::nullopt;
  return here + slope;
}

double PreviewMap::apart_between(const glm::dvec3& place) const {
  const glm::dvec3 corner = glm::floor(place), t = place - corner;
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 offset(i & 1, i >> 1 & 1, i >> 2),
        node = glm::clamp(glm::ivec3(corner) + offset, glm::ivec3(0), size - 1);
    sum += (offset.x ? t.x : 1 - t.x) * (offset.y ? t.y : 1 - t.y) * (offset.z ? t.z : 1 - t.z) * apart[index(node)];
  }
  return sum;
}

// Interpolates the rest points of the nodes around a position. Nodes without a rest point (not covered) are left out.
std::optional<glm::dvec3> PreviewMap::between(const glm::dvec3& place) const {
  const glm::dvec3 corner = glm::floor(place), t = place - corner;
  glm::dvec3 sum(0);
  double total = 0;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 offset(i & 1, i >> 1 & 1, i >> 2),
        node = glm::clamp(glm::ivec3(corner) + offset, glm::ivec3(0), size - 1);
    const double share = (offset.x ? t.x : 1 - t.x) * (offset.y ? t.y : 1 - t.y) * (offset.z ? t.z : 1 - t.z);
    if (!covers(node)) continue;
    sum += share * rest_of_node(node);
    total += share;
  }
  if (total < 0.5) return std::nullopt;  // too few covered nodes
  return sum / total;
}

// Recomputes the stale rows of a PreviewMap from the rest points that posed cells claim for the nodes.
class LivePreview::Finish {
 public:
  Finish(Made& made, const LivePreview& preview)
      : map_(*made.map),
        jumps_(made.jumps),
        stale_(made.stale),
        preview_(preview),
        claimed_(preview.claimed_),
        strides_{1, map_.size.x, map_.size.x * map_.size.y} {
    for (int i = 0; i < 8; ++i) offsets_[i] = map_.index(kCorners[i]);
    const glm::dvec3 fractions = double(PreviewMap::kFullFraction) / map_.extent;
    for (int axis = 0; axis < 3; ++axis) {
      jump_[axis] = static_cast<int>(std::min(map_.jump() * fractions[axis], double(PreviewMap::kFullFraction)));
      steepest_[axis] =
          static_cast<int>(std::min(map_.steepest() * fractions[axis], double(PreviewMap::kFullFraction)));
      steps_[axis] = static_cast<float>(1 / (fractions[axis] * map_.step));
    }
  }

  // Copies the claimed rest points of one layer of nodes, and extrapolates rest points to nodes just outside cells.
  void layer(int z) {
    for (int y = 0; y < map_.size.y; ++y) {
      const auto [first, last] = stale(y, z);
      const std::int64_t row = map_.index({0, y, z});
      std::copy(claimed_.begin() + row + first, claimed_.begin() + row + last, map_.nodes.begin() + row + first);
      for (std::int64_t at = row + first; at < row + last; ++at)
        map_.apart[at] = std::min(preview_.claimed_apart_[at], kMostApart);
      if (y == 0 || z == 0 || y + 1 == map_.size.y || z + 1 == map_.size.z) continue;
      for (std::int64_t at = row + std::max(first, 1), end = row + std::min(last, map_.size.x - 1); at < end; ++at)
        if (const glm::u16vec4* here = &claimed_[at];
            !here->w && (here[-1].w | here[1].w | here[-strides_[1]].w | here[strides_[1]].w | here[-strides_[2]].w |
                         here[strides_[2]].w))
          carry_on(at);
    }
  }

  // Finds, in one layer, the edges between neighbouring nodes that are on different sheets of the body, as across a
  // fold. layer() must have been called for all layers.
  void edges(int z) {
    for (int y = 0; y < map_.size.y; ++y) {
      const auto [first, last] = stale(y, z);
      const std::int64_t row = map_.index({0, y, z});
      for (int x = first; x < last; ++x) {
        std::uint8_t& jumps = jumps_[row + x] = 0;
        if (!map_.nodes[row + x].w) continue;
        for (int axis = 0; axis < 3; ++axis)
          if (glm::ivec3(x, y, z)[axis] + 1 < map_.size[axis] && edge_jumps(row + x, axis)) jumps |= 1 << axis;
      }
    }
  }

  // Computes the state of each cube of eight nodes in a layer. edges() must have been called for all layers.
  void cubes(int z) {
    if (z + 1 >= map_.size.z) return;
    for (int y = 0; y + 1 < map_.size.y; ++y) {
      const auto [first, last] = stale(y, z);
      const std::int64_t row = map_.index({0, y, z});
      for (std::int64_t at = row + first, end = row + std::min(last, map_.size.x - 1); at < end; ++at) cube(at);
    }
  }

 private:
  const std::array<int, 2>& stale(int y, int z) const { return stale_[y + std::int64_t{map_.size.y} * z]; }

  // Extrapolates the rest point of a node that no cell claims. Each claimed neighbour, with the node behind it, gives
  // one result; the node gets the mean of all results that agree with the first one. (The two outermost layers of nodes
  // are never claimed, so all these indices are valid.)
  void carry_on(std::int64_t at) {
    Lanes sum{}, first{};
    int count = 0, border = CellPart::kFarApart;
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        const std::int64_t next = at + sign * strides_[axis], second = at + 2 * sign * strides_[axis];
        if (!claimed_[next].w || !claimed_[second].w) continue;
        const Lanes a = lanes_of(claimed_[next]), b = lanes_of(claimed_[second]), here = 2 * a - b;
        if (any_beyond(apart(a, b), steepest_) || (count > 0 && any_beyond(apart(here, first), steepest_))) continue;
        if (count == 0) first = here;
        sum += here;
        ++count;
        if (const int there = preview_.claimed_apart_[next]; there < CellPart::kFarApart)
          border = std::min(border, there - int(CellPart::kStepApart * std::sqrt(squared_steps(b - a))));
      }
    if (count == 0) return;
    const Lanes none{}, full = none + PreviewMap::kFullFraction;
    const Lanes mean = least(most(sum / (none + count), none), full);
    map_.nodes[at] = glm::u16vec4(mean[0], mean[1], mean[2], PreviewMap::kFullFraction);
    map_.apart[at] = static_cast<std::int8_t>(std::clamp(border, -CellPart::kFarApart, int(kMostApart)));
  }

  float squared_steps(const Lanes& fractions) const {
    const glm::vec3 steps = glm::vec3(fractions[0], fractions[1], fractions[2]) * steps_;
    return glm::dot(steps, steps);
  }

  // Returns true if a node and the next node along an axis are on different sheets of the body.
  bool edge_jumps(std::int64_t at, int axis) const {
    const std::int64_t next = at + strides_[axis];
    if (!map_.nodes[next].w) return false;
    const Lanes here = lanes_of(map_.nodes[at]), there = lanes_of(map_.nodes[next]);
    if (const float squared = squared_steps(there - here); squared > 0.25f && squared < 2.25f) return false;
    return any_beyond(apart(here, there), jump_) ||
           preview_.strays(at, axis, next, map_.rest_of_node_at(next) - map_.rest_of_node_at(at));
  }

  void cube(std::int64_t at) {
    const auto [low, high] = bounds(&map_.nodes[at]);
    if (!high.w) {
      map_.cubes[at] = PreviewMap::kNothing;
      return;
    }
    bool bordered = false, jumps = false;
    for (int i = 0; i < 8; ++i) {
      bordered =
          bordered || map_.apart[at + offsets_[i]] < 0;  // negative beyond the border; 0 at nodes that no cell covers
      jumps = jumps || (jumps_[at + offsets_[i]] & ~i & 7);
    }
    if (low.w) map_.reach[at] = {glm::u16vec3(low), glm::u16vec3(high)};
    if (bordered || !low.w) jumps = jumps_across(at) || jumps;
    map_.cubes[at] = jumps ? PreviewMap::kBroken : bordered ? PreviewMap::kBordered : PreviewMap::kWhole;
  }

  // Returns the smallest and largest components of a cube's eight nodes, covered or not. Compares two nodes at a time.
  std::array<glm::u16vec4, 2> bounds(const glm::u16vec4* nodes) const {
    using Shorts = short __attribute__((vector_size(16)));
    // Flipping the sign bit turns the order of unsigned integers into that of signed integers.
    constexpr short kSign = std::numeric_limits<short>::min();
    constexpr Shorts kSigns{kSign, kSign, kSign, kSign, kSign, kSign, kSign, kSign};
    Shorts low, high;
    for (const int i : {0, 2, 4, 6}) {
      Shorts two;
      std::memcpy(&two, nodes + offsets_[i], sizeof two);
      two ^= kSigns;
      low = i == 0 ? two : two < low ? two : low;
      high = i == 0 ? two : two > high ? two : high;
    }
    low ^= kSigns;
    high ^= kSigns;
    std::array<glm::u16vec4, 2> lows, highs;
    std::memcpy(&lows, &low, sizeof low);
    std::memcpy(&highs, &high, sizeof high);
    return {glm::min(lows[0], lows[1]), glm::max(highs[0], highs[1])};
  }

  // Returns true if any two of a cube's nodes belong to parts of the body that are apart at rest, such as an arm and
  // the trunk that it touches. Compares all pairs of nodes, not only the ends of edges, because nodes without a rest
  // point cannot be compared. Also sets the bounding box of the nodes' rest points.
  bool jumps_across(std::int64_t at) {
    std::array<Lanes, 8> c{};
    int count = 0;
    std::array<int, 8> corner{};
    const Lanes none{}, full = none + PreviewMap::kFullFraction;
    Lanes low = full, high = none;
    for (int i = 0; i < 8; ++i) {
      const glm::u16vec4& node = map_.nodes[at + offsets_[i]];
      if (!node.w) continue;
      corner[count] = i;
      c[count] = lanes_of(node);
      low = least(low, c[count]);
      high = most(high, c[count++]);
    }
    map_.reach[at] = {glm::u16vec3(low[0], low[1], low[2]), glm::u16vec3(high[0], high[1], high[2])};
    if (squared_steps(high - low) <= kAcross * kAcross) return false;
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < i; ++j)
        if (squared_steps(c[i] - c[j]) > kAcross * kAcross * std::popcount(unsigned(corner[i] ^ corner[j])))
          return true;
    return false;
  }

  PreviewMap& map_;
  std::vector<std::uint8_t>& jumps_;
  const std::vector<std::array<int, 2>>& stale_;
  const LivePreview& preview_;
  const std::vector<glm::u16vec4>& claimed_;
  std::array<std::int64_t, 3> strides_;
  std::array<std::int64_t, 8> offsets_;  // index offsets of a cube's eight nodes
  Lanes jump_{}, steepest_{};
  glm::vec3 steps_{0};  // by axis: factor from 16-bit fractions (stored rest points) to steps
};

// The tiles of nodes, and which of them must be recomputed (dirty).
struct LivePreview::Tiles {
  glm::ivec3 first, size;
  std::vector<std::uint8_t> dirty;

  std::int64_t index(const glm::ivec3& tile) const {
    const glm::ivec3 t = tile - first;
    return t.x + std::int64_t{size.x} * (t.y + std::int64_t{size.y} * t.z);
  }
  glm::ivec3 at(std::int64_t i) const {
    return first + glm::ivec3(i % size.x, i / size.x % size.y, i / size.x / size.y);
  }

  // Calls body(index) for each tile that contains nodes of the range.
  template <class Body>
  void reached(const VoxelRange& range, const Body& body) const {
    if (range.empty()) return;
    const glm::ivec3 low = tile_of(range.low), high = tile_of(range.high);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) body(index({x, y, z}));
  }
};

// The nodes of one tile, with the cell that claims (covers) each node and the rest point there.
class LivePreview::Tile {
 public:
  Tile(const LivePreview& preview, const glm::ivec3& tile) : preview_(preview), low_(tile * kTile) { cell_.fill(-1); }

  VoxelRange range() const { return {low_, low_ + kTile - 1}; }

  void claim(std::int32_t cell, const CellClaim& claim) {
    const CellPart* part = preview_.part(cell);
    if (part && !part->holds(CellPart::place_of(preview_.middle(cell), claim.rest, preview_.lattice_.step))) return;
    const glm::ivec3 v = claim.voxel - low_;
    const int at = v.x + kTile * (v.y + kTile * v.z);
    const bool inverted = claim.posed_per_rest < 0;
    if (cell_[at] >= 0 && !is_better(cell, claim.rest, inverted, at)) return;
    cell_[at] = cell;
    rest_[at] = claim.rest;
    inverted_[at] = inverted;
  }

  // Copies the claims on the nodes in row y of layer z of this tile into the arrays of all nodes.
  void write(int y, int z, glm::u16vec4* row, std::int32_t* cells, std::int8_t* apart, const Span& span) const {
    const double step = preview_.lattice_.step;
    const glm::dvec3 fractions = double(PreviewMap::kFullFraction) / span.extent;
    for (int x = 0; x < kTile; ++x) {
      const int at = x + kTile * (y + kTile * z);
      cells[x] = cell_[at];
      apart[x] = cell_[at] < 0 ? 0 : CellPart::kFarApart;
      if (cell_[at] < 0) {
        row[x] = glm::u16vec4(0);
        continue;
      }
      if (const CellPart* part = preview_.part(cell_[at]))
        apart[x] = part->apart[CellPart::place_of(preview_.middle(cell_[at]), rest_[at], preview_.lattice_.step)];
      const glm::dvec3 voxel =
          (preview_.in_bent_cell(cell_[at], low_ + glm::ivec3(x, y, z), rest_[at]) + 0.5) * step - 0.5;
      const glm::dvec3 f = glm::clamp((voxel - span.low) * fractions, 0.0, double(PreviewMap::kFullFraction));
      row[x] = glm::u16vec4(std::lrint(f.x), std::lrint(f.y), std::lrint(f.z), PreviewMap::kFullFraction);
    }
  }

 private:
  bool is_better(std::int32_t cell, const glm::dvec3& rest, bool inverted, int at) const {
    const bool stiff = preview_.is_stiff(cell), stiff_there = preview_.is_stiff(cell_[at]);
    if (stiff != stiff_there) return stiff;
    if (inverted != inverted_[at]) return !inverted;
    const int mine = preview_.priority_[label_at(rest)], theirs = preview_.priority_[label_at(rest_[at])];
    if (mine != theirs) return mine > theirs;
    const PreviewLattice& lattice = preview_.lattice_;
    const double my_depth = lattice.depth_in(preview_.middle(cell), rest),
                 their_depth = lattice.depth_in(preview_.middle(cell_[at]), rest_[at]);
    if (my_depth != their_depth) return my_depth > their_depth;
    return cell < cell_[at];
  }
  Label label_at(const glm::dvec3& rest) const {
    return preview_.volume_->at_or_air(glm::ivec3(glm::floor((rest + 0.5) * double(preview_.lattice_.step))));
  }

  static constexpr int kNodes = kTile * kTile * kTile;
  const LivePreview& preview_;
  glm::ivec3 low_;
  std::array<std::int32_t, kNodes> cell_;
  std::array<glm::dvec3, kNodes> rest_;  // claimed rest points, cell coordinates
  std::array<bool, kNodes> inverted_;
};

LivePreview::LivePreview(std::shared_ptr<const LabelVolume> volume, const TissueTable& tissues,
                         const TissueVoxels& tissue, const SkinWeights& weights, int step)
    : volume_(std::move(volume)),
      lattice_(preview_lattice(volume_->grid, tissue, weights, step)),
      priority_(65536, 0),
      posed_(lattice_.places()),
      posed_parts_(lattice_.parts.size()),
      moved_(lattice_.places()),
      part_moved_(lattice_.parts.size()),
      range_(lattice_.cells.size() + lattice_.parts.size()),
      before_(range_) {
  priority_[0] = std::numeric_limits<int>::min();
  for (const Tissue& each : tissues.tissues)
    if (each.label != 0) priority_[each.label] = each.priority;

  std::vector<int> only(lattice_.places(), -1);  // for each vertex, the one bone that it follows; -1: several
  for (size_t i = 0; i < lattice_.vertices.size(); ++i)
    if (lattice_.offsets[i + 1] - lattice_.offsets[i] == 1)
      only[lattice_.place(lattice_.vertices[i])] = lattice_.influences[lattice_.offsets[i]].bone;
  motion_of_.assign(lattice_.places(), -1);
  for (size_t i = 0; i < lattice_.cells.size(); ++i) {
    if (lattice_.has_sides[i]) continue;
    const glm::ivec3 cell = lattice_.cells[i];
    const std::int64_t first = lattice_.place(cell);
    if (only[first] >= 0 && std::all_of(kCorners.begin(), kCorners.end(), [&](const glm::ivec3& c) {
          return only[lattice_.place(cell + c)] == only[first];
        }))
      continue;
    for (const glm::ivec3& c : kCorners) motion_of_[lattice_.place(cell + c)] = 0;
  }
  std::int32_t count = 0;
  for (std::int32_t& motion : motion_of_)
    if (motion == 0) motion = count++;
  for (const CellPart& part : lattice_.parts) {
    const bool bends = std::any_of(part.influences.begin(), part.influences.end(), [&](const auto& each) {
      return each.size() > 1 || each[0].bone != part.influences[0][0].bone;
    });
    first_motion_.push_back(bends ? std::exchange(count, count + 8) : -1);
    for (const auto& each : part.influences) {
      part_offsets_.push_back(static_cast<std::int32_t>(part_influences_.size()));
      part_influences_.insert(part_influences_.end(), each.begin(), each.end());
    }
  }
  part_offsets_.push_back(static_cast<std::int32_t>(part_influences_.size()));
  motion_.resize(count);
}

std::shared_ptr<const PreviewMap> LivePreview::update(const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                                                      const MeshPose& mesh, const std::vector<BentJoint>& baked) {
  if (!pose_vertices(posed_from_rest, blend, mesh, baked)) return map_;
  bound_cells();
  rasterize();
  Made& made = spare();
  finish(made);
  map_ = made.map;
  return map_;
}

// Finds the vertices and the corners of cell parts (CellPart) that move with a tet mesh.
void LivePreview::hold_by(const std::shared_ptr<const TetMesh>& mesh) {
  carried_.reset();
  if (!mesh) return;
  const double step = lattice_.step;
  const auto voxel = [&](const glm::dvec3& cell) { return (cell + 0.5) * step - 0.5; };
  std::vector<PointToCarry> points;
  for (const glm::ivec3& vertex : lattice_.vertices)
    points.push_back({voxel(glm::dvec3(vertex) - 0.5), voxel(glm::dvec3(vertex) - 0.5)});
  for (const CellPart& part : lattice_.parts) {
    // Anchors the corners of a part in the part's subcell that is furthest from the tissue of other sides, so that the
    // corners do not follow another side's tets.
    int deepest = 0;
    for (int place = 0; place < 64; ++place)
      if (part.holds(place) && (!part.holds(deepest) || part.apart[place] > part.apart[deepest])) deepest = place;
    const glm::dvec3 in_cell = (glm::dvec3(deepest % 4, deepest / 4 % 4, deepest / 16) + 0.5) / 4.0 - 0.5;
    const glm::ivec3 middle = lattice_.cells[part.cell];
    for (const glm::ivec3& c : kCorners)
      points.push_back({voxel(glm::dvec3(middle + c) - 0.5), voxel(glm::dvec3(middle) + in_cell)});
  }
  const double furthest =
      kHeld * step * std::max({lattice_.grid.spacing.x, lattice_.grid.spacing.y, lattice_.grid.spacing.z});
  carried_.emplace(mesh, lattice_.grid, points, furthest);
}

// Poses the vertices and the parts' corners that move. Returns false if nothing moved.
bool LivePreview::pose_vertices(const std::vector<RigidTransform>& posed_from_rest, Blend blend, const MeshPose& mesh,
                                const std::vector<BentJoint>& baked) {
  const bool shifts = shifts_.set(lattice_, blend == Blend::DualQuaternion ? baked : std::vector<BentJoint>());
  const bool all = !map_ || blend != blend_ || mesh.rest != mesh_.rest;
  if (all) size_ = glm::ivec3(0);
  bone_moved_.assign(posed_from_rest.size(), all);
  for (size_t b = 0; b < posed_from_rest.size() && !all; ++b)
    bone_moved_[b] = posed_from_rest[b].rotation != posed_from_rest_[b].rotation ||
                     posed_from_rest[b].translation != posed_from_rest_[b].translation;
  if (std::find(bone_moved_.begin(), bone_moved_.end(), 1) == bone_moved_.end() && mesh == mesh_ && !shifts)
    return false;
  map_ = nullptr;  // null until this update ends, so that after an exception the next update recomputes everything

  if (mesh.rest != mesh_.rest) hold_by(mesh.rest);
  mesh_ = mesh;
  const auto held = carried_ ? carried_->posed(*mesh.posed) : std::vector<std::optional<glm::dvec3>>();
  const auto is_held = [&](std::int64_t point) { return !held.empty() && held[point]; };

  const std::vector<SkinTransform> bones = skin_transforms(posed_from_rest);
  const AffineTransform world_from_voxel = limber::world_from_voxel(lattice_.grid),
                        voxel_from_world = limber::voxel_from_world(lattice_.grid);
  const double step = lattice_.step;
  world_from_cell_ = {world_from_voxel.linear * step, world_from_voxel * glm::dvec3(0.5 * step - 0.5)};
  cell_from_world_ = voxel_from_world.linear / step;
  // One affine map per bone, for vertices that follow only this bone: from a vertex's whole coordinates to its motion
  // (posed - rest), in cells.
  std::vector<AffineTransform> moves;
  for (const RigidTransform& bone : posed_from_rest) {
    const glm::dmat3 turn = glm::mat3_cast(bone.rotation) - glm::dmat3(1);
    moves.push_back({cell_from_world_ * turn * world_from_cell_.linear,
                     cell_from_world_ * (turn * (world_from_cell_ * glm::dvec3(-0.5)) + bone.translation)});
  }
  const auto fixed_at = [](const glm::dvec3& at) {
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(at[axis]) < kFurthest))
        throw Error("the pose moves the tissue too far away", "preview of the posed volume",
                    "check the pose and the rig");
    return FixedPoint(std::lrint(at.x * kFixedOne), std::lrint(at.y * kFixedOne), std::lrint(at.z * kFixedOne));
  };
  // Returns true if this update changes a vertex's shift by baked joints.
  const auto shifts_anew = [&](std::int64_t place) { return shifts && shifts_.has_changed(place); };
  // Returns the posed position of a vertex. If `motion` is not null, also writes the blended motion of the vertex's
  // bones to it; cells that bend need this motion.
  //   shift  the shift of the vertex by baked joints, in cells
  const auto posed = [&](const glm::ivec3& vertex, std::span<const BoneWeight> influences, SkinTransform* motion,
                         const glm::vec3& shift) {
    glm::dvec3 at = glm::dvec3(vertex) - 0.5;
    if (influences.size() == 1) {
      at += moves[influences[0].bone] * glm::dvec3(vertex);
      if (motion) *motion = bones[influences[0].bone];
    } else {
      const SkinTransform together = blended_transform(blend, bones, influences);
      const BoneWeight whole{0, 1};
      const glm::dvec3 world = world_from_cell_ * at;
      at += cell_from_world_ * (blend_point(blend, {&together, 1}, {&whole, 1}, world) - world);
      if (motion) *motion = together;
    }
    return fixed_at(at + glm::dvec3(shift));
  };
  const auto held_at = [&](std::int64_t point) { return fixed_at((*held[point] + 0.5) / step - 0.5); };
  const auto rests = [&](std::span<const BoneWeight> influences) {
    return std::none_of(influences.begin(), influences.end(),
                        [&](const BoneWeight& each) { return bone_moved_[each.bone]; });
  };
  parallel_for(std::ssize(lattice_.vertices), 512, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) {
      const std::span<const BoneWeight> influences(lattice_.influences.data() + lattice_.offsets[i],
                                                   lattice_.offsets[i + 1] - lattice_.offsets[i]);
      const std::int64_t place = lattice_.place(lattice_.vertices[i]);
      moved_[place] = 0;
      if (is_held(i)) {
        const FixedPoint fixed = held_at(i);
        moved_[place] = all || fixed != posed_[place];
        posed_[place] = fixed;
        continue;
      }
      if (rests(influences) && !shifts_anew(place)) continue;
      const std::int32_t motion = motion_of_[place];
      const FixedPoint fixed = posed(lattice_.vertices[i], influences, motion < 0 ? nullptr : &motion_[motion],
                                     shifts_.empty() ? glm::vec3(0) : shifts_.at(place));
      moved_[place] = all || motion >= 0 || fixed != posed_[place];
      posed_[place] = fixed;
    }
  });
  parallel_for(std::ssize(lattice_.parts), 128, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) {
      part_moved_[i] = 0;
      for (int c = 0; c < 8; ++c) {
        const std::int64_t corner = 8 * i + c;
        if (const std::int64_t point = std::ssize(lattice_.vertices) + corner;
            is_held(point) && !lattice_.parts[i].is_stiff) {
          part_moved_[i] = 1;
          posed_parts_[i][c] = held_at(point);
          continue;
        }
        const std::span<const BoneWeight> influences(part_influences_.data() + part_offsets_[corner],
                                                     part_offsets_[corner + 1] - part_offsets_[corner]);
        const glm::ivec3 vertex = lattice_.cells[lattice_.parts[i].cell] + kCorners[c];
        const bool is_stiff = lattice_.parts[i].is_stiff;
        if (rests(influences) && (is_stiff || !shifts_anew(lattice_.place(vertex)))) continue;
        part_moved_[i] = 1;
        posed_parts_[i][c] = posed(vertex, influences, first_motion_[i] < 0 ? nullptr : &motion_[first_motion_[i] + c],
                                   is_stiff || shifts_.empty() ? glm::vec3(0) : shifts_.at(lattice_.place(vertex)));
      }
    }
  });
  posed_from_rest_ = posed_from_rest;
  blend_ = blend;
  return true;
}

// Returns the rest point in a bent cell that the blended motions of the cell's corners move to a node.
//   rest  initial guess: the rest point by the trilinear map of the posed corners
glm::dvec3 LivePreview::in_bent_cell(std::int64_t cell, const glm::ivec3& node, const glm::dvec3& rest) const {
  if (mesh_.rest) return rest;
  const glm::ivec3 middle = this->middle(cell);
  std::array<BoneWeight, 8> corners;
  for (int i = 0; i < 8; ++i) corners[i].bone = motion(cell, i);
  if (std::any_of(corners.begin(), corners.end(), [](const BoneWeight& each) { return each.bone < 0; })) return rest;
  std::array<glm::dvec3, 8> shifts;
  bool is_shifted = false;
  for (int i = 0; i < 8 && !shifts_.empty() && !is_stiff(cell); ++i) {
    shifts[i] = shifts_.at(lattice_.place(middle + kCorners[i]));
    is_shifted |= shifts[i] != glm::dvec3(0);
  }
  const auto posed = [&](const glm::dvec3& at) {
    const glm::dvec3 t = at - glm::dvec3(middle) + 0.5, world = world_from_cell_ * at;
    for (int i = 0; i < 8; ++i)
      corners[i].weight = (i & 1 ? t.x : 1 - t.x) * (i & 2 ? t.y : 1 - t.y) * (i & 4 ? t.z : 1 - t.z);
    glm::dvec3 shift(0);
    for (int i = 0; is_shifted && i < 8; ++i) shift += corners[i].weight * shifts[i];
    return at + cell_from_world_ * (blend_point(blend_, motion_, corners, world) - world) + shift;
  };
  glm::dvec3 missing = glm::dvec3(node) - posed(rest);
  const auto is_within = [&](double limit) { return glm::all(glm::lessThan(glm::abs(missing), glm::dvec3(limit))); };
  if (is_within(kNear)) return rest;
  // The Newton steps use the derivative of the trilinear map, which is close enough to that of the blended motion.
  const glm::dmat3 slope = this->slope(cell);
  if (!(glm::determinant(slope) > 0.05)) return rest;
  const glm::dmat3 back = glm::inverse(slope);
  glm::dvec3 more = back * missing;
  if (!is_within(kFar)) {
    missing = glm::dvec3(node) - posed(rest + more);
    more += back * missing;
  }
  return glm::all(glm::lessThan(glm::abs(more), glm::dvec3(0.5))) ? rest + more : rest;
}

const FixedPoint& LivePreview::corner(std::int64_t cell, int i) const {
  return part(cell) ? posed_parts_[part_of(cell)][i] : posed_[lattice_.place(middle(cell) + kCorners[i])];
}

// Returns the index in motion_ of a cell corner's motion; -1: the cell does not bend.
std::int32_t LivePreview::motion(std::int64_t cell, int corner) const {
  if (!part(cell)) return motion_of_[lattice_.place(middle(cell) + kCorners[corner])];
  const std::int32_t first = first_motion_[part_of(cell)];
  return first < 0 ? first : first + corner;
}

// Returns the mean derivative of a cell's posed position by its rest position, both in cells.
glm::dmat3 LivePreview::slope(std::int64_t cell) const {
  glm::dmat3 slope(0);
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis)
      slope[axis] += (i >> axis & 1 ? 0.25 : -0.25) / kFixedOne * glm::dvec3(corner(cell, i));
  return slope;
}

// Returns true if two neighbouring nodes are on different sheets: the map of either node's cell, extended to the other
// node, gives a rest point far from the other node's own.
//   apart  vector from the node's rest point to that of the next node, voxels
bool LivePreview::strays(std::int64_t node, int axis, std::int64_t next, const glm::dvec3& apart) const {
  // If no gap is near, only a fold separates sheets, and tissue that a joint twists strongly over a short distance is
  // not a fold. So the limit is doubled where no gap is near.
  const bool at_gap = claimed_apart_[node] < CellPart::kFarApart || claimed_apart_[next] < CellPart::kFarApart;
  const double stray = (at_gap ? 1 : 2) * PreviewMap::kStray * lattice_.step;
  for (const std::int64_t each : {node, next}) {
    if (claiming_[each] < 0) return false;
    const glm::dmat3 slope = this->slope(claiming_[each]);
    if (!(std::abs(glm::determinant(slope)) > 0.05)) continue;
    const glm::dvec3 off = glm::inverse(slope)[axis] * double(lattice_.step) - apart;
    if (glm::dot(off, off) < stray * stray) return false;
  }
  return true;
}

bool LivePreview::has_moved(std::int64_t cell) const {
  if (part(cell)) return part_moved_[part_of(cell)];
  if (lattice_.has_sides[cell]) return false;
  const std::int64_t place = lattice_.place(lattice_.cells[cell]), row = lattice_.row(), slice = lattice_.slice();
  for (const std::int64_t corner : {std::int64_t{0}, row, slice, slice + row})
    if (moved_[place + corner] || moved_[place + corner + 1]) return true;
  return false;
}

PosedCell LivePreview::posed_cell(std::int64_t cell) const {
  if (part(cell)) return PosedCell(posed_parts_[part_of(cell)].data(), 2, 4, middle(cell));
  return PosedCell(&posed_[lattice_.place(middle(cell))], int(lattice_.row()), int(lattice_.slice()), middle(cell));
}

// Finds the range of nodes in the bounding box of each moved cell.
void LivePreview::bound_cells() {
  parallel_for(cell_count(), 512, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) {
      const bool moved = has_moved(i);
      before_[i] = moved ? range_[i] : VoxelRange{};
      if (moved) range_[i] = posed_cell(i).box();
    }
  });
}

void LivePreview::rasterize() {
  glm::ivec3 low(INT32_MAX), high(INT32_MIN);
  for (const VoxelRange& range : range_) {
    if (range.empty()) continue;
    low = glm::min(low, range.low);
    high = glm::max(high, range.high);
  }
  if (low.x > high.x) low = glm::ivec3(0), high = glm::ivec3(0);
  Tiles tiles;
  tiles.first = tile_of(low - 2);
  tiles.size = tile_of(high + 2) - tiles.first + 1;
  const glm::ivec3 first = tiles.first * kTile, size = tiles.size * kTile;
  if (double(size.x) * size.y * size.z > double(kMostNodes))
    throw Error("the pose stretches the tissue too far", "preview of the posed volume", "check the pose and the rig");
  const std::int64_t count = std::int64_t{tiles.size.x} * tiles.size.y * tiles.size.z;
  const bool fresh = first != first_ || size != size_;
  tiles.dirty.assign(count, fresh);
  if (fresh) {
    first_ = first;
    size_ = size;
    for (Made& made : made_) made.stale.assign(std::int64_t{size.y} * size.z, {0, size.x});
    claimed_.assign(std::int64_t{size.x} * size.y * size.z, glm::u16vec4(0));
    claiming_.assign(claimed_.size(), -1);
    claimed_apart_.assign(claimed_.size(), 0);
  } else {
    for (std::int64_t i = 0; i < cell_count(); ++i) {
      if (!has_moved(i)) continue;
      for (const VoxelRange& range : {before_[i], range_[i]})
        tiles.reached(range, [&](std::int64_t t) { tiles.dirty[t] = 1; });
    }
  }

  // Lists the cells that reach each dirty tile, ascending.
  std::vector<std::int64_t> begin(count + 1);
  for (const VoxelRange& range : range_) tiles.reached(range, [&](std::int64_t t) { begin[t + 1] += tiles.dirty[t]; });
  std::vector<std::int32_t> work;
  for (std::int64_t t = 0; t < count; ++t) {
    if (tiles.dirty[t]) work.push_back(static_cast<std::int32_t>(t));
    begin[t + 1] += begin[t];
  }
  std::vector<std::int32_t> cells(begin[count]);
  std::vector<std::int64_t> end(begin.begin(), begin.end() - 1);
  for (size_t i = 0; i < range_.size(); ++i)
    tiles.reached(range_[i], [&](std::int64_t t) {
      if (tiles.dirty[t]) cells[end[t]++] = static_cast<std::int32_t>(i);
    });
  cells_rasterized_ = begin[count];
  if (!fresh)
    for (const std::int32_t t : work) mark_stale(tiles.at(t) * kTile - first_);
  parallel_for(std::ssize(work), 1, [&](std::int64_t from, std::int64_t to) {
    for (auto w = from; w < to; ++w)
      rasterize_tile(tiles.at(work[w]), cells.data() + begin[work[w]], begin[work[w] + 1] - begin[work[w]]);
  });
}

void LivePreview::rasterize_tile(const glm::ivec3& tile_at, const std::int32_t* cells, std::int64_t count) {
  Tile tile(*this, tile_at);
  for (std::int64_t i = 0; i < count; ++i) {
    posed_cell(cells[i]).rasterize(tile.range(), [&](const CellClaim& claim) { tile.claim(cells[i], claim); });
  }
  const Span span = span_of(lattice_);
  const glm::ivec3 from = tile_at * kTile - first_;
  for (int z = 0; z < kTile; ++z)
    for (int y = 0; y < kTile; ++y) {
      const std::int64_t row = from.x + std::int64_t{size_.x} * (from.y + y + std::int64_t{size_.y} * (from.z + z));
      tile.write(y, z, &claimed_[row], &claiming_[row], &claimed_apart_[row], span);
    }
}

// Marks all values that depend on the nodes of a tile as stale: nodes extrapolated from them, the edges to these nodes,
// and the cubes around all of them.
//   low  the tile's lowest node
void LivePreview::mark_stale(const glm::ivec3& low) {
  const glm::ivec3 from = glm::max(low - 3, glm::ivec3(0)), to = glm::min(low + kTile + 2, size_);
  for (Made& made : made_)
    for (int z = from.z; z < to.z; ++z)
      for (int y = from.y; y < to.y; ++y) {
        auto& [first, end] = made.stale[y + std::int64_t{size_.y} * z];
        if (first == end) first = from.x, end = to.x;
        else first = std::min(first, from.x), end = std::max(end, to.x);
      }
}

// Returns a map of the current size to which no other owner holds a pointer.
LivePreview::Made& LivePreview::spare() {
  Made& made = made_[made_[0].map.use_count() > made_[1].map.use_count()];
  const bool is_free = made.map && made.map.use_count() == 1;
  // Orders the former owners' last reads before this thread's writes.
  std::atomic_thread_fence(std::memory_order_acquire);
  if (is_free && made.map->first == first_ && made.map->size == size_) return made;
  const Span span = span_of(lattice_);
  if (!is_free) made.map = std::make_shared<PreviewMap>();
  PreviewMap& map = *made.map;
  map.step = lattice_.step;
  map.grid = lattice_.grid;
  map.first = first_;
  map.size = size_;
  map.low = span.low;
  map.extent = span.extent;
  map.nodes.resize(claimed_.size());
  map.apart.resize(claimed_.size());
  map.cubes.assign(claimed_.size(), PreviewMap::kNothing);
  map.reach.resize(claimed_.size());
  made.jumps.assign(claimed_.size(), 0);
  made.stale.assign(std::int64_t{size_.y} * size_.z, {0, size_.x});
  return made;
}

void LivePreview::finish(Made& made) const {
  Finish finish(made, *this);
  parallel_for(size_.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto z = begin; z < end; ++z) finish.layer(int(z));
  });
  parallel_for(size_.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto z = begin; z < end; ++z) finish.edges(int(z));
  });
  parallel_for(size_.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto z = begin; z < end; ++z) finish.cubes(int(z));
  });
  made.stale.assign(made.stale.size(), {0, 0});
}

}  // namespace limber
