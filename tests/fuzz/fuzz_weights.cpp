// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the reader of weight files (NRRD): a file is read into weights that sum to one over bones of the rig, or
// refused with Error. Seams in the file lie within the volume.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <unistd.h>

#include "core/base/error.h"
#include "core/skin/weights_io.h"

namespace {
// The bar that the seed files belong to: 9 x 2 x 2 voxels, all tissue, two bones.
struct Bar {
  limber::LabelVolume volume;
  limber::Armature armature;
  limber::TissueVoxels tissue;
  Bar() {
    volume.grid.size = {9, 2, 2};
    volume.voxels.assign(volume.grid.voxel_count(), 1);
    for (const char* name : {"Upper", "Lower"}) {
      limber::Bone bone;
      bone.name = name;
      bone.parent = armature.bones.empty() ? -1 : 0;
      bone.tail = {4, 1, 1};
      armature.bones.push_back(bone);
    }
    tissue = limber::TissueVoxels(volume);
  }
};
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Bar bar;
  static const limber::Path path =
      std::filesystem::temp_directory_path() / ("fuzz-weights-" + std::to_string(::getpid()) + ".nrrd");
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const limber::WeightsFile file = limber::read_weights(path, bar.volume, bar.tissue, bar.armature);
    const limber::SkinWeights& weights = file.weights;
    if (weights.size() != bar.tissue.size()) std::abort();
    for (std::int64_t c = 0; c < weights.chunk_count(); ++c)
      for (const limber::Influence& influence : weights.chunk(c)) {
        int sum = 0;
        for (int k = 0; k < 4; ++k) {
          sum += influence.weight[k];
          if (influence.bone[k] >= weights.bones().size()) std::abort();
        }
        if (sum != limber::kFullWeight) std::abort();
      }
    if (!file.seams || !*file.seams) return 0;
    (*file.seams)->for_each([&](glm::ivec3 voxel, int axis) {
      ++voxel[axis];
      if (!bar.volume.grid.contains(voxel)) std::abort();
    });
  } catch (const limber::Error&) {
  }
  return 0;
}
