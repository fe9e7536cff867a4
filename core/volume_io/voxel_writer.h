// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions that the writers of all volume formats share.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/deflate.h"
#include "core/base/file.h"
#include "core/platform/open_file.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_header.h"

namespace limber {

// A file that is written piece by piece. Pieces written between begin_deflate() and end_deflate() are compressed.
class OutputFile {
 public:
  explicit OutputFile(const Path& path);  // throws Error; so do all members that write

  void begin_deflate(Deflater::Wrap wrap);
  void write(const void* bytes, std::size_t size);
  void end_deflate();
  std::int64_t place() const { return place_; }
  void overwrite(std::int64_t place, const std::string& text);
  void close();

 private:
  void put(const void* bytes, std::size_t size);
  void require_success(const std::error_code& error) const;

  Path path_;
  OpenFile file_;
  std::int64_t place_ = 0;
  std::optional<Deflater> deflater_;  // set between begin_deflate() and end_deflate()
};

// The volume to write, in terms that all formats share.
struct Voxels {
  Grid grid;
  VoxelType type = VoxelType::UInt8;
  int channels = 1;
  bool compress = true;
  // Fills `to` with `count` voxels, starting at voxel `first`.
  std::function<void(std::int64_t first, std::size_t count, void* to)> fill;
  TissueTable tissues;  // written only by formats that store tissue names
  int nifti_version = 1;
  std::string description = {};  // one line of ASCII, at most 79 characters, the limit of NIfTI
  std::vector<std::pair<std::string, std::string>> keys = {};  // written only by NRRD, as key:=value
};

// Writes all voxels in this machine's byte order. They are compressed only between begin_deflate() and end_deflate().
void write_voxels(OutputFile& out, const Voxels& voxels);
// Writes all voxels, compressed when `voxels.compress` is set.
void write_data(OutputFile& out, const Voxels& voxels, Deflater::Wrap wrap);
void write_text(OutputFile& out, const std::string& text);

// Writes the voxels into a data file beside the header, and then the header. In this order, no header ever names data
// that do not exist.
//   header  returns the header's text for the data file's name and size
void write_detached(const Voxels& voxels, const Path& header_path, const std::string& data_extension,
                    Deflater::Wrap wrap,
                    const std::function<std::string(const std::string& data_name, std::int64_t bytes)>& header);

// Returns the three numbers as text, for example "1 2 3".
std::string joined(const glm::dvec3& v, const char* between = " ");
std::string sizes_text(const Grid& grid);

}  // namespace limber
