// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/metaimage.h"

#include <array>
#include <map>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/volume_io/volume_format.h"

namespace limber {

namespace {
using Fields = std::map<std::string, std::string, std::less<>>;

constexpr std::size_t kLongestHeader = 1 << 20;

std::optional<VoxelType> meta_type(std::string_view name) {
  static const std::map<std::string_view, VoxelType> kTypes = {
      {"MET_CHAR", VoxelType::Int8},         {"MET_UCHAR", VoxelType::UInt8},   {"MET_SHORT", VoxelType::Int16},
      {"MET_USHORT", VoxelType::UInt16},     {"MET_INT", VoxelType::Int32},     {"MET_UINT", VoxelType::UInt32},
      {"MET_LONG", VoxelType::Int32},        {"MET_ULONG", VoxelType::UInt32},  {"MET_LONG_LONG", VoxelType::Int64},
      {"MET_ULONG_LONG", VoxelType::UInt64}, {"MET_FLOAT", VoxelType::Float32}, {"MET_DOUBLE", VoxelType::Float64}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

const std::string* field(const Fields& fields, std::initializer_list<std::string_view> names) {
  for (std::string_view name : names)
    if (const auto found = fields.find(name); found != fields.end()) return &found->second;
  return nullptr;
}

bool is_true(const std::string* value) {
  return value && !value->empty() && ((*value)[0] == 'T' || (*value)[0] == 't' || (*value)[0] == '1');
}

template <class Number>
std::vector<Number> numbers_in(const Fields& fields, std::initializer_list<std::string_view> names, std::size_t count,
                               std::vector<Number> otherwise, const std::string& where) {
  const std::string* text = field(fields, names);
  if (!text) return otherwise;
  const auto numbers = numbers_of<Number>(*text);
  if (!numbers || numbers->size() < count)
    throw Error(std::string(*names.begin()) + " is " + in_quotes(*text), where,
                "this key needs " + std::to_string(count) + " numbers; correct the header");
  // Takes only the first `count` numbers: the header of a 2-D image may list a third one.
  return {numbers->begin(), numbers->begin() + static_cast<std::ptrdiff_t>(count)};
}

// Reads where the voxel data are. The value of ElementDataFile is LOCAL (this file), LIST (the names of the data files
// are in the following lines), a pattern of file names, or one file name.
void find_data(VolumeHeader& header, std::string_view value, std::string_view rest, std::size_t header_end,
               const std::string& where) {
  const auto words = words_of(value);
  if (words.empty()) throw Error("ElementDataFile names no file", where, "correct the header");
  const std::string first = lower_case(words[0]);
  if (first == "local" && words.size() == 1) {
    header.byte_skip = static_cast<std::int64_t>(header_end);
  } else if (first == "list" && words.size() <= 2) {
    while (!rest.empty() && header.data_names.size() <= 65536)
      if (const auto name = trimmed(take_line(rest)); !name.empty()) header.data_names.emplace_back(name);
    if (header.data_names.empty() || header.data_names.size() > 65536)
      throw Error("ElementDataFile = LIST names no usable list of files", where,
                  "list one file per slice below this line");
  } else if (value.find('%') != std::string_view::npos && words.size() >= 3) {
    const auto from = number_of<std::int64_t>(words[1]), to = number_of<std::int64_t>(words[2]);
    const auto step = words.size() > 3 ? number_of<std::int64_t>(words[3]) : 1;
    const auto names = from && to && step ? names_of_pattern(words[0], *from, *to, *step) : std::nullopt;
    if (!names) throw Error("ElementDataFile is " + in_quotes(value), where, "write NAME%03d.raw FIRST LAST STEP");
    header.data_names = *names;
  } else {
    header.data_names.emplace_back(value);
  }
}
}  // namespace

bool looks_like_meta_header(std::string_view bytes) {
  // The keys of a header may come in any order. One line `key = value` with a known key among the first eight lines is
  // enough to recognize MetaImage.
  std::string_view rest = bytes.substr(0, 4096);
  for (int line = 0; line < 8 && !rest.empty(); ++line) {
    const auto text = take_line(rest);
    const auto key = trimmed(text.substr(0, text.find('=')));
    if (text.find('=') != std::string_view::npos &&
        (key == "ObjectType" || key == "NDims" || key == "DimSize" || key == "ElementType" || key == "ElementDataFile"))
      return true;
  }
  return false;
}

VolumeHeader parse_meta_header(std::string_view bytes, const std::string& where) {
  Fields fields;
  std::string_view rest = bytes.substr(0, kLongestHeader);
  const std::size_t searched = rest.size();
  VolumeHeader header;
  header.format = "MetaImage";
  bool found_data = false;
  for (int line = 1; !rest.empty() && !found_data; ++line) {
    const std::string_view text = take_line(rest);
    if (trimmed(text).empty()) continue;
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos)
      throw Error("the header is damaged", where + " line " + std::to_string(line),
                  "expected `Key = value`, found " + in_quotes(text));
    const auto key = trimmed(text.substr(0, equals)), value = trimmed(text.substr(equals + 1));
    if (key == "ElementDataFile") {
      find_data(header, value, rest, searched - rest.size(), where);
      found_data = true;
    } else {
      fields[std::string(key)] = value;
    }
  }
  if (!found_data)
    throw Error("the header names no data (ElementDataFile)", where,
                "the file is cut off or is not a MetaImage; export it again");

  // Checks the kind of image and reads the voxel type.
  if (const auto* type = field(fields, {"ObjectType"}); type && *type != "Image")
    throw Error("this MetaImage file holds " + in_quotes(*type), where, "only ObjectType = Image is read");
  const auto axes = numbers_in<int>(fields, {"NDims"}, 1, {0}, where)[0];
  if (axes < 1 || axes > 10)
    throw Error("NDims is missing or wrong", where, "1 to 3 axes are read; correct the header");
  if (numbers_in<int>(fields, {"ElementNumberOfChannels"}, 1, {1}, where)[0] != 1)
    throw Error("the voxels have several channels (colours or vectors)", where, "export one label per voxel");
  const auto* type_name = field(fields, {"ElementType"});
  if (!type_name) throw Error("the header names no ElementType", where, "correct the header");
  if (type_name->ends_with("_ARRAY")) throw Error("the voxels are vectors", where, "export one label per voxel");
  const auto type = meta_type(*type_name);
  if (!type)
    throw Error("unknown ElementType " + in_quotes(*type_name), where,
                "use MET_UCHAR, MET_USHORT or another scalar type");
  header.voxel_type = *type;

  // Reads the grid of the voxels.
  if (!field(fields, {"DimSize"})) throw Error("the header names no DimSize", where, "correct the header");
  const std::size_t n = static_cast<std::size_t>(axes);
  RawGrid raw;
  raw.sizes = numbers_in<std::int64_t>(fields, {"DimSize"}, n, {}, where);
  const auto spacing =
      numbers_in<double>(fields, {"ElementSpacing", "ElementSize"}, n, std::vector<double>(n, 1.0), where);
  const auto origin =
      numbers_in<double>(fields, {"Offset", "Position", "Origin"}, n, std::vector<double>(n, 0.0), where);
  std::vector<double> straight(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) straight[i * n + i] = 1;
  const auto matrix =
      numbers_in<double>(fields, {"TransformMatrix", "Rotation", "Orientation"}, n * n, straight, where);
  for (std::size_t i = 0; i < std::min<std::size_t>(n, 3); ++i) {
    raw.spacing[static_cast<int>(i)] = spacing[i];
    raw.origin[static_cast<int>(i)] = origin[i];
    for (std::size_t j = 0; j < std::min<std::size_t>(n, 3); ++j)
      raw.direction[static_cast<int>(i)][static_cast<int>(j)] = matrix[i * n + j];
  }
  header.grid = checked_grid(raw, where, header.warnings);

  // Reads how the bytes are encoded.
  header.big_endian = is_true(field(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}));
  const auto* binary = field(fields, {"BinaryData"});
  if (binary && !is_true(binary)) header.encoding = Encoding::Ascii;
  else if (is_true(field(fields, {"CompressedData"}))) header.encoding = Encoding::Deflate;
  if (const auto* size = field(fields, {"CompressedDataSize"}); size && header.encoding == Encoding::Deflate) {
    const auto bytes_said = number_of<double>(*size);
    header.compressed_bytes =
        bytes_said && *bytes_said >= 0 && *bytes_said < 1e15 ? static_cast<std::int64_t>(*bytes_said) : -1;
  }
  if (!header.data_names.empty()) {
    header.byte_skip = numbers_in<std::int64_t>(fields, {"HeaderSize"}, 1, {0}, where)[0];
    if (header.byte_skip < -1) throw Error("HeaderSize is negative", where, "correct the header");
  }
  return header;
}

namespace {

std::string_view meta_type_name(VoxelType type) {
  constexpr std::array<std::string_view, 10> kNames = {"MET_CHAR",  "MET_UCHAR", "MET_SHORT",     "MET_USHORT",
                                                       "MET_INT",   "MET_UINT",  "MET_LONG_LONG", "MET_ULONG_LONG",
                                                       "MET_FLOAT", "MET_DOUBLE"};
  return kNames[static_cast<std::size_t>(type)];
}

constexpr std::string_view kCompressedSize = "CompressedDataSize = ";

std::string meta_header(const Voxels& voxels, const std::string& data_name, const std::string& compressed_size) {
  const Grid& grid = voxels.grid;
  std::string text = "ObjectType = Image\nNDims = 3\n";
  if (!voxels.description.empty()) text += "Comment = " + voxels.description + "\n";
  text += "BinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = " +
          std::string(voxels.compress ? "True" : "False") + "\n";
  if (voxels.compress) text += std::string(kCompressedSize) + compressed_size + "\n";
  text += "TransformMatrix =";
  for (int axis = 0; axis < 3; ++axis) text += " " + joined(grid.direction[axis]);
  text += "\nOffset = " + joined(grid.origin) + "\nCenterOfRotation = 0 0 0\nElementSpacing = " + joined(grid.spacing) +
          "\nDimSize = " + sizes_text(grid) + "\n";
  if (voxels.channels > 1) text += "ElementNumberOfChannels = " + std::to_string(voxels.channels) + "\n";
  return text + "ElementType = " + std::string(meta_type_name(voxels.type)) + "\nElementDataFile = " + data_name + "\n";
}

void write_meta(const Voxels& voxels, const Path& path) {
  constexpr int kDigits = 15;  // blanks written in the header, replaced by the compressed size once that is known
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    const std::string header = meta_header(voxels, "LOCAL", std::string(kDigits, ' '));
    write_text(out, header);
    write_data(out, voxels, Deflater::Wrap::Zlib);
    if (voxels.compress)
      out.overwrite(static_cast<std::int64_t>(header.find(kCompressedSize) + kCompressedSize.size()),
                    std::to_string(out.place() - static_cast<std::int64_t>(header.size())));
    out.close();
  });
}

void write_meta_beside_data(const Voxels& voxels, const Path& path) {
  write_detached(
      voxels, path, voxels.compress ? ".zraw" : ".raw", Deflater::Wrap::Zlib,
      [&](const std::string& data, std::int64_t bytes) { return meta_header(voxels, data, std::to_string(bytes)); });
}

}  // namespace

VolumeFormat metaimage_format() {
  return {.name = "MetaImage",
          .endings = {".mha", ".mhd"},
          .fits =
              [](std::string_view name, std::string_view bytes) {
                return name.ends_with(".mha") || name.ends_with(".mhd") || looks_like_meta_header(bytes);
              },
          .read_header =
              [](VolumeFiles& files, const PlainFile&, const std::string& bytes) {
                return parse_meta_header(bytes, files.location().headers.front().string());
              },
          .written = {{".mha", write_meta}, {".mhd", write_meta_beside_data, {".raw", ".zraw"}}}};
}

}  // namespace limber
