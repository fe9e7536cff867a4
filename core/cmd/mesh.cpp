// SPDX-License-Identifier: AGPL-3.0-or-later
// limber mesh VOLUME -o OUT.node|vtu|inp [--tissues T] [--spacing MM] [--relax N] [--unit mm|cm] [--seams]: fills a
// whole body with tetrahedra, organs and bones included.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/base/error.h"
#include "core/base/output_files.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/mesh_options.h"
#include "core/cmd/tissue_options.h"
#include "core/export/tet_phantom.h"
#include "core/volume_io/grey_image.h"

namespace limber::cmd {

namespace {
struct MeshCommandOptions {
  std::string volume, tissues, output;
  MeshOptions mesh;
  RunOptions run;
};

// Prints, for each tissue, the number of tets, their volume, its share of the volume of the voxels, and the mass.
void print_tissues(const TetMesh& mesh, const LabelVolume& volume, const TissueTable& tissues) {
  std::vector<std::int64_t> voxels(65536, 0), tets(65536, 0);
  std::vector<double> mm3(65536, 0);
  for (const Label label : volume.voxels) ++voxels[label];
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    ++tets[mesh.region[t]];
    mm3[mesh.region[t]] += signed_volume(mesh.V, mesh.T.row(t));
  }
  print("%-28s %10s %14s %18s %10s\n", "tissue", "tets", "mm3", "of voxels' volume", "mass, g");
  for (const Tissue& tissue : tissues.tissues) {
    if (tets[tissue.label] == 0) continue;
    const double by_voxels = double(voxels[tissue.label]) * volume.grid.voxel_volume();
    print("%-28s %10lld %14.6g %17.3f%% %10.4g\n", one_line(tissue.name).c_str(),
          static_cast<long long>(tets[tissue.label]), mm3[tissue.label], 100 * mm3[tissue.label] / by_voxels,
          mm3[tissue.label] * tissue.density / 1000);
  }
}
}  // namespace

void add_mesh(CLI::App& app) {
  auto* command = app.add_subcommand("mesh", "fills a whole body with tetrahedra, organs and bones included");
  auto options = std::make_shared<MeshCommandOptions>();
  command->add_option("VOLUME", options->volume, "label volume")->required();
  command->add_option("--tissues", options->tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  add_mesh_options(*command, options->mesh, "--");
  writes(command->add_option("-o,--output", options->output,
                             "OUT.node (with OUT.ele, OUT.material and colour.dat), OUT.vtu or OUT.inp"),
         [](const std::string& name) {
           return OptionFiles{{}, mesh_files(name)};
         })
      ->required();
  add_run_options(*command, options->run);
  command->callback([options] {
    for (const Path& file : mesh_files(options->output)) check_place(file.string());
    std::optional<ThreadCount> threads;
    if (options->run.threads > 0) threads.emplace(options->run.threads);
    CommandProgress progress(options->run.progress);
    const VolumeFile file = read_volume(options->volume, progress);
    warn(file.warnings);
    const TissueTable tissues = tissues_of(file, options->tissues);
    require_labels(file.volume, tissues, options->volume);
    const BodyMesh body = mesh_of(file.volume, TissueVoxels(file.volume), tissues, options->mesh, progress);
    write_mesh(body.mesh, file.volume, tissues, options->mesh.unit, options->output, progress);
    print_tissues(body.mesh, file.volume, tissues);
  });
}

}  // namespace limber::cmd
