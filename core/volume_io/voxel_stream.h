// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and decodes the voxels that a header promises, in storage order and in chunks of any size. Throws Error when
// voxels are missing, and never invents their values. Each byte is read and decompressed once, so checking a file needs
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
  // Checks the data files and opens the first one. Each must be a regular file inside the header's folder, after
  // symbolic links are resolved. The files must be large enough for the voxels that the header promises; for compressed
  // files, the best compression ratio of their encoding is assumed. Throws an Error that names the data file.
  VoxelStream(std::shared_ptr<VolumeFiles> files, const VolumeHeader& header);
  ~VoxelStream() override;

  void read(void* to, std::size_t bytes) override;
  std::optional<FileBytes> pass_plain() override;
  std::vector<std::string> finish() override;

 private:
  struct Sources;
  std::unique_ptr<Sources> sources_;
};

}  // namespace limber
