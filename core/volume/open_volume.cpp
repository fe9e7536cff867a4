// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>
#include <fstream>

#include "core/base/error.h"
#include "core/volume/header_text.h"
#include "core/volume/meta_header.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/voxel_stream.h"

namespace limber {

namespace {
// The file's first bytes: enough for its header.
std::string first_bytes(const PlainFile& file) {
  constexpr std::int64_t kUsual = 1 << 16, kLargest = 16 << 20;
  const auto take = [&](std::int64_t most) {
    std::string bytes(static_cast<std::size_t>(std::min(file.size(), most)), '\0');
    bytes.resize(file.read_at(0, bytes.data(), bytes.size()));
    return bytes;
  };
  std::string bytes = take(kUsual);
  const bool long_header = looks_like_nrrd_header(bytes) && bytes.find("\n\n") == std::string::npos && bytes.find("\n\r\n") == std::string::npos;
  return long_header && file.size() > kUsual ? take(kLargest) : bytes;
}

VolumeHeader read_header(const Path& path) {
  const std::string where = path.string();
  const PlainFile file(path);
  if (file.size() == 0) throw Error("the file is empty", where, "export or download it again");
  const std::string bytes = first_bytes(file);
  const std::string extension = lower_case(path.extension().string());
  if (looks_like_nrrd_header(bytes) || extension == ".nrrd" || extension == ".nhdr") return parse_nrrd_header(bytes, where);
  if (extension == ".mha" || extension == ".mhd" || looks_like_meta_header(bytes)) return parse_meta_header(bytes, where);
  throw Error("this is no volume that can be read", where, "use NRRD, MetaImage, NIfTI, DICOM or Virtual Family RAW with its .txt");
}
}  // namespace

OpenedVolume open_volume(const Path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error("there is no such file", path.string(), "check the name");
  OpenedVolume opened{read_header(path), nullptr};
  opened.voxels = std::make_unique<VoxelStream>(path, opened.header);
  return opened;
}

}  // namespace limber
