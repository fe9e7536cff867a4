// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/posed_tets.h"

#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "tests/support/bent_tube.h"
#include "tests/support/kuhn_mesh.h"

using namespace limber;

namespace {

const std::vector<int> kPriority(65536, 0);

// A tube of tissue with its rest lattice, and a mesh around the tube that moves it.
struct Carried {
  test::BentTube tube;
  TissueVoxels tissue{tube.volume};
  PosedLattice lattice;
  TissueDepth depth{tissue, tube.volume.grid.spacing};
  TetMesh mesh;
  TissueMask all;

  explicit Carried(const Grid& grid = {}, const glm::dvec3& low = {-0.4, -0.3, -0.2},
                   const glm::dvec3& high = {23.3, 25.1, 44.6})
      : tube(test::bent_tube(grid)),
        lattice(tube.volume, tissue, tube.weights, {{}, {}}, Blend::Linear, glm::dvec3(1)),
        mesh(test::kuhn_mesh(tube.volume.grid, low, high, {4, 5, 9})) {
    for (const auto& brick : tissue.bricks()) all.push_back(brick.mask);
  }

  Eigen::MatrixX3d moved(const std::function<glm::dvec3(const glm::dvec3&)>& world_map) const {
    Eigen::MatrixX3d posed(mesh.V.rows(), 3);
    for (int i = 0; i < mesh.V.rows(); ++i) {
      const glm::dvec3 p = world_map({mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2)});
      posed.row(i) << p.x, p.y, p.z;
    }
    return posed;
  }
};

VoxelRange grown(const VoxelRange& range) { return {range.low - 2, range.high + 2}; }

InverseMap map_of(const PosedTets& tets, const VoxelRange& range, const TissueDepth* depth = nullptr) {
  InverseMap map;
  map.reset(range);
  tets.rasterize(map, kPriority, depth);
  tets.rasterize_riders(map, kPriority, depth);
  return map;
}

template <class Body>
void for_each_voxel(const VoxelRange& range, const Body& body) {
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x) body(glm::ivec3(x, y, z));
}

std::int64_t covered(const InverseMap& map) {
  return map.count() - std::count(map.cell.begin(), map.cell.end(), InverseMap::kNoCell);
}

}  // namespace

TEST_CASE("posed tets: a mesh at rest gives every voxel itself, exactly, and also what sticks out of it") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()})
    for (const bool small : {false, true}) {
      const Carried body = small ? Carried(grid, {5.2, 6.4, 4.3}, {17.9, 18.2, 39.7}) : Carried(grid);
      const PosedTets tets(body.mesh, body.mesh.V, body.lattice, body.all);
      CHECK((tets.rider_count() > 0) == small);
      const glm::ivec3 base = body.lattice.output().base;
      const InverseMap map = map_of(tets, grown(tets.posed_tissue()), &body.depth);
      bool same = true;
      for_each_voxel(map.range, [&](const glm::ivec3& v) {
        const std::int64_t at = map.index(v);
        const bool is_tissue = body.tube.volume.at_or_air(v + base) != 0;
        same &= is_tissue == (map.cell[at] != InverseMap::kNoCell);
        if (is_tissue)
          same &= map.cell[at] == body.tube.volume.grid.index(v + base) && map.rest[at] == glm::vec3(v + base);
      });
      CHECK(same);
      CHECK(covered(map) == body.tissue.size());
      CHECK(map.lost.empty());

      VoxelRange tissue{glm::ivec3(1000), glm::ivec3(-1000)};
      body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
        tissue = {glm::min(tissue.low, v - base), glm::max(tissue.high, v - base)};
      });
      CHECK(tets.posed_tissue().low == tissue.low);
      CHECK(tets.posed_tissue().high == tissue.high);
    }
}

