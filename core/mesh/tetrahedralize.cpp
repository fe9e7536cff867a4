// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/tetrahedralize.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <unordered_map>

#include <tetgen.h>

#include "core/platform/child_process.h"

namespace limber {

namespace {

using Row = std::array<int, 3>;

struct Polyhedra {
  std::vector<double> points;  // coordinates x, y, z of each point, one after the other
  std::vector<Row> triangles;
};

// The header of the message that the child process sends. The points (x, y, z) and tets follow.
struct Head {
  int problem;  // TetGen's error number; 0: no error
  int points, tets;
};

std::string name_of_problem(int code) {
  switch (code) {
    case 1: return "TetGen ran out of memory";
    case 3: return "the surface crosses itself";
    case 4: return "the surface has a detail too small for TetGen";
    case 5: return "two facets of the surface lie too close together";
    default: return "TetGen stopped with error " + std::to_string(code);
  }
}

// Copies points and triangles into TetGen's own structure. The structure's destructor deletes as many facets as
// numberoffacets says, so numberoffacets is increased facet by facet, in case memory runs out halfway.
void fill(tetgenio& in, const Polyhedra& input) {
  in.pointlist = new REAL[input.points.size()];
  in.numberofpoints = static_cast<int>(input.points.size() / 3);
  std::copy(input.points.begin(), input.points.end(), in.pointlist);
  in.facetlist = new tetgenio::facet[input.triangles.size()];
  for (const Row& triangle : input.triangles) {
    tetgenio::facet& facet = in.facetlist[in.numberoffacets++];
    tetgenio::init(&facet);
    facet.polygonlist = new tetgenio::polygon[1];
    facet.numberofpolygons = 1;
    tetgenio::init(facet.polygonlist);
    facet.polygonlist->vertexlist = new int[3];
    facet.polygonlist->numberofvertices = 3;
    std::copy(triangle.begin(), triangle.end(), facet.polygonlist->vertexlist);
  }
}

bool tetgen_in_child(const Polyhedra& input, const char* switches, const Send& send) {
  tetgenio in, out;
  Head head{};
  try {
    fill(in, input);
    std::string words = switches;
    tetrahedralize(words.data(), &in, &out);
    head = {0, out.numberofpoints, out.numberoftetrahedra};
    if (out.numberofcorners != 4) return false;
  } catch (int problem) {
    head.problem = problem;
  } catch (const std::bad_alloc&) {
    head.problem = 1;
  }
  send(&head, sizeof head);
  send(out.pointlist, sizeof(REAL) * 3 * head.points);
  send(out.tetrahedronlist, sizeof(int) * 4 * head.tets);
  return true;
}

struct Answer {
  std::vector<double> points;
  Eigen::MatrixX4i T;  // node indices of each tet, positively oriented
  std::string failure;
};

Answer run_tetgen(const Polyhedra& input, const char* switches, const TetrahedralizeLimits& limits,
                  const Progress& progress) {
  const double seconds = limits.seconds + limits.seconds_per_triangle * double(input.triangles.size());
  const ChildLimits child{seconds, 4 * seconds, limits.memory_bytes};
  const ChildAnswer answer = run_in_child(
      [&](const Send& send) {
        if (limits.at_start) limits.at_start();
        return tetgen_in_child(input, switches, send);
      },
      limits.memory_bytes, child, [&] { return progress.cancelled(); });
  if (answer.cancelled) throw Cancelled();
  if (!answer.sent) return {{}, {}, answer.failure};
  Head head;
  if (answer.sent->size() < sizeof head) return {{}, {}, "TetGen ended without a result"};
  std::memcpy(&head, answer.sent->data(), sizeof head);
  if (head.problem != 0) return {{}, {}, name_of_problem(head.problem)};
  const std::size_t point_bytes = sizeof(double) * 3 * head.points, tet_bytes = sizeof(int) * 4 * head.tets;
  if (head.points < 0 || head.tets <= 0 || answer.sent->size() != sizeof head + point_bytes + tet_bytes)
    return {{}, {}, "TetGen ended without a result"};

  Answer result;
  result.points.resize(3 * static_cast<std::size_t>(head.points));
  std::memcpy(result.points.data(), answer.sent->data() + sizeof head, point_bytes);
  std::vector<int> corners(4 * static_cast<std::size_t>(head.tets));
  std::memcpy(corners.data(), answer.sent->data() + sizeof head + point_bytes, tet_bytes);
  result.T.resize(head.tets, 4);
  for (int tet = 0; tet < head.tets; ++tet) {
    const int* c = &corners[4 * static_cast<std::size_t>(tet)];
    for (int i = 0; i < 4; ++i)
      if (c[i] < 0 || c[i] >= head.points) return {{}, {}, "TetGen returned tetrahedra with nodes that do not exist"};
    result.T.row(tet) << c[0], c[1], c[2], c[3];
  }
  return result;
}

struct RowHash {
  std::size_t operator()(const Row& row) const {
    std::uint64_t mixed = 0;
    for (const int corner : row)
      mixed = (mixed ^ static_cast<std::uint32_t>(corner)) * 0x9e3779b97f4a7c15u, mixed ^= mixed >> 29;
    return mixed;
  }
};

Row sorted(Row row) {
  std::sort(row.begin(), row.end());
  return row;
}

// Returns true if two triangles with the same corners have the same orientation: b is a with its corners rotated.
bool same_way(const Row& a, const Row& b) {
  const auto start = std::find(b.begin(), b.end(), a[0]) - b.begin();
  return b[(start + 1) % 3] == a[1];
}

// Finds the region of every tet from the triangles around it. Returns an empty string, or why it failed (for example: a
// triangle is missing, or two triangles disagree).
std::string find_regions(const Eigen::MatrixX4i& T, const std::vector<Row>& triangles,
                         const std::vector<std::array<std::uint16_t, 2>>& sides, std::vector<std::uint16_t>& region) {
  std::unordered_map<Row, int, RowHash> triangle_of;
  triangle_of.reserve(2 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!triangle_of.emplace(sorted(triangles[i]), static_cast<int>(i)).second)
      return "the surface contains a triangle twice";

  const auto neighbours = neighbours_of(T);
  std::vector<int> found(triangles.size(), 0);
  std::vector<std::int32_t> known(T.rows(), -1);
  std::vector<int> front;
  // First finds the walls, which are the tets' faces that are triangles of the surface, and gives each tet with a wall
  // its region. Then spreads regions from tet to tet through faces that are not walls.
  std::vector<std::array<bool, 4>> wall(T.rows(), {false, false, false, false});
  for (int tet = 0; tet < T.rows(); ++tet)
    for (int face = 0; face < 4; ++face) {
      const Row corners{T(tet, kTetFaces[face][0]), T(tet, kTetFaces[face][1]), T(tet, kTetFaces[face][2])};
      const auto at = triangle_of.find(sorted(corners));
      if (at == triangle_of.end()) {
        if (neighbours[tet][face] < 0) return "the tetrahedra end where the surface does not";
        continue;
      }
      wall[tet][face] = true;
      const bool behind = same_way(corners, triangles[at->second]);
      found[at->second] |= behind ? 1 : 2;
      const int here = sides[at->second][behind];
      if (known[tet] >= 0 && known[tet] != here) return "a tetrahedron lies in two regions";
      if (known[tet] < 0) front.push_back(tet);
      known[tet] = here;
    }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const bool open_front = sides[i][0] == RegionSurface::kAir, open_back = sides[i][1] == RegionSurface::kAir;
    if ((!(found[i] & 2) && !open_front) || (!(found[i] & 1) && !open_back))
      return "a triangle of the surface is missing";
  }
  for (std::size_t next = 0; next < front.size(); ++next) {
    const int tet = front[next];
    for (int face = 0; face < 4; ++face) {
      const int other = neighbours[tet][face];
      if (other < 0 || wall[tet][face]) continue;
      if (known[other] >= 0 && known[other] != known[tet]) return "the surface does not separate two regions";
      if (known[other] < 0) known[other] = known[tet], front.push_back(other);
    }
  }
  if (static_cast<Eigen::Index>(front.size()) != T.rows()) return "a tetrahedron lies in no region";
  region.assign(known.begin(), known.end());
  return {};
}

bool finite(const Eigen::MatrixX3d& V) { return V.size() == 0 || V.allFinite(); }

std::vector<double> xyz_of(const Eigen::MatrixX3d& V) {
  std::vector<double> points(V.size());
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(points.data(), V.rows(), 3) = V;
  return points;
}

bool starts_with(const std::vector<double>& points, const std::vector<double>& beginning) {
  return points.size() >= beginning.size() && std::equal(beginning.begin(), beginning.end(), points.begin());
}

}  // namespace

