// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes measures of a solved mesh, one value for each tet, which the editor shows as colours. Also finds the tet
// that contains each voxel.
//   VolumeRatio    det F: 1 at rest, less where compressed, 0 and less where inverted
//   EnergyDensity  elastic energy in kPa = mJ/cm3 of rest volume, from the tet's own deformation (material.h); infinite
//                  where inverted. The energy of the volume changes of patches (groups of adjacent tets,
//                  fem/patch_form.h) is left out, because it is close to 0 in a body that keeps its volume
//   Gap            least air gap in mm between a node of the tet at the skin and skin opposite it that was far away at
//                  rest (contact_gap.h); infinite where no such skin is near
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
// Returns the value of a measure for tissue that is not meshed, which moves rigidly with its bones.
float measure_at_rest(FemMeasure measure);

// Returns, for each tissue voxel, the index of the tet that contains the voxel's centre (the first of several); -1:
// none does. A voxel at most two voxels outside the mesh gets the tet of a neighbour. #tissue values.
//   V  #V by 3 node positions, world, mm, in the same pose as the volume with this grid and tissue
std::vector<std::int32_t> tets_of_voxels(const Eigen::MatrixX4i& T, const Eigen::MatrixX3d& V, const Grid& grid,
                                         const TissueVoxels& tissue);

}  // namespace limber
