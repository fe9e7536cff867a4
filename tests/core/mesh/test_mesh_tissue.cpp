// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/mesh_quality.h"
#include "core/mesh/mesh_tissue.h"

#include <csignal>
#include <set>
#include <thread>

#include <sys/mman.h>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/bones/bone_parts.h"
#include "core/bones/guess_bone_labels.h"
#include "core/mesh/crossings.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/volume/distance_transform.h"
#include "core/volume_io/tissue_table_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/random_bodies.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {

// A ball of soft tissue, 25 mm in radius, with two bones in it.
LabelVolume ball() {
  LabelVolume volume{{{30, 30, 30}, {2, 2, 2}, {-29, -29, -29}, glm::dmat3(1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count(), 0);
  glm::ivec3 v;
  for (v.z = 0; v.z < 30; ++v.z)
    for (v.y = 0; v.y < 30; ++v.y)
      for (v.x = 0; v.x < 30; ++v.x) {
        const glm::dvec3 p = glm::dvec3(v) * 2.0 - 29.0;
        if (glm::length(p) < 25) volume.at(v) = std::hypot(p.y, p.z) < 9 && std::abs(p.x) > 3 ? (p.x < 0 ? 2 : 4) : 1;
      }
  return volume;
}

// Checks what holds for every mesh: no flat or inverted tets, a closed border, and the regions of the volume.
void check_sound(const TissueMesh& result) {
  CHECK(find_fault(result.mesh, region_volumes(result.mesh)) == "");
  CHECK(std::ssize(result.mesh.region) == result.mesh.T.rows());
}

void check_sound(const TissueMesh& result, const LabelVolume& regions) {
  check_sound(result);
  const std::set<Label> there(regions.voxels.begin(), regions.voxels.end());
  for (const std::uint16_t region : result.mesh.region)
    if (region != TetMesh::kSoft && there.count(region + 1) == 0) FAIL_CHECK("a region that is not there");
}

// Checks the limits that the quality of every mesh must keep.
//   volume_error  largest allowed error of the mesh's volume, relative to that of the voxels
void check_quality(const MeshQuality& quality, double volume_error = 0.02) {
  CHECK(quality.near >= 0.999);
  CHECK(quality.volume_ratio == doctest::Approx(1).epsilon(volume_error));
  CHECK(quality.min_dihedral_degrees >= 2.5);
  CHECK(quality.share_below_5_degrees <= 0.0005);
}

MeshQuality quality_of(const TissueMesh& result, const LabelVolume& regions) {
  return limber::quality_of(result.mesh, regions.grid, TissueVoxels(regions));
}

struct Regions {
  LabelVolume volume;
  TissueVoxels tissue;
  std::vector<std::uint16_t> region;
  VoxelRegions voxels() const { return {volume.grid, tissue, region}; }
};

// Makes one region for each rig bone that has bone tissue.
Regions regions_of(LabelVolume volume, TissueTable table, const Armature& rig) {
  if (const auto guess = guess_bone_tissue(volume, table, rig)) {
    const double label = table.find(guess->label)->file_value;
    table = with_bones(std::move(table), {label});
  }
  Regions regions{std::move(volume), {}, {}};
  regions.tissue = TissueVoxels(regions.volume);
  const BoneParts parts = split_bones(regions.volume, regions.tissue, table, rig);
  for (const std::uint16_t part : parts.part_of)
    regions.region.push_back(part == 0 ? 0 : 1 + parts.parts[part - 1].bone);
  return regions;
}

// Returns the share of the mesh's border nodes that lie within 1.5 voxels of the tissue's border. Nodes at the faces of
// the grid, where the tissue is cut off, do not count.
double share_on_skin(const TetMesh& mesh, const LabelVolume& volume) {
  const VoxelBox box = tissue_box(volume, 12);
  const double voxel = volume.grid.spacing.x;
  std::vector<std::uint8_t> body(box.voxel_count());
  glm::ivec3 v;
  for (v.z = 0; v.z < box.size.z; ++v.z)
    for (v.y = 0; v.y < box.size.y; ++v.y)
      for (v.x = 0; v.x < box.size.x; ++v.x) body[box.index(box.lowest + v)] = volume.at(box.lowest + v) != 0;
  const std::vector<float> distance = signed_distance(box, body, volume.grid.spacing);
  // Interpolates the distance to the border. The border lies half a voxel from the centres on either side.
  const auto distance_at = [&](const glm::dvec3& place) {
    const glm::ivec3 low = glm::clamp(glm::ivec3(glm::floor(place)), box.lowest, box.lowest + box.size - 2);
    const glm::dvec3 part = glm::clamp(place - glm::dvec3(low), 0.0, 1.0);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 off(corner & 1, corner >> 1 & 1, corner >> 2);
      const double at = distance[box.index(low + off)];
      const glm::dvec3 weight = glm::mix(1.0 - part, part, glm::dvec3(off));
      sum += weight.x * weight.y * weight.z * (at + (at > 0 ? -0.5 : 0.5) * voxel);
    }
    return sum;
  };
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  const Eigen::MatrixX3i skin = boundary_of(mesh.T);
  const std::set<int> nodes(skin.data(), skin.data() + skin.size());
  int on = 0, all = 0;
  for (const int node : nodes) {
    const glm::dvec3 place = to_voxel * glm::dvec3(mesh.V(node, 0), mesh.V(node, 1), mesh.V(node, 2));
    const glm::dvec3 last(volume.grid.size - 2);
    if (glm::any(glm::lessThan(place, glm::dvec3(1))) || glm::any(glm::greaterThan(place, last))) continue;
    ++all;
    on += std::abs(distance_at(place)) <= 1.5 * voxel;
  }
  return double(on) / std::max(all, 1);
}

void check_body(const Regions& regions, const std::string& name, MeshSettings settings = {},
                double volume_error = 0.02) {
  const TissueMesh result = mesh_tissue(regions.voxels(), settings);
  const MeshQuality quality = limber::quality_of(result.mesh, regions.volume.grid, regions.tissue);
  MESSAGE(name, ", ", settings.spacing_mm, " mm: ", result.mesh.V.rows(), " nodes, ", result.mesh.T.rows(),
          " tets, covered ", 100 * quality.covered, " %, near ", 100 * quality.near, " %, volume ",
          quality.volume_ratio, ", smallest angle ", quality.min_dihedral_degrees, ", below 5 degrees ",
          100 * quality.share_below_5_degrees, " %, ", result.seconds, " s");
  CHECK(result.warning == "");
  check_sound(result);
  check_quality(quality, volume_error);
  if (volume_error < 0.1) {
    const double on_skin = share_on_skin(result.mesh, regions.volume);
    // If an edge is eight voxels long, more than 1 % of the nodes are further than 1.5 voxels away, at fingers and
    // folds.
    const bool coarse = settings.spacing_mm >= 8 * regions.volume.grid.spacing.x;
    MESSAGE("on the skin ", 100 * on_skin, " %");
    CHECK(on_skin >= (coarse ? 0.97 : 0.99));
  }
  // The surface does not cross itself.
  const Eigen::MatrixX3i skin = boundary_of(result.mesh.T);
  CHECK(crossing_pairs(result.mesh.V, skin).empty());
}

// A counter in shared memory, so that calls in child processes count too.
class SharedCount {
 public:
  SharedCount()
      : count_(static_cast<int*>(
            ::mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  ~SharedCount() { ::munmap(count_, sizeof(int)); }
  int next() const { return (*count_)++; }
  int count() const { return *count_; }

 private:
  int* count_;
};

}  // namespace

TEST_CASE("mesh tissue: a ball with two bones is meshed well, as it lies, with its three regions") {
  const LabelVolume regions = ball();
  const TissueMesh result = mesh_tissue(regions);
  CHECK(result.warning == "");
  check_sound(result, regions);
  check_quality(quality_of(result, regions));
  const auto volumes = region_volumes(result.mesh);
  CHECK(volumes.size() == 3);
  CHECK(volumes.count(1) + volumes.count(3) == 2);
  CHECK(result.mesh.V.colwise().maxCoeff().maxCoeff() < 29);
  // A fine mesh around a point has more tets, and is as good.
  MeshSettings fine;
  fine.fine_around = {{0, 0, 0}};
  const TissueMesh finer = mesh_tissue(regions, fine);
  CHECK(finer.warning == "");
  check_quality(quality_of(finer, regions));
  CHECK(finer.mesh.T.rows() > 3 * result.mesh.T.rows());
}

TEST_CASE("mesh tissue: TetGen fills the same surface where it is asked to") {
  const LabelVolume regions = ball();
  const TissueMesh result = mesh_tissue(regions, {.mesher = Mesher::tetgen});
  CHECK(result.mesher == Mesher::tetgen);
  CHECK(result.warning == "");
  check_sound(result, regions);
  check_quality(quality_of(result, regions));
}

TEST_CASE("mesh tissue: where TetGen crashes, hangs or fails the lattice's own tets stand, and that is said" *
          doctest::test_suite("slow")) {
  const LabelVolume regions = ball();
  const auto with = [&](double seconds, std::function<void()> at_start) {
    const SharedCount calls;
    MeshSettings settings{.mesher = Mesher::tetgen};
    settings.limits.seconds = seconds;
    settings.limits.at_start = [&] {
      calls.next();
      at_start();
    };
    const TissueMesh result = mesh_tissue(regions, settings);
    CHECK(calls.count() == 1);
    CHECK(result.mesher == Mesher::lattice);
    check_sound(result, regions);
    check_quality(quality_of(result, regions));
    return result.warning;
  };
  CHECK(with(120, [] { ::raise(SIGSEGV); }).find("TetGen failed on its surface: the process crashed (signal 11)") !=
        std::string::npos);
  CHECK(with(0.05, [] { std::this_thread::sleep_for(std::chrono::hours(1)); }).find("the process took too long") !=
        std::string::npos);
  CHECK(with(120, [] { std::_Exit(3); }).find("the process failed (exit code 3)") != std::string::npos);
}

TEST_CASE("mesh tissue: no voxels make no mesh, and no fuss") {
  LabelVolume regions = ball();
  std::fill(regions.voxels.begin(), regions.voxels.end(), Label{0});
  const TissueMesh result = mesh_tissue(regions);
  CHECK(result.mesh.T.rows() == 0);
  CHECK(result.warning == "");
  CHECK(mesh_tissue(regions, {.mesher = Mesher::tetgen}).mesh.T.rows() == 0);
}

TEST_CASE("mesh tissue: the same for one thread and for two") {
  const LabelVolume regions = ball();
  std::vector<TissueMesh> meshes;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    meshes.push_back(mesh_tissue(regions));
  }
  CHECK(meshes[0].mesh.V == meshes[1].mesh.V);
  CHECK(meshes[0].mesh.T == meshes[1].mesh.T);
  CHECK(meshes[0].mesh.region == meshes[1].mesh.region);
}

TEST_CASE("mesh tissue: the inside of a solid body has no air, whatever part of a voxel the lattice's spacing is") {
  LabelVolume block{{{40, 38, 36}, {1, 1, 1}, {0.3, 0.2, 0.1}, glm::dmat3(1)}, {}};
  block.voxels = ZeroedVector<Label>(block.grid.voxel_count(), 0);
  glm::ivec3 v;
  for (v.z = 3; v.z < 33; ++v.z)
    for (v.y = 3; v.y < 35; ++v.y)
      for (v.x = 3; v.x < 37; ++v.x) block.at(v) = v.x < 20 ? 1 : 2;
  for (double spacing = 2; spacing < 6.5; spacing *= 1.031) {
    INFO("spacing ", spacing, " voxels");
    const TissueMesh result = mesh_tissue(block, {.spacing_mm = spacing});
    CHECK(share_on_skin(result.mesh, block) >= 0.995);
    const Eigen::MatrixX3i skin = boundary_of(result.mesh.T);
    const std::set<int> nodes(skin.data(), skin.data() + skin.size());
    CHECK(2 * std::ssize(nodes) - skin.rows() == 4);  // V - E + F = 2, with 2 E = 3 F: one closed surface
  }
}

TEST_CASE("mesh tissue: a cancel is heard") {
  struct : Progress {
    void on_update(std::string_view stage, double) override {
      if (stage == "tetrahedra") cancel();
    }
  } progress;
  CHECK_THROWS_AS(mesh_tissue(ball(), {}, progress), Cancelled);
}

// LIMBER_RANDOM_BODIES sets the number of bodies; 300 take longer than a usual test run allows.
TEST_CASE("mesh tissue: random bodies are meshed, whatever they are" * doctest::test_suite("slow")) {
  const char* asked = std::getenv("LIMBER_RANDOM_BODIES");
  const unsigned count = asked ? unsigned(std::atoi(asked)) : 60;
  int by_tetgen = 0, fell_back = 0;
  unsigned with_voxels_out = 0;
  for (unsigned seed = 0; seed < count; ++seed) {
    const test::RandomBody body = test::random_body(seed);
    CAPTURE(seed);
    CAPTURE(body.kind);
    MeshSettings settings{.spacing_mm = 3.0 + seed % 7};
    if (seed % 3 == 0)
      settings.fine_around = {world_from_voxel(body.regions.grid) * (glm::dvec3(body.regions.grid.size) * 0.5)},
      settings.fine_radius_mm = 12;
    for (const Mesher mesher : {Mesher::lattice, Mesher::tetgen}) {
      if (mesher == Mesher::tetgen && seed % 4 != 0) continue;
      settings.mesher = mesher;
      const TissueMesh result = mesh_tissue(body.regions, settings);
      check_sound(result, body.regions);
      // On some tiny bodies, moving nodes to improve flat tets leaves a few voxels further from the mesh.
      const double voxels = double(TissueVoxels(body.regions).size());
      const double left_out = (1 - quality_of(result, body.regions).near) * voxels;
      CHECK(left_out <= std::max(20.0, 0.05 * voxels));
      with_voxels_out += left_out > std::max(4.0, 0.001 * voxels);
      CHECK(crossing_pairs(result.mesh.V, boundary_of(result.mesh.T)).empty());
      if (mesher == Mesher::lattice) CHECK(result.warning == "");
      by_tetgen += result.mesher == Mesher::tetgen;
      fell_back += result.warning != "";
      if (result.warning != "") MESSAGE("seed ", seed, ", ", body.kind, ": ", result.warning);
    }
  }
  CHECK(with_voxels_out <= std::max(2U, count / 20));
  MESSAGE(with_voxels_out, " bodies of which more than 0.1 % of the voxels lie further out");
  MESSAGE(count, " bodies by the lattice, ", by_tetgen, " by TetGen, which failed on ", fell_back);
  CHECK(by_tetgen > 5 * fell_back);
}

TEST_CASE("mesh tissue: the quality of a mesh with a fault is seen") {
  TetMesh mesh = mesh_tissue(ball()).mesh;
  auto volumes = region_volumes(mesh);
  CHECK(find_fault(mesh, volumes) == "");
  volumes[0] *= 1 + 1e-7;
  CHECK(find_fault(mesh, volumes) == "the mesh's volume differs from the surface's");
  volumes = region_volumes(mesh);
  std::swap(volumes[1], volumes[0]);
  CHECK(find_fault(mesh, volumes) == "a region's volume is not that of its surface");
  TetMesh turned = mesh;
  turned.T.col(0).row(5).swap(turned.T.col(1).row(5));
  CHECK(find_fault(turned, volumes) == "a tetrahedron is flat or inverted");
  TetMesh twice = mesh;
  twice.T.row(0) = twice.T.row(1);
  CHECK(find_fault(twice, volumes) != "");
}

TEST_CASE("mesh tissue: the procedural arm and body are meshed well, the arm also finer at its elbow" *
          doctest::test_suite("slow")) {
  const Phantom arm = make_arm_phantom();
  const Regions of_arm = regions_of(arm.volume, arm.tissues, arm.armature);
  check_body(of_arm, "procedural arm");
  MeshSettings fine;
  for (const Bone& bone : arm.armature.bones)
    if (bone.name.find("orearm") != std::string::npos) fine.fine_around.push_back(bone.head);
  REQUIRE(fine.fine_around.size() > 0);
  check_body(of_arm, "procedural arm, finer at the elbow", fine);
  const Phantom body = make_body_phantom();
  check_body(regions_of(body.volume, body.tissues, body.armature), "procedural body", {.spacing_mm = 12});
}

TEST_CASE("mesh tissue: the Visible Man's arm is meshed well at 12, 8 and 6 mm, and finer at its elbow" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  VolumeFile file = read_volume(test::shared_path("data/bender/man-arm-2mm.mha"));
  const Armature rig = read_armature(test::shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const Regions regions = regions_of(std::move(file.volume), merge_tissue_tables(file.tissues, nullptr), rig);
  for (const double spacing : {12.0, 8.0, 6.0}) check_body(regions, "Visible Man's arm", {.spacing_mm = spacing});
  for (const Bone& bone : rig.bones)
    if (bone.name == "Forearm")
      check_body(regions, "Visible Man's arm, finer at the elbow", {.fine_around = {bone.head}});
}

TEST_CASE("mesh tissue: arm and shoulder, two whole bodies and a knee from scans are meshed well" *
          doctest::test_suite("slow")) {
  struct Case {
    const char *name, *volume, *rig, *tissues;
    double spacing_mm;
  };
  const Case cases[] = {
      {"arm and shoulder", "data/bp3d/arm_shoulder_1mm_tissue.mha", "data/bp3d/arm_shoulder.armature.json",
       "data/bp3d/tissue.labels.json", 8},
      {"MakeHuman's body", "data/makehuman/body_4mm.nrrd", "data/makehuman/body.armature.json", nullptr, 12},
      {"body of structures", "data/bp3d/body_3mm_tissue.nrrd", "data/bp3d/body.armature.json",
       "data/bp3d/tissue.labels.json", 12},
      {"knee atlas", "data/spl/knee_seg.nrrd", nullptr, nullptr, 8},
  };
  NEEDS_SHARED("data/spl/knee_seg.nrrd");
  for (const Case& one : cases) {
    VolumeFile file = read_volume(test::shared_path(one.volume));
    if (!one.rig) {
      Regions soft{std::move(file.volume), {}, {}};
      soft.tissue = TissueVoxels(soft.volume);
      soft.region.assign(soft.tissue.size(), TetMesh::kSoft);
      // This body is cartilage and ligaments only: sheets that are thinner than the cells of the lattice.
      check_body(soft, one.name, {.spacing_mm = one.spacing_mm}, 0.4);
      continue;
    }
    TissueTable table = merge_tissue_tables(file.tissues, nullptr);
    if (one.tissues) {
      const TissueTable user = read_tissue_table(test::shared_path(one.tissues));
      table = merge_tissue_tables(file.tissues, &user);
    }
    check_body(regions_of(std::move(file.volume), table, read_armature(test::shared_path(one.rig))), one.name,
               {.spacing_mm = one.spacing_mm});
  }
}
