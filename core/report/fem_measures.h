// SPDX-License-Identifier: AGPL-3.0-or-later
// What a solved mesh can be asked, tet by tet, to be looked at, and which tet each voxel of a volume lies in.
//   VolumeRatio    det F: 1 as at rest, below it pressed, 0 and less turned inside out
//   EnergyDensity  kPa = mJ/cm3, per volume at rest: of the tet's own deformation [material.h], without what its patch
//   pays for
//                  its mean volume, which is next to nothing in a body that keeps its volume; infinite in an inverted
//                  tet
//   Gap            mm of air from skin to the skin in front of it that was elsewhere at rest [contact_gap.h]: the least
//   of the
//                  tet's nodes; infinite where nothing is near
// Tets between two bones are not flesh (tissue_model.h) and have no measure: NaN.
#pragma once

#include <cstdint>
#include <vector>

#include "core/resample/fem_steps.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

enum class FemMeasure { VolumeRatio, EnergyDensity, Gap };

// #T values.    V  #V places, world, mm
std::vector<float> fem_measure(FemMeasure measure, const FemMesh& mesh, const Eigen::MatrixX3d& V);
// Of tissue that the mesh does not hold: it goes with its bones as it is.
float measure_at_rest(FemMeasure measure);

// #tissue tets that hold the voxels' centres, the first of several; what sticks out of the mesh by no more than two
// voxels has its neighbour's. -1: in no tet.
//   V  #V by 3, world, mm: where the mesh is, in the volume of that grid and tissue
std::vector<std::int32_t> tets_of_voxels(const Eigen::MatrixX4i& T, const Eigen::MatrixX3d& V, const Grid& grid,
                                         const TissueVoxels& tissue);

}  // namespace limber
