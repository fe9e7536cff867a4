// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines the interface for reading the voxels of one volume in storage order, from data files or from a DICOM series.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/volume_io/volume_header.h"
#include "core/volume_io/volume_location.h"

namespace limber {

// A range of bytes in a file: `bytes` bytes, beginning at `offset`.
struct FileBytes {
  std::int64_t offset = 0, bytes = 0;
};

class VoxelSource {
 public:
  virtual ~VoxelSource() = default;

  // Reads exactly the next `bytes` bytes of voxels into `to`, in the header's byte order. Throws Error when the data
  // end earlier or are damaged.
  virtual void read(void* to, std::size_t bytes) = 0;

  // If the next voxels are stored in the file exactly as read() returns them, skips them and returns their range in the
  // data file that was opened last. Returns nothing if voxels have to be decoded.
  virtual std::optional<FileBytes> pass_plain() { return std::nullopt; }

  // Verifies checksums; call it after the last voxel was read. Returns warnings, one line each: for data beyond what
  // the header promises, and for wrong header fields.
  virtual std::vector<std::string> finish() = 0;
};

struct OpenedVolume {
  VolumeHeader header;
  std::unique_ptr<VoxelSource> voxels;  // null when only the header was requested
};

// An NRRD file with this key contains skin weights, not a volume.
constexpr const char* kWeightsKey = "limber_bones";

// The content to read from a file. Vectors is a displacement field, which is read as a volume with three times as many
// voxels in x. Header means only the header, whatever the file contains.
enum class Holding : std::uint8_t { Volume, Weights, Vectors, Header };

// Reads and checks the header and opens the voxels. The format is recognized by the file's content and extension. The
// file is parsed in a process without rights (volume_reader.h), or in this process when limber_reader is missing.
// Throws Error when the file is not valid, or contains weights when a volume is requested.
OpenedVolume open_volume(const Path& path, Progress& progress = no_progress(), Holding holding = Holding::Volume);

// Opens a volume as open_volume() does, but always parses it in this process.
OpenedVolume open_volume_here(std::shared_ptr<VolumeFiles> files, Holding holding);

bool is_virtual_family(const Path& text_path);

}  // namespace limber
