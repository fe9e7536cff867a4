// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/posed_tets.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/parallel.h"
#include "core/deform/claims.h"
#include "core/deform/mesh_border.h"

namespace limber {

namespace {

// A pose that moves a node further from the base is refused, output voxels; fixed point allows 32 768.
constexpr double kFurthest = 32000;
constexpr int kPosedBin = 16;  // edge of a search bin, voxels: a quarter of an output tile's edge
// A rider (a tissue voxel that sticks out of the mesh) and other tissue that cover one voxel do not count as
// overlapping if they are at most this far apart at rest, voxels. A crease may press them together: riders stick out by
// two voxels on both sides, and the crease is one voxel wide.
constexpr int kCrease = 5;
// Takes the place of kCrease for flesh that slides over bone. Such flesh may come from anywhere, so nothing counts as
// overlapping.
constexpr int kSlides = 1 << 20;

glm::dvec3 in_mm(const Eigen::MatrixX3d& places, int row) { return {places(row, 0), places(row, 1), places(row, 2)}; }

// Calls body(brick) for the brick at `corner` and for each of the 26 bricks around it that has tissue.
template <class Body>
void for_each_neighbour_brick(const TissueVoxels& tissue, const glm::ivec3& corner, const Body& body) {
  for (int i = 0; i < 27; ++i) {
    const glm::ivec3 at = corner + (glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1) * TissueVoxels::kBrick;
    if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, tissue.grid_size()))) continue;
    if (const int brick = tissue.brick_at(at); brick >= 0) body(brick);
  }
}

// The affine map from posed points in a tet to rest points, both in voxel coordinates.
struct TetMap {
  glm::dvec3 from_posed, from_rest;
  glm::dmat3 rest_from_posed;
  double posed_per_rest;

  TetMap(const std::array<FixedPoint, 4>& posed, const std::array<glm::dvec3, 4>& rest)
      : from_posed(glm::dvec3(posed[0]) / double(kFixedOne)),
        from_rest(rest[0]) {
    glm::dmat3 posed_edges, rest_edges;
    for (int i = 0; i < 3; ++i) {
      posed_edges[i] = glm::dvec3(posed[i + 1] - posed[0]) / double(kFixedOne);
      rest_edges[i] = rest[i + 1] - rest[0];
    }
    rest_from_posed = rest_edges * glm::inverse(posed_edges);
    posed_per_rest = glm::determinant(posed_edges) / glm::determinant(rest_edges);
  }
  glm::dvec3 rest(const glm::ivec3& voxel) const {
    return from_rest + rest_from_posed * (glm::dvec3(voxel) - from_posed);
  }
};

// Returns the barycentric coordinates of a point in a tet.
glm::dvec4 shares_in(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& point) {
  const glm::dmat3 edges(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
  const glm::dvec3 s = glm::inverse(edges) * (point - corners[0]);
  return {1 - s.x - s.y - s.z, s};
}

// Returns 1 for each tet of a bone over which flesh slides: a bone some of whose nodes have copies that belong to the
// flesh (TetMesh::copy_of).
std::vector<char> slid_over(const TetMesh& mesh) {
  std::vector<char> has_copy(mesh.V.rows(), 0), result(mesh.T.rows(), 0), slides(65536, 0);
  for (std::size_t v = 0; v < mesh.copy_of.size(); ++v)
    if (mesh.copy_of[v] != int(v)) has_copy[mesh.copy_of[v]] = 1;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (const int v : mesh.T.row(t))
      if (has_copy[v]) slides[mesh.region[t]] = 1;
  slides[TetMesh::kSoft] = 0;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) result[t] = slides[mesh.region[t]];
  return result;
}

std::uint32_t index_of(const Grid& grid, const glm::ivec3& voxel) {
  return static_cast<std::uint32_t>(grid.index(voxel));
}

}  // namespace

// Poses points outside the mesh, which move with its border.
class PosedTets::Border {
 public:
  //   rest_bins  bounding boxes of the tets at rest
  Border(const PosedTets& tets, const BoxBins& rest_bins)
      : tets_(tets),
        rest_bins_(rest_bins),
        border_(*tets.mesh_, tets.lattice_->volume().grid) {}

