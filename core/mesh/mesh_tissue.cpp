// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/mesh_tissue.h"

#include <chrono>

#include "core/mesh/bcc_split.h"
#include "core/mesh/improve.h"

namespace limber {

namespace {

// The mesh of a net, or why there is none.
std::string fill_net(const LatticeNet& net, const VoxelRegions& voxels, const MeshSettings& settings, Progress& progress, TetMesh& mesh) {
  progress.update("tetrahedra", 0);
  Tetrahedralized filled = tetrahedralize_inside(net.surface, settings.limits, progress);
  if (!filled.mesh) return filled.failure;
  mesh = std::move(*filled.mesh);
  improve(mesh, net, voxels, ImproveSettings{}, progress);
  return find_fault(mesh, enclosed_volumes(net.surface, mesh.V));
}

void make_mesh(TissueMesh& result, const VoxelRegions& voxels, const MeshSettings& settings, Progress& progress) {
  LatticeNetSettings lattice{.spacing_mm = settings.spacing_mm, .fine_around = settings.fine_around, .fine_radius_mm = settings.fine_radius_mm};
  LatticeNet net = lattice_net(voxels, lattice, progress);
  result.spacing_mm = net.spacing_mm;
  const std::string fitted = fill_net(net, voxels, settings, progress, result.mesh);
  if (fitted.empty()) return;

  result.method = MeshMethod::plain;
  result.warning = "the mesh follows the body's surface less closely than usual: the mesher failed on the closer surface: " + fitted;
  lattice.shape = NetShape::plain;
  net = lattice_net(voxels, lattice, progress);
  const std::string plain = fill_net(net, voxels, settings, progress, result.mesh);
  if (plain.empty()) return;

  result.method = MeshMethod::split;
  result.warning = "the mesh is made of blocks, without a smooth surface: the mesher failed on the smooth one: " + fitted + ", and on a plainer one: " + plain;
  result.mesh = bcc_split(voxels, settings.spacing_mm);
}

}  // namespace

TissueMesh mesh_tissue(const VoxelRegions& voxels, const MeshSettings& settings, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  TissueMesh result;
  if (voxels.tissue.size() > 0) make_mesh(result, voxels, settings, progress);
  progress.update("tetrahedra", 1);
  result.quality = quality_of(result.mesh, voxels);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

TissueMesh mesh_tissue(const LabelVolume& regions, const MeshSettings& settings, Progress& progress) {
  const TissueVoxels tissue(regions);
  std::vector<std::uint16_t> region(tissue.size());
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { region[place] = regions.at(v) - 1; });
  return mesh_tissue({regions.grid, tissue, region}, settings, progress);
}

}  // namespace limber
