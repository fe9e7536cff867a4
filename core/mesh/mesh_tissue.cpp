// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/mesh_tissue.h"

#include <chrono>
#include <cmath>

#include "core/base/error.h"
#include "core/mesh/improve.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/split_at_seams.h"

namespace limber {

namespace {

// Edge of the lattice's cells relative to the node spacing: a body-centred cubic cell contains two nodes.
const double kLatticePerSpacing = std::cbrt(2.0);
// Distance by which each side of a seam moves away from it, as a share of the lattice's spacing. Contact needs a gap.
constexpr double kOpen = 0.04;

std::string find_fault_of(const TetMesh& mesh, const LatticeNet& net) {
  return find_fault(mesh, enclosed_volumes(net.surface, mesh.V));
}

// Fills the net's surface with tets by TetGen. Returns why that failed, or an empty string.
std::string fill_by_tetgen(TissueMesh& result, const LatticeNet& net, const MeshSettings& settings,
                           Progress& progress) {
  Tetrahedralized filled = tetrahedralize_inside(net.surface, settings.limits, progress);
  if (!filled.mesh) return filled.failure;
  improve(*filled.mesh, net, ImproveSettings{}, progress);
  if (std::string fault = find_fault_of(*filled.mesh, net); !fault.empty()) return fault;
  result.mesh = std::move(*filled.mesh);
  result.mesher = Mesher::tetgen;
  return {};
}

// Returns the nodes at which tets of several sides of seams meet.
std::vector<int> nodes_of_several_sides(const TetMesh& mesh, const VoxelRegions& voxels) {
  std::vector<int> side(mesh.V.rows(), -1), nodes;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (const int node : mesh.T.row(t)) {
      const int here = voxels.side_of(mesh.region[t]);
      if (side[node] >= 0 && side[node] != here) nodes.push_back(node);
      side[node] = here;
    }
  return nodes;
}

// Cuts the mesh open where seams separate tissue, and gives all soft tissue the region kSoft.
void cut_open(TissueMesh& result, const LatticeNet& net, const VoxelRegions& voxels) {
  if (!voxels.sides) return;
  TetMesh& mesh = result.mesh;
  const Eigen::MatrixX4i before = mesh.T;
  split_at_faces(mesh, net.cut, nodes_of_several_sides(mesh, voxels));
  open_faces(mesh, net.cut, before, kOpen * net.spacing_mm);
  const auto warn = [&](std::int64_t removed, const char* why) {
    if (removed == 0) return;
    if (!result.warning.empty()) result.warning += "; ";
    result.warning += std::to_string(removed) + (removed == 1 ? " tet" : " tets") + " at seams left out, because " +
                      why + ": tissue in these tets moves with the nearest tets";
  };
  warn(remove_crossing(mesh), "surfaces would cross there");
  warn(remove_flakes(mesh, voxels), "they lie loose in the air");
  for (std::uint16_t& region : mesh.region) {
    mesh.side.push_back(voxels.side_of(region));
    if (is_soft_region(region)) region = TetMesh::kSoft;
  }
}

void make_mesh(TissueMesh& result, const VoxelRegions& voxels, const MeshSettings& settings, Progress& progress) {
  const bool by_tetgen = settings.mesher == Mesher::tetgen;
  LatticeNet net = lattice_net(voxels,
                               {.spacing_mm = settings.spacing_mm * (by_tetgen ? 1 : kLatticePerSpacing),
                                .fine_around = settings.fine_around,
                                .fine_radius_mm = settings.fine_radius_mm,
                                .covered = settings.covered},
                               progress);
  result.spacing_mm = net.spacing_mm;
  progress.update("tetrahedra", 0);
  if (by_tetgen) {
    const std::string failure = fill_by_tetgen(result, net, settings, progress);
    if (failure.empty()) return cut_open(result, net, voxels);
    result.warning = "the mesh is made of the lattice's own tetrahedra: TetGen failed on its surface: " + failure;
  }
  result.mesh = std::move(net.mesh);
  improve(result.mesh, net, ImproveSettings{}, progress);
  if (const std::string fault = find_fault_of(result.mesh, net); !fault.empty())
    throw Error("the tet mesh has a fault", fault, "try another node spacing");
  cut_open(result, net, voxels);
}

}  // namespace

TissueMesh mesh_tissue(const VoxelRegions& voxels, const MeshSettings& settings, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  TissueMesh result;
  if (voxels.tissue.size() > 0) make_mesh(result, voxels, settings, progress);
  progress.update("tetrahedra", 1);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

TissueMesh mesh_tissue(const LabelVolume& regions, const MeshSettings& settings, Progress& progress,
                       const SeamSides& sides) {
  TissueVoxels tissue(regions);
  tissue.set_seams(sides.seams);
  std::vector<std::uint16_t> region(tissue.size());
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { region[place] = regions.at(v) - 1; });
  return mesh_tissue({regions.grid, tissue, region, sides.of_bone.empty() ? nullptr : &sides}, settings, progress);
}

}  // namespace limber
