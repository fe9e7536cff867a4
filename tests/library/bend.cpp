// SPDX-License-Identifier: AGPL-3.0-or-later
// bend VOLUME TISSUES RIG BONE DEGREES OUT: computes weights of a body, bends one joint, and writes the posed volume.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "core/binding/heat_diffusion.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"

int main(int argc, char** argv) try {
  if (argc != 7) return 2;
  const limber::VolumeFile file = limber::read_volume(argv[1]);
  const limber::TissueTable named = limber::read_tissue_table(argv[2]);
  const limber::TissueTable tissues = limber::merge_tissue_tables(file.tissues, &named);
  const limber::Armature rig = limber::read_armature(argv[3]);
  const limber::SkinWeights weights = limber::diffuse_heat(file.volume, tissues, rig);
  limber::Pose pose = limber::rest_pose(rig);
  limber::flex(pose, rig, static_cast<int>(rig.find(argv[4]).value()), std::atof(argv[5]));
  const limber::Posed posed = limber::resample(file.volume, tissues, rig, weights, pose, limber::Blend::DualQuaternion);
  limber::write_volume(posed.volume, argv[6], tissues, file.type);
  std::printf("%lld voxels\n", static_cast<long long>(posed.volume.grid.voxel_count()));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
