// SPDX-License-Identifier: AGPL-3.0-or-later
// The voxel bytes that a header promises, decoded and delivered in order, chunk by chunk, or an Error: nothing is ever
// made up. It reads and inflates each byte once, so that checking a file costs no second pass and no file-wide buffer.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/volume/voxel_source.h"

namespace limber {

class VoxelStream final : public VoxelSource {
 public:
  // Opens the data files. They must be plain files inside the header's folder (no links out of it), and large enough
  // to hold what is promised: raw data to the byte, encoded data by the most their encoding can pack.
  //   path  the header's own file          throws Error naming the data file
  VoxelStream(const Path& path, const VolumeHeader& header);
  ~VoxelStream() override;

  void read(void* to, std::size_t bytes) override;
  std::vector<std::string> finish() override;

 private:
  struct Sources;
  std::unique_ptr<Sources> sources_;
};

// Opens only what is a plain file and says its size. Throws Error.
class PlainFile {
 public:
  explicit PlainFile(const Path& path);
  ~PlainFile();
  PlainFile(PlainFile&& other) noexcept : descriptor_(other.descriptor_), size_(other.size_) { other.descriptor_ = -1; }
  PlainFile(const PlainFile&) = delete;
  PlainFile& operator=(const PlainFile&) = delete;

  std::int64_t size() const { return size_; }
  // Bytes from `offset`, fewer only at the file's end.
  std::size_t read_at(std::int64_t offset, void* to, std::size_t bytes) const;

 private:
  int descriptor_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace limber