TEST_CASE(
    "posed tets: an affine motion of the mesh is the affine motion of its voxels, of those that stick out as of the "
    "others' rotation") {
  const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 0.4, -0.3))));
  const glm::dmat3 stretch(1.2, 0.05, 0, 0, 0.9, 0, 0.02, 0, 1.1);
  for (const bool small : {false, true}) {
    const Carried body = small ? Carried({}, {5.2, 6.4, 4.3}, {17.9, 18.2, 39.7}) : Carried();
    const glm::dmat3 linear = small ? turn : turn * stretch;
    const AffineTransform world{linear, {3.3, -7.1, 12.9}};
    const PosedTets tets(body.mesh, body.moved([&](const glm::dvec3& p) { return world * p; }), body.lattice, body.all);
    const InverseMap map = map_of(tets, grown(tets.posed_tissue()));
    const glm::dmat3 back = glm::inverse(linear);
    double furthest = 0;
    std::int64_t wrong = 0;
    for_each_voxel(map.range, [&](const glm::ivec3& v) {
      const glm::dvec3 rest = back * (glm::dvec3(v + body.lattice.output().base) - world.offset);
      const glm::dvec3 off = glm::abs(glm::fract(rest) - 0.5);
      const std::int64_t at = map.index(v);
      const bool is_tissue = body.tube.volume.at_or_air(glm::ivec3(glm::floor(rest + 0.5))) != 0;
      if (map.cell[at] != InverseMap::kNoCell)
        furthest = std::max(furthest, glm::length(glm::dvec3(map.rest[at]) - rest));
      if (is_tissue != (map.cell[at] != InverseMap::kNoCell) && std::min({off.x, off.y, off.z}) > 1e-3) ++wrong;
    });
    CHECK(furthest < 1e-3);
    CHECK(wrong == 0);
    CHECK(map.lost.empty());
    CHECK(covered(map) == doctest::Approx(body.tissue.size() * glm::determinant(linear)).epsilon(0.01));
  }
}

TEST_CASE("posed tets: a bent bar has no holes, keeps its volume, and each voxel comes from where the bend says") {
  const Carried body;
  // Bends the z axis onto a circle of radius 40 about the x direction through y = 52. Volume is kept at y = 12, the
  // tube's middle.
  const auto bend = [](const glm::dvec3& p) {
    const double angle = (p.z - 20) / 40, radius = 52 - p.y;
    return glm::dvec3(p.x, 52 - radius * std::cos(angle), 20 + radius * std::sin(angle));
  };
  const auto unbend = [](const glm::dvec3& p) {
    return glm::dvec3(p.x, 52 - std::hypot(52 - p.y, p.z - 20), 20 + 40 * std::atan2(p.z - 20, 52 - p.y));
  };
  const PosedTets tets(body.mesh, body.moved(bend), body.lattice, body.all);
  const InverseMap map = map_of(tets, grown(tets.posed_tissue()), &body.depth);
  double furthest = 0;
  std::int64_t holes = 0;
  for_each_voxel({map.range.low + 1, map.range.high - 1}, [&](const glm::ivec3& v) {
    const std::int64_t at = map.index(v);
    if (map.cell[at] != InverseMap::kNoCell)
      return void(furthest = std::max(furthest, glm::length(glm::dvec3(map.rest[at]) -
                                                            unbend(glm::dvec3(v + body.lattice.output().base)))));
    int around = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int step : {-1, 1}) {
        glm::ivec3 near = v;
        near[axis] += step;
        around += map.cell[map.index(near)] != InverseMap::kNoCell;
      }
    holes += around == 6;
  });
  CHECK(furthest < 0.25);  // voxels; each tet edge of five voxels replaces an arc of radius 40
  CHECK(holes == 0);
  CHECK(map.lost.empty());
  CHECK(covered(map) == doctest::Approx(body.tissue.size()).epsilon(0.02));
}

TEST_CASE("posed tets: the map is the same in one piece, in tiles, and with two threads") {
  const Carried body({}, {5.2, 6.4, 4.3}, {17.9, 18.2, 39.7});
  const auto twist = [](const glm::dvec3& p) {
    const double angle = p.z / 25;
    const glm::dvec2 off(p.x - 11, p.y - 12);
    return glm::dvec3(11 + std::cos(angle) * off.x - std::sin(angle) * off.y,
                      12 + std::sin(angle) * off.x + std::cos(angle) * off.y, p.z);
  };
  std::vector<InverseMap> whole;
  for (int threads : {1, 2}) {
    ThreadCount limit(threads);
    const PosedTets tets(body.mesh, body.moved(twist), body.lattice, body.all);
    whole.push_back(map_of(tets, grown(tets.posed_tissue()), &body.depth));
    bool same = true;
    for (glm::ivec3 low = whole[0].range.low; low.z <= whole[0].range.high.z; low.z += 7) {
      const VoxelRange tile = intersect({low, {low.x + 11, low.y + 100, low.z + 6}}, whole[0].range);
      const InverseMap part = map_of(tets, tile, &body.depth);
      for_each_voxel(tile, [&](const glm::ivec3& v) {
        const std::int64_t a = part.index(v), b = whole[0].index(v);
        same &= part.cell[a] == whole[0].cell[b] && part.flags[a] == whole[0].flags[b];
        if (part.cell[a] != InverseMap::kNoCell)
          same &= part.rest[a] == whole[0].rest[b] && part.posed_per_rest[a] == whole[0].posed_per_rest[b];
      });
    }
    CHECK(same);
  }
  CHECK(whole[0].cell == whole[1].cell);
  CHECK(whole[0].rest == whole[1].rest);
  CHECK(covered(whole[0]) > 0.97 * body.tissue.size());
}

