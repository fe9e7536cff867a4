// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/base/module.h"
#include "core/volume/dicom.h"
#include "core/volume/header_text.h"
#include "core/volume/meta_header.h"
#include "core/volume/nifti_header.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/vector_header.h"
#include "core/volume/virtual_family.h"
#include "core/volume/volume_files.h"
#include "core/volume/volume_io.h"
#include "core/volume/volume_reader.h"
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

VolumeHeader read_nifti(VolumeFiles& files, const PlainFile& file, const std::string& bytes) {
  const Path& path = files.location().headers.front();
  const bool packed = is_gzip(bytes);
  const std::string start = packed ? inflated_start(bytes, kNiftiHeaderBytes) : bytes;
  NiftiHeader nifti = parse_nifti_header(start, packed ? std::nullopt : std::optional(file.size()), path.string());
  VolumeHeader& header = nifti.volume;
  bool data_packed = packed;
  if (nifti.is_pair) {
    Path image = path.filename();
    if (ends(image, ".gz")) image.replace_extension();
    image.replace_extension(".img");
    if (!files.has_data(image.string()) && files.has_data(image.string() + ".gz")) image += ".gz";
    header.data_names = {image.string()};
    data_packed = ends(image, ".gz");
  }
  if (data_packed) {
    header.encoding = Encoding::Deflate;
    std::swap(header.byte_skip, header.decoded_skip);
  }
  return std::move(header);
}

VolumeHeader read_virtual_family(VolumeFiles& files, const PlainFile& text) {
  const Path& path = files.location().headers.front();
  const std::string raw_name = path.filename().replace_extension(".raw").string();
  if (!files.has_data(raw_name))
    throw Error("the voxel file " + in_quotes(raw_name) + " is missing", path.string(), "put it beside the .txt");
  if (text.size() > kLargestHeader)
    throw Error("the text is too long for a header", path.string(), "export the volume again");
  const std::int64_t raw_bytes = files.open_data(raw_name).size();
  VolumeHeader header = parse_virtual_family(first_bytes(text, kLargestHeader), raw_bytes, path.string());
  header.data_names = {raw_name};
  return header;
}

VolumeHeader read_header(VolumeFiles& files, Holding holding) {
  const Path& path = files.location().headers.front();
  const std::string where = path.string();
  const PlainFile file = files.open_header(0);
  if (file.size() == 0) throw Error("the file is empty", where, "export or download it again");
  const std::string bytes = header_bytes(file);
  if (holding == Holding::Vectors) return parse_vector_header(bytes, where);
  if (looks_like_nrrd_header(bytes) || ends(path, ".nrrd") || ends(path, ".nhdr")) return parse_nrrd_header(bytes, where);
  const bool named_nifti = ends(path, ".nii") || ends(path, ".nii.gz") || ends(path, ".hdr") || ends(path, ".hdr.gz");
  if (named_nifti || looks_like_nifti_header(bytes)) return read_nifti(files, file, bytes);
  if (ends(path, ".mha") || ends(path, ".mhd") || looks_like_meta_header(bytes)) return parse_meta_header(bytes, where);
  if (ends(path, ".txt") && looks_like_virtual_family(bytes)) return read_virtual_family(files, file);
  throw Error("this is no volume that can be read", where,
              "use NRRD, MetaImage, NIfTI, DICOM or Virtual Family RAW with its .txt");
}

// What the parsers leave to the program, which has the table of tissues: the kind that a name says, and what goes with
// it. A colour that the file does not say is no number.
void complete(TissueTable& named) {
  for (Tissue& tissue : named.tissues) {
    const glm::vec3 colour = tissue.colour;
    tissue.kind = tissue_kind_from_name(tissue.name);
    apply_kind_defaults(tissue);
    if (!std::isnan(colour.x)) tissue.colour = colour;
  }
}

OpenedVolume open_as_can_be(const Path& path, Progress& progress, Holding holding) {
  VolumeLocation location = locate_volume(path);
  if (const auto program = find_own_program(kReaderName))
    return open_in_reader(location, holding, progress, {.program = *program});
  if (location.is_dicom)
    throw Error("DICOM cannot be read, limber_reader is missing", path.string(),
                "install Limber again, or give NRRD, MetaImage or NIfTI");
  return open_volume_here(std::make_shared<LocalFiles>(std::move(location)), holding);
}
}  // namespace

OpenedVolume open_volume_here(std::shared_ptr<VolumeFiles> files, Holding holding) {
  if (files->location().is_dicom) return open_dicom(std::move(files));
  OpenedVolume opened{read_header(*files, holding), nullptr};
  if (holding == Holding::Header) return opened;
  if (holding == Holding::Volume && opened.header.keys.contains(kWeightsKey))
    throw Error("the file holds weights, not a volume", files->location().path.string(), "give it as --weights");
  opened.voxels = std::make_unique<VoxelStream>(std::move(files), opened.header);
  return opened;
}

OpenedVolume open_volume(const Path& path, Progress& progress, Holding holding) {
  OpenedVolume opened = open_as_can_be(path, progress, holding);
  complete(opened.header.named);
  return opened;
}

std::vector<Path> files_of_volume(const Path& path) {
  std::vector<Path> files{path};
  std::error_code error;
  if (!fs::is_regular_file(path, error) || is_dicom_file(path)) return files;
  try {
    const OpenedVolume opened = open_volume(path, no_progress(), Holding::Header);
    const Path header = locate_volume(path).headers.front();
    files.push_back(header);
    for (const std::string& name : opened.header.data_names) files.push_back(header.parent_path() / name);
  } catch (const Error&) {
    // Whoever reads the volume says what is wrong with it.
  }
  return files;
}

bool is_weights_path(const Path& path) {
  std::error_code error;
  if (!ends(path, ".nrrd") || !fs::is_regular_file(path, error)) return false;
  const std::string bytes = header_bytes(PlainFile(path));
  const std::size_t end = std::min(bytes.find("\n\n"), bytes.find("\n\r\n"));
  return looks_like_nrrd_header(bytes) && bytes.find(std::string("\n") + kWeightsKey + ":=") < end;
}

bool is_virtual_family(const Path& text_path) {
  std::error_code error;
  return fs::is_regular_file(text_path, error) && looks_like_virtual_family(header_bytes(PlainFile(text_path)));
}

}  // namespace limber
