// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a volume lies, and how its files are opened. Only names are looked at here, and the mark of DICOM: whatever
// else a file holds is parsed by open_volume.cpp and dicom.cpp, which get at files only through VolumeFiles. So the
// same parsers work in a process that may not open any file: there, VolumeFiles asks the program (serve_volume.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/file.h"

namespace limber {

// A file on the disk, opened to be read; no folder, pipe or device.
class PlainFile {
 public:
  explicit PlainFile(const Path& path);                                                   // throws Error
  PlainFile(int descriptor, std::int64_t size) : descriptor_(descriptor), size_(size) {}  // takes the descriptor
  ~PlainFile();
  PlainFile(PlainFile&& other) noexcept : descriptor_(other.descriptor_), size_(other.size_) { other.descriptor_ = -1; }
  PlainFile(const PlainFile&) = delete;
  PlainFile& operator=(const PlainFile&) = delete;

  int descriptor() const { return descriptor_; }
  std::int64_t size() const { return size_; }  // bytes
  // Bytes from `offset`, fewer only at the file's end.
  std::size_t read_at(std::int64_t offset, void* to, std::size_t bytes) const;

 private:
  int descriptor_ = -1;
  std::int64_t size_ = 0;
};

// At most so many bytes from the file's beginning.
std::string first_bytes(const PlainFile& file, std::int64_t most);
constexpr std::int64_t kLargestHeader = 16 << 20;  // bytes: what is longer is no header

struct VolumeLocation {
  Path path;  // as the user named it
  bool is_dicom = false;
  std::vector<Path> headers;  // the header's file; of DICOM every image, in order of names

  Path folder() const { return headers.front().parent_path(); }
};

// Throws Error where no file, no header or no DICOM image is.
VolumeLocation locate_volume(const Path& path);

// Opens the files of one volume. Data files go by the names that the header gives them, from the header's folder on.
class VolumeFiles {
 public:
  explicit VolumeFiles(VolumeLocation location) : location_(std::move(location)) {}
  virtual ~VolumeFiles() = default;
  const VolumeLocation& location() const { return location_; }

  virtual PlainFile open_header(std::size_t index) = 0;  // throws Error
  // Throws Error for one that is missing, or lies outside the header's folder once every link is followed.
  virtual void check_data(const std::vector<std::string>& names) = 0;
  virtual PlainFile open_data(const std::string& name) = 0;  // throws Error, likewise
  virtual bool has_data(const std::string& name) = 0;        // one that check_data() takes
  // The parser is about to take up to this much memory at once, bytes.
  virtual void expect_memory(std::size_t) {}

 private:
  VolumeLocation location_;
};

class LocalFiles final : public VolumeFiles {
 public:
  using VolumeFiles::VolumeFiles;
  PlainFile open_header(std::size_t index) override;
  void check_data(const std::vector<std::string>& names) override;
  PlainFile open_data(const std::string& name) override;
  bool has_data(const std::string& name) override;
};

}  // namespace limber