Tetrahedralized tetrahedralize_inside(const RegionSurface& surface, const TetrahedralizeLimits& limits,
                                      const Progress& progress) {
  if (surface.F.rows() == 0) return {std::nullopt, "the surface is empty"};
  if (!finite(surface.V)) return {std::nullopt, "the surface has positions that are not finite numbers"};
  Polyhedra input{xyz_of(surface.V), {}};
  for (const auto& f : surface.F.rowwise()) input.triangles.push_back({f[0], f[1], f[2]});
  // TetGen's switches: p = fill a surface; q2/0 = circumspheres of at most twice the shortest edge, no bound on angles;
  // Y = add nothing on the surface; M = do not merge coplanar triangles; J = keep the nodes' numbers; Q = print
  // nothing.
  Answer answer = run_tetgen(input, "pq2/0YMJQ", limits, progress);
  if (!answer.failure.empty()) return {std::nullopt, std::move(answer.failure)};
  if (!starts_with(answer.points, input.points)) return {std::nullopt, "TetGen moved nodes of the surface"};

  std::vector<std::uint16_t> region;
  if (std::string failure = find_regions(answer.T, input.triangles, surface.sides, region); !failure.empty())
    return {std::nullopt, std::move(failure)};

  // Removes the tets in pockets of air, and the nodes that belong to no other tets. All nodes of the surface stay, and
  // come first.
  std::vector<int> new_number(answer.points.size() / 3, -1);
  int nodes = static_cast<int>(surface.V.rows());
  for (int i = 0; i < nodes; ++i) new_number[i] = i;
  TetMesh mesh;
  mesh.T.resize(std::count_if(region.begin(), region.end(), [](auto r) { return r != RegionSurface::kAir; }), 4);
  for (Eigen::Index tet = 0; tet < answer.T.rows(); ++tet) {
    if (region[tet] == RegionSurface::kAir) continue;
    for (int i = 0; i < 4; ++i) {
      int& number = new_number[answer.T(tet, i)];
      if (number < 0) number = nodes++;
      mesh.T(std::ssize(mesh.region), i) = number;
    }
    mesh.region.push_back(region[tet]);
  }
  mesh.V.resize(nodes, 3);
  for (std::size_t i = 0; i < new_number.size(); ++i)
    if (new_number[i] >= 0)
      mesh.V.row(new_number[i]) << answer.points[3 * i], answer.points[3 * i + 1], answer.points[3 * i + 2];
  for (const auto& tet : mesh.T.rowwise())
    if (signed_volume(mesh.V, tet) <= 0) return {std::nullopt, "a tetrahedron is flat"};
  return {std::move(mesh), {}};
}

}  // namespace limber
