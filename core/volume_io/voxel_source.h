// SPDX-License-Identifier: AGPL-3.0-or-later
// Something that delivers the voxels of one volume in storage order: a file's stream or a DICOM series.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/volume_io/volume_header.h"
#include "core/volume_io/volume_location.h"

namespace limber {

class VoxelSource {
 public:
  virtual ~VoxelSource() = default;

  // Exactly `bytes` more bytes of voxels, in the header's byte order. Throws Error when the data end before or are
  // damaged.
  virtual void read(void* to, std::size_t bytes) = 0;

  // To be called after the last voxel: verifies checksums, and tells of data beyond the promise and of wrong header
  // fields, one line each.
  virtual std::vector<std::string> finish() = 0;
};

struct OpenedVolume {
  VolumeHeader header;
  std::unique_ptr<VoxelSource> voxels;  // null where only the header is wanted
};

// The key that marks an NRRD file as weights.
constexpr const char* kWeightsKey = "limber_bones";

// What a file is taken for. Vectors: a displacement field, given as a volume three times as long in x. Header: whatever
// it holds, but nothing of its voxels.
enum class Holding : std::uint8_t { Volume, Weights, Vectors, Header };

// Reads and checks the header, by content and extension, and opens the data. The file is parsed by a process without
// rights (volume_reader.h), or here where there is none. Throws Error, also for weights where a volume is wanted.
OpenedVolume open_volume(const Path& path, Progress& progress = no_progress(), Holding holding = Holding::Volume);

// The same by this process itself.
OpenedVolume open_volume_here(std::shared_ptr<VolumeFiles> files, Holding holding);

bool is_virtual_family(const Path& text_path);

}  // namespace limber
