// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>


#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/volume/dicom.h"
#include "core/volume/header_text.h"
#include "core/volume/meta_header.h"
#include "core/volume/nifti_header.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/virtual_family.h"
#include "core/volume/volume_files.h"
#include "core/volume/voxel_stream.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
constexpr std::int64_t kLargestHeader = 16 << 20;

std::string first_bytes(const PlainFile& file, std::int64_t most) {
  std::string bytes(static_cast<std::size_t>(std::min(file.size(), most)), '\0');
  bytes.resize(file.read_at(0, bytes.data(), bytes.size()));
  return bytes;
}

// Enough for the file's header.
std::string header_bytes(const PlainFile& file) {
  constexpr std::int64_t kUsual = 1 << 16;
  std::string bytes = first_bytes(file, kUsual);
  const bool long_header = looks_like_nrrd_header(bytes) && bytes.find("\n\n") == std::string::npos && bytes.find("\n\r\n") == std::string::npos;
  return long_header && file.size() > kUsual ? first_bytes(file, kLargestHeader) : bytes;
}

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

// The first bytes of what a gzip stream holds; fewer when the stream is damaged or ends.
std::string inflated_start(std::string_view packed, std::size_t most) {
  std::string plain(most, '\0');
  Inflater stream;
  std::size_t done = 0;
  for (bool moves = true; moves && done < most && !stream.ended();) {
    const Inflater::Step step = stream.inflate(packed, plain.data() + done, most - done);
    packed.remove_prefix(step.taken);
    done += step.made;
    moves = !step.damaged && step.taken + step.made > 0;
  }
  plain.resize(done);
  return plain;
}

bool ends(const Path& path, std::string_view end) { return lower_case(path.filename().string()).ends_with(end); }

// NAME.hdr for NAME.img and NAME.img.gz.
Path nifti_header_path(const Path& path) {
  Path stem = path;
  if (ends(stem, ".gz")) stem.replace_extension();
  return stem.replace_extension(".hdr");
}

VolumeHeader read_nifti(const Path& path, const PlainFile& file, const std::string& bytes) {
  const bool packed = is_gzip(bytes);
  const std::string start = packed ? inflated_start(bytes, kNiftiHeaderBytes) : bytes;
  NiftiHeader nifti = parse_nifti_header(start, packed ? std::nullopt : std::optional(file.size()), path.string());
  VolumeHeader& header = nifti.volume;
  bool data_packed = packed;
  if (nifti.is_pair) {
    Path image = path.filename();
    if (ends(image, ".gz")) image.replace_extension();
    image.replace_extension(".img");
    std::error_code error;
    if (!fs::exists(path.parent_path() / image, error) && fs::exists(path.parent_path() / (image.string() + ".gz"), error)) image += ".gz";
    header.data_names = {image.string()};
    data_packed = ends(image, ".gz");
  }
  if (data_packed) {
    header.encoding = Encoding::Deflate;
    std::swap(header.byte_skip, header.decoded_skip);
  }
  return std::move(header);
}

VolumeHeader read_virtual_family(const Path& text_path) {
  const Path raw_name = text_path.filename().replace_extension(".raw");
  std::error_code error;
  const auto raw_bytes = fs::file_size(text_path.parent_path() / raw_name, error);
  if (error) throw Error("the voxel file " + in_quotes(raw_name.string()) + " is missing", text_path.string(), "put it beside the .txt");
  VolumeHeader header = parse_virtual_family(read_file(text_path, kLargestHeader), static_cast<std::int64_t>(raw_bytes), text_path.string());
  header.data_names = {raw_name.string()};
  return header;
}

struct Found {
  VolumeHeader header;
  Path path;  // what data names stand beside
};

Found read_header(const Path& given) {
  Path path = given;
  if (ends(path, ".img") || ends(path, ".img.gz")) path = nifti_header_path(path);
  if (ends(path, ".raw")) path.replace_extension(".txt");
  std::error_code error;
  if (!fs::exists(path, error))
    throw Error(path == given ? "there is no such file" : "the header " + in_quotes(path.filename().string()) + " is missing", given.string(),
                path == given ? "check the name" : "put it beside the data");

  const std::string where = path.string();
  const PlainFile file(path);
  if (file.size() == 0) throw Error("the file is empty", where, "export or download it again");
  const std::string bytes = header_bytes(file);
  if (looks_like_nrrd_header(bytes) || ends(path, ".nrrd") || ends(path, ".nhdr")) return {parse_nrrd_header(bytes, where), path};
  if (ends(path, ".nii") || ends(path, ".nii.gz") || ends(path, ".hdr") || ends(path, ".hdr.gz") || looks_like_nifti_header(bytes))
    return {read_nifti(path, file, bytes), path};
  if (ends(path, ".mha") || ends(path, ".mhd") || looks_like_meta_header(bytes)) return {parse_meta_header(bytes, where), path};
  if (ends(path, ".txt") && looks_like_virtual_family(bytes)) return {read_virtual_family(path), path};
  throw Error("this is no volume that can be read", where, "use NRRD, MetaImage, NIfTI, DICOM or Virtual Family RAW with its .txt");
}
}  // namespace

OpenedVolume open_volume(const Path& path, Holding holding) {
  std::error_code error;
  if (fs::is_directory(path, error) || is_dicom_file(path)) return open_dicom(path);
  Found found = read_header(path);
  if (holding == Holding::Volume && found.header.keys.contains(kWeightsKey))
    throw Error("the file holds weights, not a volume", path.string(), "give it as --weights");
  OpenedVolume opened{std::move(found.header), nullptr};
  opened.voxels = std::make_unique<VoxelStream>(found.path, opened.header);
  return opened;
}

std::vector<Path> files_of_volume(const Path& path) {
  std::vector<Path> files{path};
  std::error_code error;
  if (!fs::is_regular_file(path, error) || is_dicom_file(path)) return files;
  try {
    const Found found = read_header(path);
    files.push_back(found.path);
    for (const std::string& name : found.header.data_names) files.push_back(found.path.parent_path() / name);
  } catch (const Error&) {
    // Whoever reads the volume says what is wrong with it.
  }
  return files;
}

KeyValues read_nrrd_keys(const Path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  const std::string bytes = header_bytes(PlainFile(path));
  return looks_like_nrrd_header(bytes) ? parse_nrrd_keys(bytes, path.string()) : KeyValues{};
}

bool is_virtual_family(const Path& text_path) {
  std::error_code error;
  return fs::is_regular_file(text_path, error) && looks_like_virtual_family(header_bytes(PlainFile(text_path)));
}

}  // namespace limber
