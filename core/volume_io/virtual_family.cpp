// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/virtual_family.h"

#include <cmath>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/volume_io/volume_format.h"

namespace limber {

namespace {
// Returns the axis (0, 1, 2) that a word such as nx or dz names, or -1 for any other word. The words begin with
// `letter`: n for numbers of voxels, d for voxel sizes.
int axis_of(std::string_view word, char letter) {
  if (word.size() != 2 || lower_case(word)[0] != letter) return -1;
  const char axis = lower_case(word)[1];
  return axis >= 'x' && axis <= 'z' ? axis - 'x' : -1;
}

std::optional<Tissue> tissue_of(const std::vector<std::string_view>& words, std::string_view line) {
  if (words.size() < 5) return std::nullopt;
  const auto value = number_of<int>(words[0]);
  if (!value || *value < 0 || *value > 65535) return std::nullopt;
  Tissue tissue;
  tissue.file_value = *value;
  const auto name_start = static_cast<std::size_t>(words[4].data() - line.data());
  tissue.name = trimmed(line.substr(name_start));
  for (int i = 0; i < 3; ++i) {
    const auto part = number_of<double>(words[static_cast<std::size_t>(i) + 1]);
    if (!part || !std::isfinite(*part)) return std::nullopt;
    tissue.colour[i] = static_cast<float>(std::clamp(*part, 0.0, 1.0));
  }
  return tissue;
}
}  // namespace

bool looks_like_virtual_family(std::string_view text) {
  bool sizes = false, steps = false;
  for (std::string_view rest = text; !rest.empty();) {
    const auto words = words_of(take_line(rest));
    if (words.size() != 2) continue;
    sizes = sizes || axis_of(words[0], 'n') == 0;
    steps = steps || axis_of(words[0], 'd') == 0;
  }
  return sizes && steps;
}

VolumeHeader parse_virtual_family(std::string_view text, std::int64_t raw_bytes, const std::string& where) {
  RawGrid raw;
  raw.sizes = {0, 0, 0};
  raw.spacing = glm::dvec3(0);
  VolumeHeader header;
  header.format = "Virtual Family";
  std::vector<bool> named(65536);
  int line_number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const auto line = take_line(rest);
    ++line_number;
    const auto words = words_of(line);
    if (words.size() == 2 && axis_of(words[0], 'n') >= 0) {
      const auto size = number_of<std::int64_t>(words[1]);
      if (!size)
        throw Error("the size is " + in_quotes(words[1]), where + " line " + std::to_string(line_number),
                    "write a whole number");
      raw.sizes[static_cast<std::size_t>(axis_of(words[0], 'n'))] = *size;
    } else if (words.size() == 2 && axis_of(words[0], 'd') >= 0) {
      const auto step = number_of<double>(words[1]);
      if (!step)
        throw Error("the step is " + in_quotes(words[1]), where + " line " + std::to_string(line_number),
                    "write metres");
      // Converts metres to millimetres and rounds to a nanometre, so that 0.002 m is exactly 2 mm.
      raw.spacing[axis_of(words[0], 'd')] =
          std::isfinite(*step) && std::abs(*step) < 1e3 ? std::round(*step * 1e9) / 1e6 : *step;
    } else if (const auto tissue = tissue_of(words, line); tissue && tissue->file_value != 0) {
      if (!named[static_cast<std::size_t>(tissue->file_value)]) header.named.tissues.push_back(*tissue);
      named[static_cast<std::size_t>(tissue->file_value)] = true;
    }
  }
  if (!header.named.tissues.empty()) header.named.source = "names in the file";
  header.grid = checked_grid(raw, where, header.warnings);
  if (raw_bytes == 2 * header.grid.voxel_count()) header.voxel_type = VoxelType::UInt16;
  return header;
}

std::string make_virtual_family(const Grid& grid, const TissueTable& tissues) {
  std::string text;
  for (const Tissue& tissue : tissues.tissues) {
    std::string name = tissue.name.empty() ? "label" + text_of(tissue.file_value) : tissue.name;
    for (char& c : name)
      if (is_blank(c)) c = '_';
    text += text_of(tissue.file_value);
    for (int i = 0; i < 3; ++i) text += "\t" + text_of(tissue.colour[i]);
    text += "\t" + name + "\n";
  }
  text += "\nGrid extent (number of cells)\n";
  for (int i = 0; i < 3; ++i) text += std::string("n") + "xyz"[i] + "\t" + std::to_string(grid.size[i]) + "\n";
  text += "\nSpatial steps [m]\n";
  for (int i = 0; i < 3; ++i) text += std::string("d") + "xyz"[i] + "\t" + text_of(grid.spacing[i] / 1000) + "\n";
  return text;
}

namespace {

VolumeHeader read_virtual_family(VolumeFiles& files, const PlainFile& text, const std::string&) {
  const Path& path = files.location().headers.front();
  const std::string raw_name = path.filename().replace_extension(".raw").string();
  if (!files.has_data(raw_name))
    throw Error("the voxel file " + in_quotes(raw_name) + " is missing", path.string(), "put it beside the .txt");
  if (text.size() > kLargestHeader)
    throw Error("the .txt file is too long for a header", path.string(), "export the volume again");
  const std::int64_t raw_bytes = files.open_data(raw_name).size();
  VolumeHeader header = parse_virtual_family(first_bytes(text, kLargestHeader), raw_bytes, path.string());
  header.data_names = {raw_name};
  return header;
}

void write_virtual_family(const Voxels& voxels, const Path& path) {
  if (voxels.type != VoxelType::UInt8 && voxels.type != VoxelType::UInt16)
    throw Error("Virtual Family files hold labels of 8 or 16 bits", path.string(), "write .nrrd, .mha or .nii.gz");
  Voxels plain = voxels;
  plain.compress = false;
  write_detached(plain, path, ".raw", Deflater::Wrap::Gzip,
                 [&](const std::string&, std::int64_t) { return make_virtual_family(voxels.grid, voxels.tissues); });
}

}  // namespace

VolumeFormat virtual_family_format() {
  return {.name = "Virtual Family",
          .endings = {".raw"},
          .fits = [](std::string_view name,
                     std::string_view bytes) { return name.ends_with(".txt") && looks_like_virtual_family(bytes); },
          .read_header = read_virtual_family,
          .written = {{".txt", write_virtual_family, {".raw"}, false}}};
}

}  // namespace limber