  // Returns the posed position of a rest point outside the mesh. The point keeps its distance from the mesh's border.
  // If another part of the mesh is near, the point uses at most half of the air between the two parts; the other half
  // is for tissue outside the other part's border.
  //   side  the point moves with the border of this side of seams; -1: with the nearest border
  FixedPoint carried(const glm::dvec3& rest, int side = -1) const {
    const Grid& grid = tets_.lattice_->volume().grid;
    const auto place = border_.nearest(rest, INFINITY, side);  // always exists, since every mesh and side has a border
    glm::dvec3 from(0), moved(0);  // rest position of the border's nearest point, and its motion; mm
    for (int i = 0; i < 3; ++i) {
      from += place->shares[i] * in_mm(tets_.mesh_->V, place->corners[i]);
      moved += place->shares[i] * in_mm(tets_.moved_, place->corners[i]);
    }
    const glm::dvec3 off = world_from_voxel(grid) * rest - from;
    const Eigen::Vector3d turned =
        rotation_of(*tets_.mesh_, tets_.moved_, place->tet) * Eigen::Vector3d(off.x, off.y, off.z);
    const auto at = [&](double share) {
      const glm::dvec3 shift = moved + share * glm::dvec3(turned.x(), turned.y(), turned.z()) - off;
      return tets_.lattice_->output().from_rest(rest + voxel_from_world(grid).linear * shift);
    };

    const glm::dvec3 whole = at(1);
    static_cast<void>(tets_.fixed(whole));  // throws Error if the point is too far away
    const double way = free_way(tets_.bins_, at(0), whole, place->corners, [&](int t) {
      const auto corners = tets_.posed_corners(t);
      std::array<glm::dvec3, 4> places;
      for (int i = 0; i < 4; ++i) places[i] = glm::dvec3(corners[i]) / double(kFixedOne);
      return places;
    });
    if (way == kBoth) return tets_.fixed(whole);
    // If the other part of the mesh is no nearer than at rest, the point keeps its distance from the border.
    const double rest_way = free_way(rest_bins_, voxel_from_world(grid) * from, rest, place->corners,
                                     [&](int t) { return tets_.rest_corners(t); });
    return tets_.fixed(way > rest_way - kRounding ? whole : at(std::min(1.0, kApart * way / rest_way)));
  }

  // Returns true if the border of tets on a side of seams is within a distance of a rest point.
  bool is_near(const glm::dvec3& rest, double mm, int side) const {
    return border_.nearest(rest, mm, side).has_value();
  }
  // Returns the side of seams of the border nearest to a rest point.
  int side_near(const glm::dvec3& rest) const { return tets_.mesh_->side[tet_near(rest)]; }
  // Returns the tet of the border nearest to a rest point.
  int tet_near(const glm::dvec3& rest) const { return border_.nearest(rest)->tet; }

 private:
  // Range of the search for another part of the mesh, as a multiple of the point's distance from the border. Two is
  // enough, since the point may use half of the air between the two parts.
  static constexpr double kBoth = 2;
  static constexpr double kRounding = 1.0 / 64;  // tolerance of the results of free_way()
  // Where two parts of the mesh face each other across air, a point of one part may lie at most this share of the way
  // to the middle of the gap. The share is below 1, so that the tissue of both parts never claims the same voxel
  // centre.
  static constexpr double kApart = 0.98;

  // Returns where the line from `from` through `to` first enters another part of the mesh: 0 at `from`, 1 at `to`,
  // kBoth: not before kBoth. A tet so flat that its bounding box contains no voxel centre is not found, but its
  // neighbours are.
  template <class CornersOf>
  double free_way(const BoxBins& bins, const glm::dvec3& from, const glm::dvec3& to, const std::array<int, 3>& own,
                  const CornersOf& corners_of) const {
    const glm::dvec3 end = from + kBoth * (to - from);
    std::vector<int> near;
    bins.meeting({glm::ivec3(glm::floor(glm::min(from, end))), glm::ivec3(glm::ceil(glm::max(from, end)))}, near);
    double way = kBoth;
    for (const int t : near) {
      const auto nodes = tets_.mesh_->T.row(t);
      if (std::any_of(own.begin(), own.end(), [&](int node) { return (nodes.array() == node).any(); })) continue;
      const auto corners = corners_of(t);
      const glm::dvec4 first = shares_in(corners, from), change = shares_in(corners, to) - first;
      double in = 0, out = way;  // range along the line in which all four barycentric coordinates are positive
      for (int i = 0; i < 4; ++i) {
        if (change[i] > 0) in = std::max(in, -first[i] / change[i]);
        else if (change[i] < 0) out = std::min(out, -first[i] / change[i]);
        else if (!(first[i] > 0)) out = 0;  // the line never enters the tet, or rounding has made the tet flat
      }
      if (in < out) way = in;
    }
    return way;
  }

  const PosedTets& tets_;
  const BoxBins& rest_bins_;
  MeshBorder border_;
};

