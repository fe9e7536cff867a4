// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the posed positions of voxel corners, in fixed point (lattice.h).
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/deform/corner_weights.h"
#include "core/deform/output_lattice.h"
#include "core/deform/skinning.h"
#include "core/volume/grid.h"

namespace limber {

class CornerPoser {
 public:
  //   names            names of the bones, for messages; must outlive this object
  //   posed_from_rest  motions of the bones
  CornerPoser(const Grid& grid, const std::vector<std::string>& names,
              const std::vector<RigidTransform>& posed_from_rest, Blend blend);

  // Sets the transform to the output lattice. Must be called before posed() and posed_by().
  void set_output(const OutputLattice& output) { output_ = output; }

  // Returns the posed position of a corner. Throws Error if the position is too far away.
  //   influences  ascending by bone; at least one
  //   shift       correction that is added to the blended position, voxels
  FixedPoint posed(const glm::ivec3& corner, std::span<const BoneWeight> influences, const glm::dvec3& shift) const;
  // Returns the posed position of a corner that follows one bone.
  FixedPoint posed_by(int bone, const glm::ivec3& corner, const glm::dvec3& shift = glm::dvec3(0)) const;

  struct FourFixed {
    FourIntegers x, y, z;
  };
  // Returns the posed positions of four corners.
  //   rest   the corners at rest, in voxel coordinates
  //   shift  corrections that are added to the blended positions, voxels; nullptr: none
  FourFixed posed(const FourPoints& rest, const CornerWeights::Four& weights, const FourPoints* shift) const;

 private:
  FourPoints moved(const FourPoints& rest, std::span<const FourWeights> influences) const;
  void replace_single(const FourPoints& rest, const CornerWeights::Four& weights, FourPoints& moved) const;
  [[noreturn]] void throw_torn(int bone) const;
  [[noreturn]] void throw_torn(const FourPoints& at, std::span<const FourWeights> influences) const;
  FixedPoint fixed(const glm::dvec3& rest, const glm::dvec3& moved, int bone) const;

  const std::vector<std::string>* names_;
  AffineTransform world_from_voxel_;
  glm::dmat3 voxel_from_world_;
  std::vector<SkinTransform> bones_;
  std::vector<AffineTransform> shift_;  // for each bone, the affine map rest point -> (posed - rest), in voxels
  Blend blend_;
  BlendRule::Four four_points_;
  OutputLattice output_;
};

}  // namespace limber
