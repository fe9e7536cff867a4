// SPDX-License-Identifier: AGPL-3.0-or-later
// Something that delivers the voxels of one volume in storage order: a file's stream or a DICOM series.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/volume/volume_header.h"

namespace limber {

class VoxelSource {
 public:
  virtual ~VoxelSource() = default;

  // Exactly `bytes` more bytes of voxels, in the header's byte order. Throws Error when the data end before or are damaged.
  virtual void read(void* to, std::size_t bytes) = 0;

  // To be called after the last voxel: verifies checksums, and tells of data beyond the promise and of wrong header
  // fields, one line each.
  virtual std::vector<std::string> finish() = 0;
};

struct OpenedVolume {
  VolumeHeader header;
  std::unique_ptr<VoxelSource> voxels;
};

// The key that marks an NRRD file as weights.
constexpr const char* kWeightsKey = "limber_bones";
enum class Holding { Volume, Weights };

// Reads and checks the header, by content and extension, and opens the data. Throws Error, also for weights where a
// volume is wanted.
OpenedVolume open_volume(const Path& path, Holding holding = Holding::Volume);

// `key:=value` lines of an NRRD file, without any other check; none for another file.
KeyValues read_nrrd_keys(const Path& path);
bool is_virtual_family(const Path& text_path);

}  // namespace limber
