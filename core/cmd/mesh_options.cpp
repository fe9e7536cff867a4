// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/mesh_options.h"

#include <cmath>
#include <cstdio>
#include <set>

#include "core/base/text_parse.h"
#include "core/cmd/command.h"
#include "core/export/tet_phantom.h"
#include "core/prepare/prepare.h"

namespace limber::cmd {

void add_mesh_options(CLI::App& command, MeshOptions& options, const std::string& start) {
  command
      .add_option(start + "spacing", options.spacing,
                  "distance between the nodes of the mesh's surfaces, mm (default: the voxel size); tissues keep their "
                  "volumes")
      ->check(CLI::Range(1e-9, 1e6));
  command
      .add_option(start + "relax", options.relaxations,
                  "steps of smoothing of the surfaces between tissues (default: 4); 0 keeps the voxels' faces")
      ->check(CLI::Range(0, 1000));
  command.add_option(start + "unit", options.unit, "unit of the mesh in its file: mm, or cm as in ICRP 145")
      ->check(CLI::IsMember({"mm", "cm"}));
}

namespace {
void warn_of_volumes(const TetMesh& mesh, const std::vector<double>& wanted, const TissueTable& tissues) {
  std::vector<double> mm3(wanted.size(), 0);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) mm3[mesh.region[t]] += signed_volume(mesh.V, mesh.T.row(t));
  int off = 0, worst = 0;
  double most = 0;
  for (std::size_t label = 1; label < wanted.size(); ++label) {
    if (wanted[label] == 0) continue;
    const double share = std::abs(mm3[label] / wanted[label] - 1);
    off += share > 0.01;
    if (share > most) most = share, worst = static_cast<int>(label);
  }
  if (off == 0) return;
  const Tissue* tissue = tissues.find(static_cast<Label>(worst));
  warn("in the mesh, the volume of " + std::to_string(off) + (off == 1 ? " tissue is off" : " tissues is off") +
       " by more than 1 %, most for " + (tissue && !tissue->name.empty() ? tissue->name : std::to_string(worst)) +
       ", which has " + std::to_string(int(std::lround(100 * mm3[worst] / wanted[worst]))) +
       " % of its volume in the voxels: use a smaller spacing");
}
}  // namespace

BodyMesh mesh_of(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                 const MeshOptions& options, Progress& progress) {
  std::vector<double> volumes(65536, 0);
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) { volumes[volume.at(v)] += volume.grid.voxel_volume(); });
  const BodyMeshSettings settings{.relaxations = options.relaxations, .volumes = volumes};
  BodyMesh body;
  if (options.spacing) {
    if (tissue.seams()) warn("the mesh is not cut at seams, because its spacing differs from that of the voxels");
    const LabelVolume sampled = balanced_regrid(volume, *options.spacing, progress);
    body = mesh_body(sampled, TissueVoxels(sampled), settings, progress);
  } else {
    body = mesh_body(volume, tissue, settings, progress);
  }
  warn_of_volumes(body.mesh, volumes, tissues);
  return body;
}

void write_mesh(TetMesh mesh, const LabelVolume& volume, const TissueTable& tissues, const std::string& unit,
                const std::string& name, Progress& progress) {
  if (unit == "cm") mesh.V /= 10;
  mesh = organ_mesh(mesh.V, mesh.T, mesh.region, tissues);
  std::vector<std::string> warnings;
  write_export(mesh_exporter(name), {volume, tissues, {}, 0, &mesh, progress, warnings}, mesh_path(name));
  warn(warnings);
}

TetMesh solver_mesh(const FemShape& shape) {
  const TissueModel& model = shape.model;
  const TetMesh& mesh = model.fem.mesh;
  std::vector<Label> labels(mesh.T.rows(), 0);
  for (int t = 0; t < mesh.T.rows(); ++t) {
    double most = 0;
    for (std::int32_t i = model.first[t]; i < model.first[t + 1]; ++i)
      if (model.parts[i].mm3 > most) most = model.parts[i].mm3, labels[t] = model.parts[i].label;
  }
  return {.V = shape.V, .T = mesh.T, .region = labels};
}

std::vector<Path> mesh_files(const Path& name) { return files_exported_as(mesh_exporter(name), mesh_path(name)); }

std::string share_of_body(const TissueModel& model, const LabelVolume& body) {
  std::set<Label> in_mesh, in_body;
  double mm3 = 0, all_mm3 = 0;
  for (const auto& part : model.parts)
    if (part.label != 0) mm3 += part.mm3, in_mesh.insert(part.label);
  for (const Label label : body.voxels)
    if (label != 0) all_mm3 += body.grid.voxel_volume(), in_body.insert(label);
  char text[240];
  std::snprintf(text, sizeof text,
                "the mesh contains only the soft tissue that bends: %.1f %% of the body's volume and %zu of its %zu "
                "tissues; rigid and unbent parts are missing, and each tet has one tissue",
                100 * mm3 / all_mm3, in_mesh.size(), in_body.size());
  return text;
}

std::string inside_out_warning(std::int64_t tets, const std::string& name) {
  return std::to_string(tets) + " tets of " + in_quotes(name) +
         " are inside out, at joints that are bent far; bend the joints less, or use --method fem, which inverts fewer "
         "tets";
}

Path mesh_path(const Path& name) {
  if (name.extension() == ".ele") return Path(name).replace_extension(".node");
  const Exporter* exporter = exporter_for(name);
  return exporter && exporter->takes_mesh ? name : Path(name.string() + ".node");
}

const Exporter& mesh_exporter(const Path& name) { return *exporter_for(mesh_path(name)); }

}  // namespace limber::cmd
