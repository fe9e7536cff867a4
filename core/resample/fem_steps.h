// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads two files by which another process can watch a finite element solve:
//   NAME.mesh  the tets at rest, written once
//   NAME.step  the positions of nodes and bones after the newest iteration, and at the end their final positions
// Each new .step file replaces the previous one by a rename, so that a reader always sees a whole file. Positions have
// single precision, about 0.1 um on a body. Only the program version that wrote a file can read it; the files are not
// meant for storage.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/rigid_transform.h"
#include "core/fem/material.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct TissueModel;

struct FemMesh {
  TetMesh tets;                       // mesh of the body at rest
  std::vector<TetMaterial> material;  // #T: material of each tet
  std::vector<std::uint8_t> joint;    // #T: 1 for a tet between two bones, else 0

  bool is_soft(std::int64_t tet) const { return tets.region[tet] == TetMesh::kSoft && !joint[tet]; }
};

struct FemStep {
  double reached = 0;                   // share of the way from rest to the pose, [0, 1]
  int iteration = 0;                    // number of iterations so far
  double residual_mm = 0;               // longest motion of a node in this iteration's Newton step, mm
  std::vector<RigidTransform> motions;  // posed-from-rest motion of each bone of the weights
  Eigen::MatrixX3d V;                   // #V node positions, world, mm
};

// A mesh with its solved node positions, for display.
struct SolvedMesh {
  FemMesh mesh;
  Eigen::MatrixX3d V;  // #V node positions, world, mm
};

FemMesh fem_mesh_of(const TissueModel& model);

std::string encode(const FemMesh& mesh);
std::string encode(const FemStep& step);
// Decode the bytes of a .mesh or a .step file. Both functions throw Error if the bytes are not such a file or
// contradict each other.
//   where  name of the file, for messages
FemMesh decode_fem_mesh(const std::string& bytes, const std::string& where);
FemStep decode_fem_step(const std::string& bytes, const std::string& where);

// Write NAME.mesh and NAME.step. Both functions throw Error when the file cannot be written.
void write_fem_mesh(const FemMesh& mesh, const Path& name);
void write_fem_step(const FemStep& step, const Path& name);
// Read NAME.mesh and NAME.step. Both functions return none when the file does not exist (yet), and throw Error when it
// is damaged.
std::optional<FemMesh> read_fem_mesh(const Path& name);
std::optional<FemStep> read_fem_step(const Path& name);

}  // namespace limber
