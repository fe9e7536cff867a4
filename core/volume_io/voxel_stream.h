// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and decodes the voxels that a header promises, in storage order and in chunks of any size. Throws Error when
// they are incomplete, and never fills them up. Each byte is read and decompressed once, so that checking a file needs
// no second pass and no buffer for the whole file.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

class VoxelStream final : public VoxelSource {
 public:
  // Checks the data files and opens the first one. They must be regular files inside the header's folder, also after
  // links are resolved. They must be large enough for the voxels that the header promises; compressed files, at the
  // best compression ratio of their encoding. Throws Error, which names the data file.
  VoxelStream(std::shared_ptr<VolumeFiles> files, const VolumeHeader& header);
  ~VoxelStream() override;

  void read(void* to, std::size_t bytes) override;
  std::vector<std::string> finish() override;

 private:
  struct Sources;
  std::unique_ptr<Sources> sources_;
};

}  // namespace limber
