// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/fem_steps.h"

#include <cmath>
#include <fstream>
#include <string_view>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/fem/tissue_model.h"

namespace limber {

namespace {

// First lines of the files, which identify their kind. A mesh whose tissue slides has its own first line, so that the
// files of all other meshes keep their format.
constexpr std::string_view kMesh = "limber fem mesh 1\n", kSliding = "limber fem mesh 2\n",
                           kStep = "limber fem step 1\n";
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 30;

Path with(const Path& name, const char* ending) { return name.string() + ending; }

[[noreturn]] void damaged(const std::string& where) {
  throw Error("the steps of the finite element solve cannot be read", where, "run the solve again");
}

void put_places(ByteWriter& writer, const Eigen::MatrixX3d& V) {
  writer.count(V.rows());
  for (Eigen::Index v = 0; v < V.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis) writer.put(static_cast<float>(V(v, axis)));
}

Eigen::MatrixX3d get_places(ByteReader& reader, const std::string& where) {
  Eigen::MatrixX3d V(reader.count(3 * sizeof(float)), 3);
  for (Eigen::Index v = 0; v < V.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      V(v, axis) = reader.get<float>();
      if (!std::isfinite(V(v, axis))) damaged(where);
    }
  return V;
}

ByteReader open(const std::string& bytes, std::string_view head, const std::string& where) {
  if (!bytes.starts_with(head)) damaged(where);
  return ByteReader(std::string_view(bytes).substr(head.size()), [where] { damaged(where); });
}

void write_whole(const std::string& bytes, const Path& path) {
  const Path part = with(path, ".part");
  std::ofstream file(part, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code failure;
  if (file) std::filesystem::rename(part, path, failure);
  if (!file || failure) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw Error("the steps of the finite element solve cannot be written", path.string(),
                "free some space on the disk");
  }
}

std::optional<std::string> read_whole(const Path& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) return std::nullopt;
  return read_file(path, kLargestFile);
}

}  // namespace

FemMesh fem_mesh_of(const TissueModel& model) { return {model.fem.mesh, model.fem.material, model.joint}; }

std::string encode(const FemMesh& mesh) {
  ByteWriter writer;
  const std::string_view head = mesh.tets.copy_of.empty() ? kMesh : kSliding;
  writer.raw(head.data(), head.size());
  put_places(writer, mesh.tets.V);
  writer.count(mesh.tets.T.rows());
  for (Eigen::Index t = 0; t < mesh.tets.T.rows(); ++t) {
    for (int i = 0; i < 4; ++i) writer.put(static_cast<std::int32_t>(mesh.tets.T(t, i)));
    writer.put(static_cast<float>(mesh.material[t].shear_modulus));
    writer.put(static_cast<float>(mesh.material[t].poisson_ratio));
    writer.put(mesh.tets.region[t]);
    writer.put(mesh.joint[t]);
  }
  for (const int node : mesh.tets.copy_of) writer.put(static_cast<std::int32_t>(node));
  return writer.take();
}

FemMesh decode_fem_mesh(const std::string& bytes, const std::string& where) {
  const bool slides = bytes.starts_with(kSliding);
  ByteReader reader = open(bytes, slides ? kSliding : kMesh, where);
  FemMesh mesh;
  mesh.tets.V = get_places(reader, where);
  const std::size_t tets = reader.count(27);
  mesh.tets.T.resize(tets, 4);
  for (std::size_t t = 0; t < tets; ++t) {
    for (int i = 0; i < 4; ++i) {
      mesh.tets.T(t, i) = reader.get<std::int32_t>();
      if (mesh.tets.T(t, i) < 0 || mesh.tets.T(t, i) >= mesh.tets.V.rows()) damaged(where);
    }
    TetMaterial& material = mesh.material.emplace_back();
    material.shear_modulus = reader.get<float>();
    material.poisson_ratio = reader.get<float>();
    mesh.tets.region.push_back(reader.get<std::uint16_t>());
    mesh.joint.push_back(reader.get<std::uint8_t>());
  }
  for (Eigen::Index v = 0; slides && v < mesh.tets.V.rows(); ++v) {
    mesh.tets.copy_of.push_back(reader.get<std::int32_t>());
    if (mesh.tets.copy_of[v] < 0 || mesh.tets.copy_of[v] > v) damaged(where);
  }
  return mesh;
}

std::string encode(const FemStep& step) {
  ByteWriter writer;
  writer.raw(kStep.data(), kStep.size());
  writer.put(step.reached);
  writer.put(static_cast<std::int32_t>(step.iteration));
  writer.put(step.residual_mm);
  writer.count(step.motions.size());
  for (const RigidTransform& bone : step.motions)
    for (const double each : {bone.rotation.w, bone.rotation.x, bone.rotation.y, bone.rotation.z, bone.translation.x,
                              bone.translation.y, bone.translation.z})
      writer.put(each);
  put_places(writer, step.V);
  return writer.take();
}

FemStep decode_fem_step(const std::string& bytes, const std::string& where) {
  ByteReader reader = open(bytes, kStep, where);
  FemStep step;
  step.reached = reader.get<double>();
  step.iteration = reader.get<std::int32_t>();
  step.residual_mm = reader.get<double>();
  step.motions.resize(reader.count(7 * sizeof(double)));
  for (RigidTransform& bone : step.motions) {
    for (double* each : {&bone.rotation.w, &bone.rotation.x, &bone.rotation.y, &bone.rotation.z, &bone.translation.x,
                         &bone.translation.y, &bone.translation.z})
      *each = reader.get<double>();
    if (!(std::abs(glm::length(bone.rotation) - 1) < 1e-6) ||
        !std::isfinite(glm::dot(bone.translation, bone.translation)))
      damaged(where);
  }
  step.V = get_places(reader, where);
  return step;
}

void write_fem_mesh(const FemMesh& mesh, const Path& name) { write_whole(encode(mesh), with(name, ".mesh")); }
void write_fem_step(const FemStep& step, const Path& name) { write_whole(encode(step), with(name, ".step")); }

std::optional<FemMesh> read_fem_mesh(const Path& name) {
  const Path path = with(name, ".mesh");
  const auto bytes = read_whole(path);
  return bytes ? std::optional(decode_fem_mesh(*bytes, path.string())) : std::nullopt;
}

std::optional<FemStep> read_fem_step(const Path& name) {
  const Path path = with(name, ".step");
  const auto bytes = read_whole(path);
  return bytes ? std::optional(decode_fem_step(*bytes, path.string())) : std::nullopt;
}

}  // namespace limber
