// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/voxel_writer.h"

#include <algorithm>
#include <bit>

#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
static_assert(std::endian::native == std::endian::little,
              "files are written in native byte order and say little endian");

constexpr std::size_t kChunkVoxels = 1 << 14;
}  // namespace

OutputFile::OutputFile(const Path& path) : path_(path) {
  std::error_code error;
  file_ = OpenFile(path, Opening::Overwrite, error);
  require_success(error);
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
  require_success(file_.write_at(place, text));
}

void OutputFile::close() { require_success(file_.close()); }

void OutputFile::put(const void* bytes, std::size_t size) {
  require_success(file_.write({static_cast<const char*>(bytes), size}));
  place_ += static_cast<std::int64_t>(size);
}

void OutputFile::require_success(const std::error_code& error) const {
  if (error) throw Error("the file cannot be written", path_.string(), error.message());
}

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