// The result of posing one brick's tissue.
struct PosedTets::BrickOutcome {
  FixedPoint low{INT32_MAX}, high{INT32_MIN};  // bounding box of the brick's posed corners
  std::vector<Rider> riders;
  std::array<std::uint64_t, 8> across{};  // the brick's voxels inside tets of the other side of a seam
};

PosedTets::PosedTets(const TetMesh& mesh, const Eigen::MatrixX3d& posed, const PosedLattice& lattice,
                     TissueMask in_mesh, Progress& progress, const std::vector<std::uint16_t>* side)
    : mesh_(&mesh),
      lattice_(&lattice),
      in_mesh_(std::move(in_mesh)),
      side_(mesh.side.empty() ? nullptr : side),
      is_slid_over_(slid_over(mesh)),
      moved_(posed - mesh.V) {
  place_nodes();
  find_instead_of();
  const auto tets = static_cast<int>(mesh.T.rows());
  std::vector<VoxelRange> rest_boxes(tets), posed_boxes(tets);
  for (int t = 0; t < tets; ++t) {
    posed_boxes[t] = voxels_in_box(posed_corners(t));
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const glm::dvec3& corner : rest_corners(t)) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
    rest_boxes[t] = {glm::ivec3(glm::floor(low)), glm::ivec3(glm::ceil(high))};
  }
  bins_ = BoxBins(std::move(posed_boxes), kPosedBin);
  const BoxBins rest_bins(std::move(rest_boxes), TissueVoxels::kBrick);
  const Border border(*this, rest_bins);

  std::vector<BrickOutcome> outcomes(lattice.tissue().bricks().size());
  parallel_for(std::ssize(outcomes), 8, [&](std::int64_t begin, std::int64_t end) {
    for (auto brick = begin; brick < end && !progress.cancelled(); ++brick)
      run_brick(brick, rest_bins, border, outcomes[brick]);
  });
  progress.update("pose", 1);
  FixedPoint low(INT32_MAX), high(INT32_MIN);
  for (const BrickOutcome& outcome : outcomes) {
    low = glm::min(low, outcome.low);
    high = glm::max(high, outcome.high);
    riders_.insert(riders_.end(), outcome.riders.begin(), outcome.riders.end());
    if (side_) across_.push_back(outcome.across);
  }
  if (low.x <= high.x) posed_tissue_ = voxels_in_box(std::array{low, high});
  std::vector<VoxelRange> rider_boxes;
  for (const Rider& rider : riders_) rider_boxes.push_back(voxels_in_box(rider.corners));
  rider_bins_ = BoxBins(std::move(rider_boxes), kPosedBin);
}

bool PosedTets::is_in_mesh(const glm::ivec3& voxel) const {
  if (!lattice_->volume().grid.contains(voxel)) return false;
  const TissueVoxels& tissue = lattice_->tissue();
  const int brick = tissue.brick_at(voxel);
  return brick >= 0 && (in_mesh_[brick][voxel.z & 7] >> ((voxel.x & 7) + 8 * (voxel.y & 7)) & 1);
}

void PosedTets::find_instead_of() {
  const TissueVoxels& tissue = lattice_->tissue();
  instead_of_ = in_mesh_;
  parallel_for(std::ssize(in_mesh_), 64, [&](std::int64_t begin, std::int64_t end) {
    for (auto brick = begin; brick < end; ++brick) {
      const glm::ivec3 first = tissue.bricks()[brick].corner;
      bool borders = false;  // true: the brick is next to tissue that does not move with the mesh
      for_each_neighbour_brick(tissue, first,
                               [&](int near) { borders |= in_mesh_[near] != tissue.bricks()[near].mask; });
      if (!borders) continue;
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
        bool inside = true;
        for (int i = 0; i < 27 && inside; ++i) {
          const glm::ivec3 near = voxel + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
          inside = is_in_mesh(near) || lattice_->volume().at_or_air(near) == 0;
        }
        if (!inside) instead_of_[brick][voxel.z & 7] &= ~(std::uint64_t{1} << ((voxel.x & 7) + 8 * (voxel.y & 7)));
      });
    }
  });
}

void PosedTets::place_nodes() {
  const Grid& grid = lattice_->volume().grid;
  const AffineTransform voxel = voxel_from_world(grid);
  for (int i = 0; i < mesh_->V.rows(); ++i) {
    const glm::dvec3 at = voxel * in_mm(mesh_->V, i);
    rest_.push_back(glm::round(at * double(kFixedOne)) / double(kFixedOne));
    // The node's motion is added to its rounded rest position, so that a node that does not move stays there exactly.
    posed_.push_back(fixed(lattice_->output().from_rest(rest_[i] + voxel.linear * in_mm(moved_, i))));
  }
}

