// SPDX-License-Identifier: AGPL-3.0-or-later
// What the writers of all formats of volumes have in common.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/deflate.h"
#include "core/base/file.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_header.h"

namespace limber {

// A file being written, plainly or deflated.
class OutputFile {
 public:
  explicit OutputFile(const Path& path);  // throws Error, as all of it does
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void begin_deflate(Deflater::Wrap wrap);
  void write(const void* bytes, std::size_t size);
  void end_deflate();
  std::int64_t place() const { return place_; }
  void overwrite(std::int64_t place, const std::string& text);
  void close();

 private:
  void put(const void* bytes, std::size_t size);
  [[noreturn]] void fail() const;

  Path path_;
  int descriptor_ = -1;
  std::int64_t place_ = 0;
  std::optional<Deflater> deflater_;  // while bytes are packed
};

// What is to be written, whatever the format.
struct Voxels {
  Grid grid;
  VoxelType type = VoxelType::UInt8;
  int channels = 1;
  bool compress = true;
  // Fills `to` with `count` voxels from `first` on.
  std::function<void(std::int64_t first, std::size_t count, void* to)> fill;
  TissueTable tissues;  // for formats that hold names
  int nifti_version = 1;
  std::string description = {};  // one line of ASCII, at most 79 letters, which is what NIfTI has room for
  std::vector<std::pair<std::string, std::string>> keys = {};  // of NRRD
};

// All voxels, as they lie in memory.
void write_voxels(OutputFile& out, const Voxels& voxels);
// The same, deflated where `voxels` wants it.
void write_data(OutputFile& out, const Voxels& voxels, Deflater::Wrap wrap);
void write_text(OutputFile& out, const std::string& text);

// The data into a file beside the header, and only then the header, which so never names data that are not there.
//   header  its text, told the data file's name and how long it is
void write_detached(const Voxels& voxels, const Path& header_path, const std::string& data_extension,
                    Deflater::Wrap wrap,
                    const std::function<std::string(const std::string& data_name, std::int64_t bytes)>& header);

// "1 2 3"
std::string joined(const glm::dvec3& v, const char* between = " ");
std::string sizes_text(const Grid& grid);

}  // namespace limber
