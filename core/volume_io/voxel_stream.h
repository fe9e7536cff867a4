// SPDX-License-Identifier: AGPL-3.0-or-later
// The voxel bytes that a header promises, decoded and delivered in order, chunk by chunk, or an Error: nothing is ever
// made up. It reads and inflates each byte once, so that checking a file costs no second pass and no file-wide buffer.
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
  // Opens the data files, one after the other. They must be plain files inside the header's folder (no links out of
  // it), and large enough to hold what is promised: raw data to the byte, encoded data by the most their encoding can
  // pack.
  //   throws Error naming the data file
  VoxelStream(std::shared_ptr<VolumeFiles> files, const VolumeHeader& header);
  ~VoxelStream() override;

  void read(void* to, std::size_t bytes) override;
  std::vector<std::string> finish() override;

 private:
  struct Sources;
  std::unique_ptr<Sources> sources_;
};

}  // namespace limber
