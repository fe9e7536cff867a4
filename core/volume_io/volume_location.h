// SPDX-License-Identifier: AGPL-3.0-or-later
// Locates a volume and opens its files. Of the files' content, this code only checks the bytes that mark DICOM.
// Everything else is parsed by open_volume.cpp and dicom.cpp, which access files only through VolumeFiles. So the same
// parsers work in a process that may not open files: there, VolumeFiles asks the program to open them
// (serve_volume.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/platform/open_file.h"

namespace limber {

// An open file that can be read. It is a regular file, not a folder, pipe or device.
class PlainFile {
 public:
  explicit PlainFile(const Path& path);  // opens the file; throws Error if it cannot be read
  PlainFile(OpenFile file, std::int64_t size) : file_(std::move(file)), size_(size) {}

  const OpenFile& file() const { return file_; }
  std::int64_t size() const { return size_; }  // bytes
  // Reads `bytes` bytes from `offset` on into `to` and returns how many bytes were read: fewer only at the file's end.
  std::size_t read_at(std::int64_t offset, void* to, std::size_t bytes) const {
    return file_.read_at(offset, to, bytes);
  }

 private:
  OpenFile file_;
  std::int64_t size_ = 0;
};

// Returns the first `most` bytes of the file, or all bytes of a shorter file.
std::string first_bytes(const PlainFile& file, std::int64_t most);
constexpr std::int64_t kLargestHeader = 16 << 20;  // bytes; a longer header is refused

struct VolumeLocation {
  Path path;  // the path that the user gave
  bool is_dicom = false;
  std::vector<Path> headers;  // the header's file; for DICOM all images, sorted by name

  Path folder() const { return headers.front().parent_path(); }
};

// Finds the files of the volume `path`. Throws Error when the file, its header or every DICOM image is missing.
VolumeLocation locate_volume(const Path& path);

// Opens the files of one volume. A data file is given by its name in the header, relative to the header's folder.
class VolumeFiles {
 public:
  explicit VolumeFiles(VolumeLocation location) : location_(std::move(location)) {}
  virtual ~VolumeFiles() = default;
  const VolumeLocation& location() const { return location_; }

  virtual PlainFile open_header(std::size_t index) = 0;  // opens headers[index], or throws Error
  // Throws Error when a data file is missing or, after symbolic links are resolved, lies outside the header's folder.
  virtual void check_data(const std::vector<std::string>& names) = 0;
  virtual PlainFile open_data(const std::string& name) = 0;  // throws Error for a name that check_data() rejects
  virtual bool has_data(const std::string& name) = 0;        // true if check_data() accepts the name
  // Announces that the parser may soon allocate up to this many bytes of memory at once.
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
