// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares meshing with CGAL's Mesh_3 [Jamin, Alliez, Yvinec, Boissonnat, CGALmesh: a generic framework for Delaunay
// mesh generation, ACM TOMS 2015] on the same regions, on one thread: CPU time per tet, and the quality of the tets.
//   limber_mesh_cgal [VOLUME RIG [SPACING_MM]]     without a volume: the procedural arm
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include "core/base/parallel.h"
#include "core/bones/bone_parts.h"
#include "core/bones/guess_bone_labels.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/mesh_tissue.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/tissue_table_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/bench/cpu_seconds.h"

using namespace limber;
using bench::cpu_seconds;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

void print(const char* who, const TetMesh& mesh, const VoxelRegions& voxels, double seconds) {
  const MeshQuality quality = quality_of(mesh, voxels.grid, voxels.tissue);
  std::printf(
      "%-28s %8ld tets %7.2f s CPU %7.2f us/tet  smallest angle %5.2f  below 5 degrees %.4f %%  covered %.3f %%\n", who,
      long(mesh.T.rows()), seconds, 1e6 * seconds / double(mesh.T.rows()), quality.min_dihedral_degrees,
      100 * quality.share_below_5_degrees, 100 * quality.covered);
}

template <class Perturb, class Exude>
TetMesh mesh_by_cgal(const LabelVolume& regions, double spacing, const Perturb& perturb, const Exude& exude,
                     double& seconds) {
  const double start = cpu_seconds();
  const AffineTransform to_voxel = voxel_from_world(regions.grid), to_world = world_from_voxel(regions.grid);
  CGAL::Bbox_3 box;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p =
        to_world * (glm::dvec3(regions.grid.size) * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2));
    box += CGAL::Bbox_3(p.x - 1, p.y - 1, p.z - 1, p.x + 1, p.y + 1, p.z + 1);
  }
  const auto region_at = [&](const Kernel::Point_3& p) {
    return int(regions.at_or_air(glm::ivec3(glm::floor(to_voxel * glm::dvec3(p.x(), p.y(), p.z()) + 0.5))));
  };
  const Domain domain(CGAL::parameters::function = region_at, CGAL::parameters::bounding_object = box);
  using namespace CGAL::parameters;
  const Criteria criteria(facet_angle = 25, facet_size = spacing, facet_distance = 1.5, cell_radius_edge_ratio = 2,
                          cell_size = spacing);
  const Complex complex = CGAL::make_mesh_3<Complex>(domain, criteria, perturb, exude, no_lloyd(), no_odt());
  seconds = cpu_seconds() - start;

  TetMesh mesh;
  std::map<Triangulation::Vertex_handle, int> number;
  std::vector<Eigen::RowVector3d> places;
  mesh.T.resize(complex.number_of_cells_in_complex(), 4);
  int row = 0;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell, ++row)
    for (int i = 0; i < 4; ++i) {
      const auto vertex = cell->vertex(i);
      const auto [at, is_new] = number.emplace(vertex, int(places.size()));
      if (is_new) places.push_back({vertex->point().x(), vertex->point().y(), vertex->point().z()});
      mesh.T(row, i) = at->second;
    }
  mesh.V.resize(places.size(), 3);
  for (std::size_t i = 0; i < places.size(); ++i) mesh.V.row(i) = places[i];
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  const ThreadCount one_thread(1);
  Phantom body;
  if (argc > 2) {
    VolumeFile file = read_volume(argv[1]);
    body.volume = std::move(file.volume);
    body.tissues = merge_tissue_tables(file.tissues, nullptr);
    body.armature = read_armature(argv[2]);
    if (const auto guess = guess_bone_tissue(body.volume, body.tissues, body.armature))
      body.tissues = with_bones(std::move(body.tissues), {body.tissues.find(guess->label)->file_value});
  } else {
    body = make_arm_phantom();
  }
  const double spacing = argc > 3 ? std::atof(argv[3]) : 8;
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  std::vector<std::uint16_t> region(tissue.size(), TetMesh::kSoft);
  LabelVolume regions = body.volume;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (parts.part_of[place] > 0) region[place] = 1 + parts.parts[parts.part_of[place] - 1].bone;
    regions.at(v) = 1 + region[place];
  });
  const VoxelRegions voxels{body.volume.grid, tissue, region};

  const double start = cpu_seconds();
  const TissueMesh ours = mesh_tissue(voxels, {.spacing_mm = spacing});
  const double seconds = cpu_seconds() - start;
  print("limber", ours.mesh, voxels, seconds);
  double theirs = 0;
  TetMesh mesh = mesh_by_cgal(regions, spacing, CGAL::parameters::no_perturb(), CGAL::parameters::no_exude(), theirs);
  print("Mesh_3, refined only", mesh, voxels, theirs);
  const double refined = theirs / double(mesh.T.rows());
  mesh = mesh_by_cgal(regions, spacing, CGAL::parameters::perturb(), CGAL::parameters::exude(), theirs);
  print("Mesh_3, perturbed, exuded", mesh, voxels, theirs);
  const double each = seconds / double(ours.mesh.T.rows());
  std::printf(
      "limber is %.2f times as fast per tet as Mesh_3 refined only, %.2f times as Mesh_3 with its optimizers (goal "
      "2)\n",
      refined / each, theirs / double(mesh.T.rows()) / each);
}
