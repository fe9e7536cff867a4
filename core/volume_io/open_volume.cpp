// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/platform/module.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/nrrd.h"
#include "core/volume_io/vector_header.h"
#include "core/volume_io/virtual_family.h"
#include "core/volume_io/volume_files.h"
#include "core/volume_io/volume_format.h"
#include "core/volume_io/volume_io.h"
#include "core/volume_io/volume_reader.h"
#include "core/volume_io/voxel_stream.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
// Returns the first bytes of the file, at least those of its header.
std::string header_bytes(const PlainFile& file) {
  constexpr std::int64_t kUsual = 1 << 16;
  std::string bytes = first_bytes(file, kUsual);
  const bool long_header = looks_like_nrrd_header(bytes) && bytes.find("\n\n") == std::string::npos &&
                           bytes.find("\n\r\n") == std::string::npos;
  return long_header && file.size() > kUsual ? first_bytes(file, kLargestHeader) : bytes;
}

bool ends(const Path& path, std::string_view end) { return lower_case(path.filename().string()).ends_with(end); }

// A parsed header, and the entry for its format in the table of volume formats (null for a displacement field).
struct ReadHeader {
  const VolumeFormat* format;
  VolumeHeader header;
};

ReadHeader read_header(VolumeFiles& files, Holding holding) {
  const Path& path = files.location().headers.front();
  const std::string where = path.string();
  const PlainFile file = files.open_header(0);
  if (file.size() == 0) throw Error("the file is empty", where, "export or download it again");
  const std::string bytes = header_bytes(file);
  if (holding == Holding::Vectors) return {nullptr, parse_vector_header(bytes, where)};
  const std::string name = lower_case(path.filename().string());
  for (const VolumeFormat& format : volume_formats())
    if (format.fits && format.fits(name, bytes)) return {&format, format.read_header(files, file, bytes)};
  throw Error("this is not a volume that can be read", where, "use " + readable_formats());
}

// Completes the tissues that a parser found in a header: sets each tissue's kind from its name, and the default
// properties of that kind. Parsers leave this to the program, which has the table of tissues. A colour from the file is
// kept; NaN means that the file has none.
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
    throw Error("DICOM cannot be read, because limber_reader is missing", path.string(),
                "install Limber again, or give NRRD, MetaImage or NIfTI");
  return open_volume_here(std::make_shared<LocalFiles>(std::move(location)), holding);
}
}  // namespace

OpenedVolume open_volume_here(std::shared_ptr<VolumeFiles> files, Holding holding) {
  if (files->location().is_dicom) return open_dicom(std::move(files));
  ReadHeader read = read_header(*files, holding);
  OpenedVolume opened{std::move(read.header), nullptr};
  if (holding == Holding::Header) return opened;
  if (holding == Holding::Volume && opened.header.keys.contains(kWeightsKey))
    throw Error("the file holds weights, not a volume", files->location().path.string(), "give it as --weights");
  opened.voxels = read.format && read.format->open_voxels ? read.format->open_voxels(files, opened.header)
                                                          : std::make_unique<VoxelStream>(files, opened.header);
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
    // Ignores the Error, since reading the volume will throw it again.
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