FixedPoint PosedTets::fixed(const glm::dvec3& at) const {
  if (!(std::abs(at.x) < kFurthest && std::abs(at.y) < kFurthest && std::abs(at.z) < kFurthest))
    throw Error("the pose moves the tissue too far away", "bending tissue",
                "check the pose and the rig, or use a coarser spacing");
  return {std::lrint(at.x * kFixedOne), std::lrint(at.y * kFixedOne), std::lrint(at.z * kFixedOne)};
}

std::array<FixedPoint, 4> PosedTets::posed_corners(int tet) const {
  const auto corners = mesh_->T.row(tet);
  return {posed_[corners[0]], posed_[corners[1]], posed_[corners[2]], posed_[corners[3]]};
}

std::array<glm::dvec3, 4> PosedTets::rest_corners(int tet) const {
  const auto corners = mesh_->T.row(tet);
  return {rest_[corners[0]], rest_[corners[1]], rest_[corners[2]], rest_[corners[3]]};
}

// Returns the posed position of a rest point inside a tet, by the tet's motion.
FixedPoint PosedTets::carried(int tet, const glm::dvec3& rest) const {
  const glm::dvec4 shares = shares_in(rest_corners(tet), rest);
  glm::dvec3 moved(0);
  for (int i = 0; i < 4; ++i) moved += shares[i] * in_mm(moved_, mesh_->T(tet, i));
  return fixed(lattice_->output().from_rest(rest + voxel_from_world(lattice_->volume().grid).linear * moved));
}

void PosedTets::run_brick(std::int64_t brick, const BoxBins& rest_bins, const Border& border,
                          BrickOutcome& outcome) const {
  const TissueVoxels& tissue = lattice_->tissue();
  const TissueVoxels::Brick& cells = tissue.bricks()[brick];
  const auto& mine = in_mesh_[brick];
  if (!shares(brick)) return;
  if (instead_of_[brick] != cells.mask) {
    PosedLattice::Corners room;
    const PosedLattice::Corners& corners = lattice_->corners(brick, room);
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - cells.corner;
      if (instead_of_[brick][v.z] >> (v.x + 8 * v.y) & 1) return;
      for (int i = 0; i < 8; ++i) {
        const FixedPoint& corner = corners[PosedLattice::place(v.x + (i & 1), v.y + (i >> 1 & 1), v.z + (i >> 2))];
        outcome.low = glm::min(outcome.low, corner);
        outcome.high = glm::max(outcome.high, corner);
      }
    });
  }

  // The tet that contains each corner of the brick's voxels at rest, and the tet that contains each voxel's centre.
  CornerTets tet_of, tet_at;  // tet_at: the tet that contains a voxel's centre
  tet_of.fill(-1), tet_at.fill(-1);
  std::vector<int> near;
  rest_bins.meeting({cells.corner - 1, cells.corner + kCorners}, near);
  for (int t : near) {
    const auto rest = rest_corners(t);
    std::array<FixedPoint, 4> from_brick;
    for (int i = 0; i < 4; ++i) from_brick[i] = FixedPoint((rest[i] - glm::dvec3(cells.corner)) * double(kFixedOne));
    rasterize_tet(from_brick, {glm::ivec3(0), glm::ivec3(TissueVoxels::kBrick - 1)},
                  [&](const glm::ivec3& v, int) { tet_at[PosedLattice::place(v.x, v.y, v.z)] = t; });
    for (FixedPoint& corner : from_brick) corner += kFixedOne / 2;
    rasterize_tet(from_brick, {glm::ivec3(0), glm::ivec3(kCorners - 1)},
                  [&](const glm::ivec3& v, int) { tet_of[PosedLattice::place(v.x, v.y, v.z)] = t; });
  }

  std::array<std::optional<FixedPoint>, kCorners * kCorners * kCorners> posed;
  tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
    const glm::ivec3 v = voxel - cells.corner;
    if (!(mine[v.z] >> (v.x + 8 * v.y) & 1)) return;
    Rider rider{voxel, {}};
    const int home = tet_at[PosedLattice::place(v.x, v.y, v.z)];
    const bool is_across = side_ && lies_across(place, voxel, home, border);
    if (is_across) outcome.across[v.z] |= std::uint64_t{1} << (v.x + 8 * v.y);
    bool rides = home < 0 || is_across;
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 corner = v + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      const int at = PosedLattice::place(corner.x, corner.y, corner.z);
      const glm::dvec3 rest = glm::dvec3(cells.corner + corner) - 0.5;
      if (!posed[at]) posed[at] = tet_of[at] >= 0 ? carried(tet_of[at], rest) : border.carried(rest);
      rides |= tet_of[at] < 0;
      rider.corners[i] = *posed[at];
      outcome.low = glm::min(outcome.low, *posed[at]);
      outcome.high = glm::max(outcome.high, *posed[at]);
    }
    if (!rides) return;
    if (side_) {
      const int side = is_across   ? (*side_)[place]
                       : home >= 0 ? mesh_->side[home]
                                   : border.side_near(glm::dvec3(voxel));
      rider = on_side(side, rider, tet_of, border);
    }
    outcome.riders.push_back(rider);
  });
}