TEST_CASE(
    "posed tets: of two parts that come to lie in one place only strangers count as overlap, and the deeper stays") {
  Carried body;
  // Pushes the upper half down into the lower one, so that both parts claim each voxel of the overlap.
  const auto push = [](const glm::dvec3& p) {
    return p.z > 25 ? p - glm::dvec3(0, 0, 12) : p.z > 20 ? p - glm::dvec3(0, 0, 12 * (p.z - 20) / 5) : p;
  };
  const PosedTets tets(body.mesh, body.moved(push), body.lattice, body.all);
  const InverseMap map = map_of(tets, grown(tets.posed_tissue()), &body.depth);
  CHECK(map.lost.size() > 500);
  std::int64_t inverted = 0, overlap = 0;
  for (std::int64_t i = 0; i < map.count(); ++i) {
    overlap += (map.flags[i] & InverseMap::kOverlap) != 0;
    inverted += (map.flags[i] & InverseMap::kInverted) != 0;
  }
  CHECK(overlap > 500);
  CHECK(inverted == 0);  // a voxel prefers a tet that is not inverted
}

TEST_CASE(
    "posed tets: what sticks out of two parts that are pressed together is pressed flat, and takes no place twice") {
  // Voxels stick out of the lower part's top and of the upper part's bottom, further than the remaining gap is wide. In
  // the first case they reach into the other part's mesh, in the second into the other part's voxels that stick out, in
  // the third into both.
  for (const auto& [top, bottom, air] :
       {std::array{20.2, 27.2, 0.1}, std::array{19.6, 27.2, 0.8}, std::array{19.7, 27.3, 0.9}}) {
    CAPTURE(air);
    Carried body;
    const auto below = test::kuhn_mesh(body.tube.volume.grid, {-0.4, -0.3, -0.2}, {23.3, 25.1, top}, {4, 5, 5});
    const auto above = test::kuhn_mesh(body.tube.volume.grid, {-0.4, -0.3, bottom}, {23.3, 25.1, 44.6}, {4, 5, 4});
    body.mesh = below;
    body.mesh.V.conservativeResize(below.V.rows() + above.V.rows(), 3);
    body.mesh.V.bottomRows(above.V.rows()) = above.V;
    body.mesh.T.conservativeResize(below.T.rows() + above.T.rows(), 4);
    body.mesh.T.bottomRows(above.T.rows()) = above.T.array() + int(below.V.rows());
    body.mesh.region.insert(body.mesh.region.end(), above.region.begin(), above.region.end());
    TissueMask part(body.all.size(), std::array<std::uint64_t, 8>{});
    std::int64_t tissue = 0;
    body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      if (v.z > 20 && v.z < 27) return;
      part[body.tissue.brick_at(v)][v.z & 7] |= std::uint64_t{1} << ((v.x & 7) + 8 * (v.y & 7));
      ++tissue;
    });
    const double closed = bottom - top - air;
    const PosedTets tets(body.mesh,
                         body.moved([&](const glm::dvec3& p) { return p.z > 24 ? p - glm::dvec3(0, 0, closed) : p; }),
                         body.lattice, part);
    CHECK(tets.rider_count() > 100);
    const InverseMap map = map_of(tets, grown(tets.posed_tissue()), &body.depth);
    CHECK(map.lost.empty());
    CHECK(std::none_of(map.flags.begin(), map.flags.end(),
                       [](std::uint8_t flags) { return flags & InverseMap::kInverted; }));
    CHECK(covered(map) > 0.93 * double(tissue));  // all voxels but about one layer of each part
  }
}

