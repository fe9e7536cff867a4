// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes real bodies. Prints how much of each body the mesh covers, how good the tets are, and how long each step
// takes. Called as
//   limber_mesh_bodies DATA_FOLDER [SPACING_MM [BODY...]]
// Bodies that are not in the folder are left out, with a message. Times are CPU seconds of one thread.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/bones/bone_parts.h"
#include "core/bones/guess_bone_labels.h"
#include "core/mesh/improve.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/mesh_tissue.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/tissue_table_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/bench/cpu_seconds.h"

namespace {
using namespace limber;
using bench::cpu_seconds;

struct Case {
  // A body to mesh: its name in the output, and its files relative to DATA_FOLDER. Without a rig, each label of bone
  // becomes a region of its own. Without a label table, the labels of the volume's own header are used.
  const char *name, *volume, *rig, *table;
};
constexpr Case kCases[] = {
    {"arm", "bender/man-arm-2mm.mha", "bender/man-arm-2mm-armature.vtk", nullptr},
    {"arm and shoulder", "bp3d/arm_shoulder_1mm_tissue.mha", "bp3d/arm_shoulder.armature.json",
     "bp3d/tissue.labels.json"},
    {"knee atlas", "spl/knee_seg.nrrd", nullptr, "spl/knee.ctbl"},
    {"makehuman", "makehuman/body_4mm.nrrd", "makehuman/body.armature.json", "bp3d/tissue.labels.json"},
    {"body", "bp3d/body_2mm_tissue.mha", "bp3d/body.armature.json", "bp3d/tissue.labels.json"}};

void measure(const std::filesystem::path& data, const Case& each, double spacing) {
  if (!std::filesystem::exists(data / each.volume)) {
    std::printf("%-17s SKIPPED: %s is not here\n", each.name, (data / each.volume).c_str());
    return;
  }
  const VolumeFile file = read_volume(data / each.volume);
  TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  if (each.table) {
    const TissueTable table = read_tissue_table(data / each.table);
    tissues = merge_tissue_tables(file.tissues, &table);
  }
  const TissueVoxels tissue(file.volume);
  std::vector<std::uint16_t> region(tissue.size(), TetMesh::kSoft);
  if (each.rig) {
    const Armature rig = read_armature_file(data / each.rig).armature;
    if (const auto guess = guess_bone_tissue(file.volume, tissues, rig))
      tissues = with_bones(tissues, {tissues.find(guess->label)->file_value});
    const BoneParts parts = split_bones(file.volume, tissue, tissues, rig);
    for (std::int64_t place = 0; place < tissue.size(); ++place)
      if (parts.part_of[place] > 0) region[place] = 1 + parts.parts[parts.part_of[place] - 1].bone;
  } else {
    std::vector<char> bone(65536, 0);
    for (const Tissue& one : tissues.tissues) bone[one.label] = is_bone(one.kind);
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      if (const Label label = file.volume.at(v); bone[label]) region[place] = 1 + label;
    });
  }
  const VoxelRegions voxels{file.volume.grid, tissue, region};

  const double start = cpu_seconds();
  LatticeNet net = lattice_net(voxels, {.spacing_mm = spacing * std::cbrt(2.0)});
  const double netted = cpu_seconds();
  improve(net.mesh, net);
  const double improved = cpu_seconds();
  const std::string fault = find_fault(net.mesh, enclosed_volumes(net.surface, net.mesh.V));
  const double checked = cpu_seconds();
  const MeshQuality quality = quality_of(net.mesh, voxels.grid, voxels.tissue);
  const double end = cpu_seconds();
  long inverted = 0;
  for (const auto& tet : net.mesh.T.rowwise()) inverted += signed_volume(net.mesh.V, tet) <= 0;
  const double tets = double(net.mesh.T.rows());
  std::printf("%-17s %5g %9lld %8ld %8.4f %6.2f %8.4f %5ld %7.2f %6.2f %8.2f %6.2f %8.2f %8.1f  %s\n", each.name,
              spacing, static_cast<long long>(tissue.size()), long(tets), 100 * quality.covered,
              quality.min_dihedral_degrees, 100 * quality.share_below_5_degrees, inverted, end - start, netted - start,
              improved - netted, checked - improved, end - checked, 1e6 * (end - start) / tets,
              fault.empty() ? "sound" : fault.c_str());
  std::fflush(stdout);
}
}  // namespace

int main(int count, char** arguments) try {
  if (count < 2) {
    std::fprintf(stderr, "usage: limber_mesh_bodies DATA_FOLDER [SPACING_MM [BODY...]]\n");
    return 2;
  }
  const ThreadCount one(1);
  std::printf("%-17s %5s %9s %8s %8s %6s %8s %5s %7s %6s %8s %6s %8s %8s\n", "body", "h mm", "voxels", "tets",
              "cover %", "angle", "<5 deg %", "inv.", "CPU s", "net", "improve", "check", "quality", "us/tet");
  const std::vector<std::string> asked(arguments + std::min(count, 3), arguments + count);
  for (const Case& each : kCases)
    if (asked.empty() || std::find(asked.begin(), asked.end(), each.name) != asked.end())
      measure(arguments[1], each, count > 2 ? std::atof(arguments[2]) : 8);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
