// SPDX-License-Identifier: AGPL-3.0-or-later
// A solve by finite elements as seen from another process: two files that the solver leaves for whoever watches,
//   NAME.mesh  the tets at rest, once
//   NAME.step  where the nodes and the bones are after the newest iteration, and at the end where they have come to
//   rest
// Each step takes the former one's place in one move, so that a reader sees a whole one, and the disk holds one only.
// Places are single precision: 0.1 um on a body. Files of one program version are read by the same one; they are no
// archive.
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
  TetMesh tets;                       // at rest
  std::vector<TetMaterial> material;  // #T
  std::vector<std::uint8_t> joint;    // #T: 1 between two bones

  bool is_soft(std::int64_t tet) const { return tets.region[tet] == TetMesh::kSoft && !joint[tet]; }
};

struct FemStep {
  double reached = 0;                   // of the way from rest to the pose, [0, 1]
  int iteration = 0;                    // so far
  double residual_mm = 0;               // furthest that a node wanted to move in it
  std::vector<RigidTransform> motions;  // posed_from_rest of the weights' bones
  Eigen::MatrixX3d V;                   // #V places, world, mm
};

// What became of a mesh, to be looked at.
struct SolvedMesh {
  FemMesh mesh;
  Eigen::MatrixX3d V;  // #V places, world, mm
};

FemMesh fem_mesh_of(const TissueModel& model);

std::string encode(const FemMesh& mesh);
std::string encode(const FemStep& step);
// throw Error when the bytes are none, or do not fit together
FemMesh decode_fem_mesh(const std::string& bytes, const std::string& where);
FemStep decode_fem_step(const std::string& bytes, const std::string& where);

// throw Error when it cannot be written
void write_fem_mesh(const FemMesh& mesh, const Path& name);
void write_fem_step(const FemStep& step, const Path& name);
// None where there is no such file (yet).    throw Error when it is damaged
std::optional<FemMesh> read_fem_mesh(const Path& name);
std::optional<FemStep> read_fem_step(const Path& name);

}  // namespace limber