// Returns true if a voxel must move with the border of its own side of seams, although it is in a tet of another side
// or outside the mesh, nearest to another side. False if no border of its own side is near: the two sides are attached
// to each other there.
//   place  the voxel's place in brick order    home  the tet that contains the voxel's centre; -1: none
bool PosedTets::lies_across(std::int64_t place, const glm::ivec3& voxel, int home, const Border& border) const {
  const int side = (*side_)[place];
  const glm::dvec3 centre(voxel);
  if ((home >= 0 ? mesh_->side[home] : border.side_near(centre)) == side) return false;
  const int tet = home >= 0 ? home : border.tet_near(centre);
  double longest = 0;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < i; ++k)
      longest = std::max(longest, (mesh_->V.row(mesh_->T(tet, i)) - mesh_->V.row(mesh_->T(tet, k))).norm());
  return border.is_near(centre, longest, side);
}

// Returns a rider all of whose corners move with one side of seams, so that it is not stretched from one to the other.
//   tet_of  the tet that contains each corner of the brick's voxels; -1: none
PosedTets::Rider PosedTets::on_side(int side, Rider rider, const CornerTets& tet_of, const Border& border) const {
  const glm::ivec3 v = rider.voxel & (TissueVoxels::kBrick - 1);
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 up(i & 1, i >> 1 & 1, i >> 2);
    const int tet = tet_of[PosedLattice::place(v.x + up.x, v.y + up.y, v.z + up.z)];
    if (tet < 0 || mesh_->side[tet] != side)
      rider.corners[i] = border.carried(glm::dvec3(rider.voxel + up) - 0.5, side);
  }
  return rider;
}

bool PosedTets::is_across(const glm::ivec3& voxel) const {
  if (across_.empty()) return false;
  const int brick = lattice_->tissue().brick_at(voxel);
  return across_[brick][voxel.z & 7] >> ((voxel.x & 7) + 8 * (voxel.y & 7)) & 1;
}

bool PosedTets::reaches(const VoxelRange& range) const {
  std::vector<int> found;
  bins_.meeting(range, found);
  if (found.empty()) rider_bins_.meeting(range, found);
  return !found.empty();
}

void PosedTets::rasterize(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const {
  const LabelVolume& volume = lattice_->volume();
  Claims claims(map, volume, priority, depth);
  std::vector<int> near;
  bins_.meeting(map.range, near);
  // Tets of bones over which flesh slides come last, since the flesh's tets may enter them by a fraction of a tet.
  std::stable_partition(near.begin(), near.end(), [&](int t) { return !is_slid_over_[t]; });
  for (int t : near) {
    const auto posed = posed_corners(t);
    std::optional<TetMap> tet;
    rasterize_tet(posed, map.range, [&](const glm::ivec3& voxel, int) {
      if (!tet) tet.emplace(posed, rest_corners(t));
      // Rounds the rest point to single precision, in which the inverse map stores it.
      const glm::dvec3 rest(glm::vec3(tet->rest(voxel)));
      const glm::ivec3 rest_voxel(glm::floor(rest + 0.5));
      if (!is_in_mesh(rest_voxel) || is_across(rest_voxel)) return;
      const CellClaim claim{voxel, rest, tet->posed_per_rest};
      if (is_slid_over_[t]) claims.claim_empty(index_of(volume.grid, rest_voxel), rest_voxel, claim, kSlides);
      else claims.claim(index_of(volume.grid, rest_voxel), rest_voxel, claim);
    });
  }
}

void PosedTets::rasterize_riders(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const {
  const LabelVolume& volume = lattice_->volume();
  Claims claims(map, volume, priority, depth);
  std::vector<int> near;
  rider_bins_.meeting(map.range, near);
  for (int r : near) {
    const Rider& rider = riders_[r];
    PosedCell(rider.corners.data(), 2, 4, rider.voxel).rasterize(map.range, [&](const CellClaim& claim) {
      claims.claim_empty(index_of(volume.grid, rider.voxel), rider.voxel, claim, kCrease);
    });
  }
}

}  // namespace limber