TEST_CASE("posed tets: where a mesh carries only a part, mesh and lattice meet without gap or overlap") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    Carried body(grid, {-0.4, -0.3, 17.7}, {23.3, 25.1, 33.2});
    const RigidTransform motion = rotation_about({4, 5, 6}, glm::angleAxis(0.6, glm::normalize(glm::dvec3(1, 2, -1))));
    const PosedLattice lattice(body.tube.volume, body.tissue, body.tube.weights, {motion, motion}, Blend::Linear,
                               glm::dvec3(1));
    TissueMask part(body.all.size(), std::array<std::uint64_t, 8>{});
    body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      if (v.z >= 19 && v.z <= 31)
        part[body.tissue.brick_at(v)][v.z & 7] |= std::uint64_t{1} << ((v.x & 7) + 8 * (v.y & 7));
    });
    const PosedTets tets(body.mesh, body.moved([&](const glm::dvec3& p) { return motion * p; }), lattice, part);
    CHECK(tets.rider_count() == 0);
    VoxelRange range;
    std::vector<std::int64_t> bricks;
    for (std::int64_t b = 0; b < std::ssize(body.tissue.bricks()); ++b) {
      const auto& box = lattice.bounds(b);
      const VoxelRange voxels{box.low >> 16, (box.high >> 16) + 1};
      range = b == 0 ? voxels : VoxelRange{glm::min(range.low, voxels.low), glm::max(range.high, voxels.high)};
      bricks.push_back(b);
    }
    InverseMap alone, joined;
    alone.reset(range);
    joined.reset(range);
    rasterize_cells(alone, lattice, bricks, kPriority, &body.depth);
    tets.rasterize(joined, kPriority, &body.depth);
    rasterize_cells(joined, lattice, bricks, kPriority, &body.depth, &tets.instead_of());
    CHECK(joined.lost.empty());
    std::int64_t differ = 0;
    double furthest = 0;
    for (std::int64_t i = 0; i < alone.count(); ++i) {
      differ += (alone.cell[i] == InverseMap::kNoCell) != (joined.cell[i] == InverseMap::kNoCell);
      if (alone.cell[i] != InverseMap::kNoCell && joined.cell[i] != InverseMap::kNoCell)
        furthest = std::max(furthest, double(glm::length(alone.rest[i] - joined.rest[i])));
    }
    CHECK(differ <= 2);  // at voxel centres on the border, where rounding decides
    CHECK(furthest < 1e-3);
  }
}

TEST_CASE("posed tets: along a seam each voxel moves with its own side, however roughly the mesh follows the seam") {
  const Carried body;
  const Grid& grid = body.tube.volume.grid;
  // Two boxes that touch at x = 12, and a seam that waves around this plane by up to 2 voxels.
  TetMesh mesh = test::kuhn_mesh(grid, {-0.4, -0.3, -0.2}, {11.9, 25.1, 44.6}, {2, 5, 9});
  const TetMesh other = test::kuhn_mesh(grid, {12.1, -0.3, -0.2}, {23.3, 25.1, 44.6}, {2, 5, 9});
  const Eigen::Index nodes = mesh.V.rows(), tets = mesh.T.rows();
  mesh.V.conservativeResize(nodes + other.V.rows(), 3);
  mesh.V.bottomRows(other.V.rows()) = other.V;
  mesh.T.conservativeResize(tets + other.T.rows(), 4);
  mesh.T.bottomRows(other.T.rows()) = other.T.array() + static_cast<int>(nodes);
  mesh.region.insert(mesh.region.end(), other.region.begin(), other.region.end());
  mesh.side.assign(mesh.T.rows(), 0);
  std::fill(mesh.side.begin() + tets, mesh.side.end(), 1);
  std::vector<std::uint16_t> side(body.tissue.size());
  body.tissue.for_each(
      [&](std::int64_t place, const glm::ivec3& v) { side[place] = v.x > 12 + 2 * std::sin(0.7 * v.z + 0.4 * v.y); });

  for (const int apart : {0, 40}) {
    Eigen::MatrixX3d posed = mesh.V;
    posed.bottomRows(other.V.rows()).col(0).array() += apart * grid.spacing.x;
    const PosedTets tets(mesh, posed, body.lattice, body.all, no_progress(), &side);
    const InverseMap map = map_of(tets, grown(tets.posed_tissue()), &body.depth);
    std::int64_t misplaced = 0;
    body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      const glm::ivec3 at = v + glm::ivec3(side[place] ? apart : 0, 0, 0) - body.lattice.output().base;
      misplaced += map.cell[map.index(at)] != grid.index(v);
    });
    CHECK(misplaced == 0);
    CHECK(covered(map) == body.tissue.size());
    CHECK(map.lost.empty());
  }
}
