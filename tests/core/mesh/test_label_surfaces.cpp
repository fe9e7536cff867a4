// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/label_surfaces.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/export/surface_files.h"
#include "tests/support/program.h"
#include "tests/support/read_back.h"

using namespace limber;
using namespace limber::test;

namespace {

LabelVolume volume_of(const glm::ivec3& size, const std::function<int(const glm::ivec3&)>& label) {
  LabelVolume volume;
  volume.grid.size = size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) volume.voxels.push_back(static_cast<Label>(label({x, y, z})));
  return volume;
}

// Checks that each edge occurs once in each direction, and that the triangles around each vertex form one fan.
void check_manifold(const LabelSurface& surface) {
  std::map<std::pair<int, int>, int> next;  // the fans: (vertex, previous corner) -> next corner
  bool once = true;
  std::vector<int> fan(surface.vertex.size());
  for (const glm::ivec3& f : surface.F)
    for (int i = 0; i < 3; ++i) {
      once = once && next.emplace(std::pair(f[i], f[(i + 1) % 3]), f[(i + 2) % 3]).second;
      ++fan[f[i]];
    }
  CHECK(once);
  for (const auto& [edge, to] : next) CHECK(next.contains({edge.second, edge.first}));
  std::vector<int> start(surface.vertex.size(), -1);
  for (const auto& [edge, to] : next) start[edge.first] = edge.second;
  for (int v = 0; v < static_cast<int>(surface.vertex.size()); ++v) {
    int around = 0, at = start[v];
    REQUIRE(at >= 0);
    do {
      at = next.at({v, at});
      ++around;
    } while (at != start[v] && around <= fan[v]);
    CHECK(around == fan[v]);
  }
}

const LabelSurface& of_label(const LabelSurfaces& all, Label label) {
  return *std::find_if(all.surfaces.begin(), all.surfaces.end(),
                       [&](const LabelSurface& s) { return s.label == label; });
}

// Returns the triangles as sorted triples of vertices. Two tissues share the triangles of their common border, with
// opposite orientation.
std::set<std::vector<int>> triangles_of(const LabelSurface& surface) {
  std::set<std::vector<int>> set;
  for (const glm::ivec3& f : surface.F) {
    std::vector<int> corners = {surface.vertex[f.x], surface.vertex[f.y], surface.vertex[f.z]};
    std::sort(corners.begin(), corners.end());
    set.insert(corners);
  }
  return set;
}

}  // namespace

TEST_CASE(
    "label surfaces: a ball, a ring and a hollow ball have their Euler numbers, enclosed volumes are near the "
    "voxels'") {
  const auto solid =
      volume_of({14, 14, 14}, [](const glm::ivec3& v) { return glm::length(glm::dvec3(v) - 6.5) < 5 ? 3 : 0; });
  const LabelSurfaces ball = label_surfaces(solid);
  REQUIRE(ball.surfaces.size() == 1);
  CHECK(ball.surfaces[0].euler_number() == 2);
  check_manifold(ball.surfaces[0]);
  const double voxels = double(std::count(solid.voxels.begin(), solid.voxels.end(), Label{3}));
  CHECK(enclosed_volume(ball, ball.surfaces[0]) == doctest::Approx(voxels).epsilon(0.05));
  // Without relaxation, the surface is that of whole voxels.
  const LabelSurfaces plain = label_surfaces(volume_of({6, 6, 6},
                                                       [](const glm::ivec3& v) {
                                                         return glm::all(glm::greaterThan(v, glm::ivec3(0))) &&
                                                                glm::all(glm::lessThan(v, glm::ivec3(5)));
                                                       }),
                                             {.relaxations = 0});
  CHECK(enclosed_volume(plain, plain.surfaces[0]) == doctest::Approx(64));

  const auto ring = label_surfaces(volume_of({16, 16, 7}, [](const glm::ivec3& v) {
    const glm::dvec3 p = glm::dvec3(v) - glm::dvec3(7.5, 7.5, 3);
    return std::hypot(std::hypot(p.x, p.y) - 5, p.z) < 2.2 ? 1 : 0;
  }));
  CHECK(ring.surfaces[0].euler_number() == 0);
  check_manifold(ring.surfaces[0]);
  const auto shell = label_surfaces(volume_of({14, 14, 14}, [](const glm::ivec3& v) {
    const double r = glm::length(glm::dvec3(v) - 6.5);
    return r < 3 ? 2 : r < 5 ? 1 : 0;
  }));
  CHECK(of_label(shell, 1).euler_number() == 4);  // two closed surfaces: outside and inside
  CHECK(of_label(shell, 2).euler_number() == 2);
  // The surface of the inner tissue is the inner surface of the shell.
  const auto inner = triangles_of(of_label(shell, 2)), outer = triangles_of(of_label(shell, 1));
  CHECK(std::includes(outer.begin(), outer.end(), inner.begin(), inner.end()));
}

