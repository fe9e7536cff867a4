// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/voxel_writer.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
static_assert(std::endian::native == std::endian::little,
              "files are written in native byte order and say little endian");

constexpr std::size_t kChunkVoxels = 1 << 14;
}  // namespace

OutputFile::OutputFile(const Path& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail();
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::begin_deflate(Deflater::Wrap wrap) {
  deflater_.emplace(wrap, [this](const void* bytes, std::size_t size) { put(bytes, size); });
}

void OutputFile::write(const void* bytes, std::size_t size) {
  deflater_ ? deflater_->write(bytes, size) : put(bytes, size);
}

void OutputFile::end_deflate() {
  deflater_->end();
  deflater_.reset();
}

void OutputFile::overwrite(std::int64_t place, const std::string& text) {
  if (::pwrite(descriptor_, text.data(), text.size(), place) != static_cast<ssize_t>(text.size())) fail();
}

void OutputFile::close() {
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) fail();
}

void OutputFile::put(const void* bytes, std::size_t size) {
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = ::write(descriptor_, from, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail();
    from += done;
    size -= static_cast<std::size_t>(done);
    place_ += done;
  }
}

void OutputFile::fail() const { throw Error("the file cannot be written", path_.string(), std::strerror(errno)); }

void write_voxels(OutputFile& out, const Voxels& voxels) {
  const std::size_t size = static_cast<std::size_t>(size_of(voxels.type) * voxels.channels);
  std::vector<std::uint64_t> chunk(kChunkVoxels * size / sizeof(std::uint64_t) + 1);
  const std::int64_t total = voxels.grid.voxel_count();
  for (std::int64_t first = 0; first < total; first += kChunkVoxels) {
    const auto count = static_cast<std::size_t>(std::min<std::int64_t>(kChunkVoxels, total - first));
    voxels.fill(first, count, chunk.data());
    out.write(chunk.data(), count * size);
  }
}

std::string joined(const glm::dvec3& v, const char* between) {
  return text_of(v.x) + between + text_of(v.y) + between + text_of(v.z);
}
std::string sizes_text(const Grid& grid) {
  return std::to_string(grid.size.x) + " " + std::to_string(grid.size.y) + " " + std::to_string(grid.size.z);
}

void write_text(OutputFile& out, const std::string& text) { out.write(text.data(), text.size()); }

void write_data(OutputFile& out, const Voxels& voxels, Deflater::Wrap wrap) {
  if (voxels.compress) out.begin_deflate(wrap);
  write_voxels(out, voxels);
  if (voxels.compress) out.end_deflate();
}

void write_detached(const Voxels& voxels, const Path& header_path, const std::string& data_extension,
                    Deflater::Wrap wrap,
                    const std::function<std::string(const std::string& data_name, std::int64_t bytes)>& header) {
  const Path data_path = Path(header_path).replace_extension(data_extension);
  std::int64_t bytes = 0;
  write_atomically(data_path, [&](const Path& temporary) {
    OutputFile out(temporary);
    write_data(out, voxels, wrap);
    bytes = out.place();
    out.close();
  });
  write_file_atomically(header_path, header(data_path.filename().string(), bytes));
}

}  // namespace limber
