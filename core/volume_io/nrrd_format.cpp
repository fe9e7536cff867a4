// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes NRRD files, and defines NRRD's row in the table of volume formats (volume_format.h).
#include <algorithm>

#include "core/base/text_parse.h"
#include "core/volume_io/nrrd.h"
#include "core/volume_io/volume_format.h"

namespace limber {

namespace {

std::string_view nrrd_type_name(VoxelType type) {
  if (type == VoxelType::Float32) return "float";
  if (type == VoxelType::Float64) return "double";
  return to_string(type);
}

std::vector<std::pair<std::string, std::string>> segment_keys(const TissueTable& tissues, const Grid& grid) {
  const bool named =
      std::any_of(tissues.tissues.begin(), tissues.tissues.end(), [](const Tissue& t) { return !t.name.empty(); });
  if (!named) return {};
  std::vector<std::pair<std::string, std::string>> keys;
  int number = 0;
  for (const Tissue& tissue : tissues.tissues) {
    const std::string prefix = "Segment" + std::to_string(number++) + "_", value = text_of(tissue.file_value);
    keys.emplace_back(prefix + "ID", "Segment_" + value);
    keys.emplace_back(prefix + "Name", tissue.name.empty() ? "label " + value : tissue.name);
    keys.emplace_back(prefix + "Color",
                      text_of(tissue.colour.r) + " " + text_of(tissue.colour.g) + " " + text_of(tissue.colour.b));
    keys.emplace_back(prefix + "LabelValue", value);
    keys.emplace_back(prefix + "Layer", "0");
    keys.emplace_back(prefix + "Extent", "0 " + std::to_string(grid.size.x - 1) + " 0 " +
                                             std::to_string(grid.size.y - 1) + " 0 " + std::to_string(grid.size.z - 1));
  }
  keys.emplace_back("Segmentation_SourceRepresentation", "Binary labelmap");
  keys.emplace_back("Segmentation_ContainedRepresentationNames", "Binary labelmap|");
  keys.emplace_back("Segmentation_ReferenceImageExtentOffset", "0 0 0");
  return keys;
}
std::string nrrd_header(const Voxels& voxels, const std::string& data_name) {
  const Grid& grid = voxels.grid;
  const AffineTransform world = world_from_voxel(grid);
  const bool many = voxels.channels > 1;
  std::string text = "NRRD0005\ntype: " + std::string(nrrd_type_name(voxels.type)) +
                     "\ndimension: " + (many ? "4" : "3") +
                     "\nspace: left-posterior-superior\nsizes: " + (many ? std::to_string(voxels.channels) + " " : "") +
                     sizes_text(grid) + "\nspace directions: " + (many ? "none " : "");
  for (int axis = 0; axis < 3; ++axis) text += "(" + joined(world.linear[axis], ",") + (axis < 2 ? ") " : ")\n");
  text += std::string("kinds: ") + (many ? "vector " : "") + "domain domain domain\n";
  if (size_of(voxels.type) > 1) text += "endian: little\n";
  text += std::string("encoding: ") + (voxels.compress ? "gzip" : "raw") + "\nspace origin: (" +
          joined(grid.origin, ",") + ")\n";
  if (!data_name.empty()) text += "data file: " + data_name + "\n";
  if (!voxels.description.empty()) text += "content: " + voxels.description + "\n";
  for (const auto& [key, value] : voxels.keys) text += key + ":=" + nrrd_escaped(value) + "\n";
  for (const auto& [key, value] : segment_keys(voxels.tissues, grid)) text += key + ":=" + nrrd_escaped(value) + "\n";
  return text + "\n";
}

void write_nrrd(const Voxels& voxels, const Path& path) {
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    write_text(out, nrrd_header(voxels, ""));
    write_data(out, voxels, Deflater::Wrap::Gzip);
    out.close();
  });
}

void write_nrrd_beside_data(const Voxels& voxels, const Path& path) {
  write_detached(voxels, path, voxels.compress ? ".raw.gz" : ".raw", Deflater::Wrap::Gzip,
                 [&](const std::string& data, std::int64_t) { return nrrd_header(voxels, data); });
}

}  // namespace

VolumeFormat nrrd_format() {
  return {.name = "NRRD",
          .endings = {".nrrd", ".nhdr"},
          .fits =
              [](std::string_view name, std::string_view bytes) {
                return looks_like_nrrd_header(bytes) || name.ends_with(".nrrd") || name.ends_with(".nhdr");
              },
          .read_header =
              [](VolumeFiles& files, const PlainFile&, const std::string& bytes) {
                return parse_nrrd_header(bytes, files.location().headers.front().string());
              },
          .written = {{".nrrd", write_nrrd},
                      {".seg.nrrd", write_nrrd, {}, false},
                      {".nhdr", write_nrrd_beside_data, {".raw", ".raw.gz"}}}};
}

}  // namespace limber