TEST_CASE(
    "label surfaces: voxels that touch by an edge or a corner are taken apart, and every edge lies in two triangles "
    "whatever the labels") {
  const auto edge = label_surfaces(volume_of({2, 2, 1}, [](const glm::ivec3& v) { return v.x == v.y ? 1 : 0; }));
  CHECK(edge.surfaces[0].euler_number() == 4);  // two balls: each adds 2
  check_manifold(edge.surfaces[0]);
  const auto corner =
      label_surfaces(volume_of({2, 2, 2}, [](const glm::ivec3& v) { return v.x == v.y && v.y == v.z ? 1 : 0; }));
  CHECK(corner.surfaces[0].euler_number() == 4);
  check_manifold(corner.surfaces[0]);
  const auto crossed = label_surfaces(volume_of({2, 2, 1}, [](const glm::ivec3& v) { return v.x == v.y ? 1 : 2; }));
  for (const LabelSurface& surface : crossed.surfaces) {
    CHECK(surface.euler_number() == 4);
    check_manifold(surface);
  }
  std::mt19937 random(11);
  for (int labels = 2; labels <= 4; ++labels)
    for (int i = 0; i < 12; ++i) {
      const auto noise = volume_of({5, 6, 4}, [&](const glm::ivec3&) { return static_cast<int>(random() % labels); });
      const LabelSurfaces all = label_surfaces(noise);
      double sum = 0;
      for (const LabelSurface& surface : all.surfaces) {
        check_manifold(surface);
        CHECK(surface.euler_number() % 2 == 0);
        sum += enclosed_volume(all, surface);
      }
      // Tissues share their borders, so their volumes add up to the volume of all tissues merged into one.
      auto merged = noise;
      for (Label& label : merged.voxels) label = label != 0;
      const LabelSurfaces whole = label_surfaces(merged, {.relaxations = 0}),
                          parts = label_surfaces(noise, {.relaxations = 0});
      double of_parts = 0;
      for (const LabelSurface& surface : parts.surfaces) of_parts += enclosed_volume(parts, surface);
      if (!whole.surfaces.empty())
        CHECK(of_parts == doctest::Approx(enclosed_volume(whole, whole.surfaces[0])).epsilon(0.02));
    }
  CHECK(label_surfaces(volume_of({2, 2, 2}, [](const glm::ivec3&) { return 0; })).surfaces.empty());
}

TEST_CASE("label surfaces: outside is outside on a mirrored grid, too, and spacing and origin are followed") {
  auto volume = volume_of({6, 6, 6}, [](const glm::ivec3& v) {
    return glm::all(glm::greaterThan(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, glm::ivec3(5)));
  });
  volume.grid.spacing = {1, 2, 3};
  volume.grid.origin = {100, 0, 0};
  volume.grid.direction[0] = {-1, 0, 0};
  const LabelSurfaces all = label_surfaces(volume, {.relaxations = 0});
  CHECK(enclosed_volume(all, all.surfaces[0]) == doctest::Approx(64 * 6));
  double least = 1e9;
  for (const int v : all.surfaces[0].vertex) least = std::min(least, all.V[v].x);
  CHECK(least == doctest::Approx(100 - 4.5));
}

TEST_CASE(
    "surfaces command: one OBJ with groups that share vertices, one glTF with a named node each, STL and PLY a file a "
    "tissue, watertight for VTK" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", tissues = folder / "tissues.json", nifti = folder / "v.nii.gz";
  REQUIRE(run_limber({"convert", volume, nifti}).exit_code == 0);
  const auto run = run_limber({"surfaces", volume, "--tissues", tissues, "-o", folder / "arm.obj"});
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("cortical bone") != std::string::npos);
  std::ifstream obj(folder / "arm.obj");
  std::set<std::string> groups;
  int vertices = 0, highest = 0;
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line);
    std::string first, group;
    words >> first;
    if (first == "v") ++vertices;
    if (first == "g" && words >> group) CHECK(groups.insert(group).second);
    for (int corner = 0; first == "f" && words >> corner;) highest = std::max(highest, corner);
  }
  CHECK(groups.size() > 8);
  CHECK(highest == vertices);
  READ_BACK("surface", folder / "arm.obj", nifti);

  REQUIRE(
      run_limber({"surfaces", volume, "--tissues", tissues, "--only", "skin,cortical bone", "-o", folder / "arm.ply"})
          .exit_code == 0);
  REQUIRE(run_limber({"convert", volume, folder / "all.stl", "--tissues", tissues}).exit_code == 0);
  int plys = 0, stls = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    plys += entry.path().extension() == ".ply";
    stls += entry.path().extension() == ".stl";
  }
  CHECK(plys == 2);
  CHECK(stls == static_cast<int>(groups.size()));
  READ_BACK("surface", folder / "arm-skin.ply", nifti);
  READ_BACK("surface", folder / "arm-cortical_bone.ply", nifti);
  READ_BACK("surface", folder / "all-skin.stl", nifti);
  REQUIRE(run_limber({"surfaces", volume, "--tissues", tissues, "-o", folder / "arm.glb"}).exit_code == 0);
  READ_BACK("surfaces", folder / "arm.glb", nifti);
  const auto wrong = run_limber({"surfaces", volume, "--tissues", tissues, "--only", "gills", "-o", folder / "x.stl"});
  CHECK(wrong.exit_code == 1);
  CHECK(run_limber({"surfaces", volume, "-o", folder / "x.xyz"}).exit_code == 1);
}
