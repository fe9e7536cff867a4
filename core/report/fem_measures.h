// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes measures of a solved mesh, one value for each tet, which the editor shows as colours. Also finds the tet
// that contains each voxel.
//   VolumeRatio    det F: 1 at rest, less where compressed, 0 and less where inverted
//   EnergyDensity  kPa = mJ/cm3 of rest volume, from the tet's own deformation (material.h); without the energy of its
//                  patch's mean volume, which is close to 0 in a body that keeps its volume; infinite where inverted
//   Gap            mm of air between the skin and the skin in front of it that was elsewhere at rest (contact_gap.h):
//                  the least over the tet's nodes; infinite where no skin is near
// A tet between two bones is not flesh (tissue_model.h) and has no measure: its value is NaN.
#pragma once

#include <cstdint>
#include <vector>

#include "core/resample/fem_steps.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

enum class FemMeasure { VolumeRatio, EnergyDensity, Gap };

// Returns the measure of each tet, #T values.
//   V  #V by 3 node positions of the solve, world, mm
std::vector<float> fem_measure(FemMeasure measure, const FemMesh& mesh, const Eigen::MatrixX3d& V);
// Returns the measure of tissue that is not meshed. Such tissue moves rigidly with its bones.
float measure_at_rest(FemMeasure measure);

// Returns for each tissue voxel the tet that contains the voxel's centre, the first where there are several, or -1
// where there is none; #tissue values. A voxel up to two voxels outside of the mesh gets its neighbour's tet.
//   V  #V by 3 node positions, world, mm, in the same pose as the volume with this grid and tissue
std::vector<std::int32_t> tets_of_voxels(const Eigen::MatrixX4i& T, const Eigen::MatrixX3d& V, const Grid& grid,
                                         const TissueVoxels& tissue);

}  // namespace limber
