// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/nrrd.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
// Limit on the length of a header, bytes; it is enough for thousands of segments.
constexpr std::size_t kLongestHeader = 16 << 20;

struct NrrdText {
  std::map<std::string, std::string, std::less<>> fields;  // names in lower case without spaces: "spacedirections"
  KeyValues keys;
  std::vector<std::string> data_list;
  std::size_t end = 0;  // offset of the first byte after the empty line that ends the header
  bool ended = false;   // the header's empty line was found
};

std::string field_name(std::string_view text) {
  std::string name;
  for (char c : lower_case(text))
    if (c != ' ' && c != '\t') name += c;
  return name;
}

std::string unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\'))
      plain += text[++i] == 'n' ? '\n' : '\\';
    else plain += text[i];
  }
  return plain;
}

NrrdText split_header(std::string_view bytes, const std::string& where) {
  NrrdText text;
  std::string_view rest = bytes.substr(0, kLongestHeader);
  const std::size_t searched = rest.size();
  take_line(rest);  // the first line, "NRRD000N", only states the version
  bool in_list = false;
  for (int line = 2; !rest.empty(); ++line) {
    const std::string_view content = take_line(rest);
    if (content.empty() && !in_list) {
      text.ended = true;
      break;
    }
    if (content.empty()) continue;
    if (content[0] == '#') continue;
    if (in_list) {
      text.data_list.emplace_back(trimmed(content));
      if (text.data_list.size() > 65536) throw Error("the list of data files is too long", where, "use one data file");
      continue;
    }
    const std::size_t colon = content.find(':');
    if (colon == std::string_view::npos || colon + 1 >= content.size())
      throw Error("the header is damaged", where + " line " + std::to_string(line),
                  "expected `field: value`, found " + in_quotes(content));
    const auto name = content.substr(0, colon);
    if (content[colon + 1] == '=') {
      text.keys[std::string(trimmed(name))] = unescaped(content.substr(colon + 2));
    } else {
      const std::string key = field_name(name);
      const auto value = trimmed(content.substr(colon + 1));
      text.fields[key] = value;
      in_list = key == "datafile" && lower_case(value.substr(0, 4)) == "list";
    }
  }
  text.end = searched - rest.size();
  return text;
}

std::optional<VoxelType> nrrd_type(std::string_view name) {
  static const std::map<std::string, VoxelType, std::less<>> kTypes = [] {
    std::map<std::string, VoxelType, std::less<>> types;
    const std::vector<std::pair<VoxelType, std::string_view>> names = {
        {VoxelType::Int8, "signed char|int8|int8_t"},
        {VoxelType::UInt8, "uchar|unsigned char|uint8|uint8_t"},
        {VoxelType::Int16, "short|short int|signed short|signed short int|int16|int16_t"},
        {VoxelType::UInt16, "ushort|unsigned short|unsigned short int|uint16|uint16_t"},
        {VoxelType::Int32, "int|signed int|int32|int32_t"},
        {VoxelType::UInt32, "uint|unsigned int|uint32|uint32_t"},
        {VoxelType::Int64, "longlong|long long|long long int|signed long long|signed long long int|int64|int64_t"},
        {VoxelType::UInt64, "ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t"},
        {VoxelType::Float32, "float"},
        {VoxelType::Float64, "double"}};
    for (auto [type, list] : names)
      while (!list.empty()) {
        const auto bar = std::min(list.find('|'), list.size());
        types.emplace(list.substr(0, bar), type);
        list.remove_prefix(std::min(bar + 1, list.size()));
      }
    return types;
  }();
  const auto found = kTypes.find(lower_case(name));
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

// Parses a list of vectors, one for each axis, such as "(1,0,0) none (0,1,0)". "none" stands for an axis without a
// vector.
std::vector<std::optional<glm::dvec3>> vectors_of(std::string_view text, int dimension, const std::string& field,
                                                  const std::string& where) {
  const auto wrong = [&] {
    return Error("`" + field + "` is " + in_quotes(text), where, "write one vector like (1,0,0) per axis, or none");
  };
  std::vector<std::optional<glm::dvec3>> vectors;
  while (!(text = trimmed(text)).empty()) {
    if (vectors.size() > 16) throw wrong();
    if (lower_case(text.substr(0, 4)) == "none") {
      vectors.push_back(std::nullopt);
      text.remove_prefix(4);
      continue;
    }
    const std::size_t close = text.find(')');
    if (text[0] != '(' || close == std::string_view::npos) throw wrong();
    std::string inside(text.substr(1, close - 1));
    for (char& c : inside)
      if (c == ',') c = ' ';
    const auto numbers = numbers_of<double>(inside);
    if (!numbers || static_cast<int>(numbers->size()) != dimension) throw wrong();
    glm::dvec3 vector(0);
    for (int i = 0; i < std::min(dimension, 3); ++i) vector[i] = (*numbers)[i];
    vectors.push_back(vector);
    text.remove_prefix(close + 1);
  }
  return vectors;
}

// An anatomical space that NRRD names: its number of dimensions, and the sign of each coordinate axis relative to LPS.
struct Space {
  glm::dvec3 to_lps{1};
  int dimension = 3;
};
std::optional<Space> space_of(std::string name) {
  name = lower_case(name);
  Space space;
  if (name.ends_with("-time")) {
    space.dimension = 4;
    name.resize(name.size() - 5);
  } else if (name.size() == 4 && name.back() == 't') {
    space.dimension = 4;
    name.pop_back();
  }
  if (name == "left-posterior-superior" || name == "lps" || name == "scanner-xyz" || name == "3d-right-handed" ||
      name == "3d-left-handed")
    return space;
  if (name == "right-anterior-superior" || name == "ras") space.to_lps = {-1, -1, 1};
  else if (name == "left-anterior-superior" || name == "las") space.to_lps = {1, -1, 1};
  else return std::nullopt;
  return space;
}

double millimetres_per(const std::string* units) {
  if (!units) return 1;
  const std::string text = lower_case(*units);
  const auto has = [&](std::string_view unit) {
    return text.find("\"" + std::string(unit) + "\"") != std::string::npos;
  };
  if (has("m") || has("meter") || has("metre")) return 1000;
  if (has("cm")) return 10;
  if (has("um") || has("micrometer") || has("micron")) return 1e-3;
  return 1;
}

// Returns the names and colours of 3D Slicer's segments from the header's keys. When several segments have one label
// value, the first one is taken. The others belong to further layers, which are stored as further volumes of the file.
TissueTable segments_of(const KeyValues& keys, const std::string& where) {
  TissueTable table;
  std::set<double> seen;
  for (const auto& [key, value] : keys) {
    if (!key.starts_with("Segment") || !key.ends_with("_LabelValue")) continue;
    const std::string prefix = key.substr(0, key.size() - std::string_view("LabelValue").size());
    const auto get = [&](const char* name) -> const std::string* {
      const auto found = keys.find(prefix + name);
      return found == keys.end() ? nullptr : &found->second;
    };
    const auto label = number_of<double>(value);
    if (!label || !std::isfinite(*label))
      throw Error("the key " + in_quotes(key) + " is " + in_quotes(value), where, "a label value is a number");
    if (*label == 0 || !seen.insert(*label).second) continue;
    Tissue tissue;
    tissue.file_value = *label;
    if (const auto* name = get("Name")) tissue.name = *name;
    // NaN means that the file has no colour; open_volume() then sets one.
    tissue.colour.x = std::numeric_limits<float>::quiet_NaN();
    if (const auto* colour = get("Color"))
      if (const auto rgb = numbers_of<double>(*colour); rgb && rgb->size() == 3)
        for (int i = 0; i < 3; ++i) tissue.colour[i] = static_cast<float>(std::clamp((*rgb)[i], 0.0, 1.0));
    table.tissues.push_back(tissue);
  }
  if (!table.tissues.empty()) table.source = "names in the file";
  return table;
}

class NrrdReader {
 public:
  NrrdReader(std::string_view bytes, const std::string& where) : text_(split_header(bytes, where)), where_(where) {}

  VolumeHeader read() {
    header_.format = "NRRD";
    read_shape();
    read_encoding();
    read_data_place();
    header_.named = segments_of(text_.keys, where_);
    header_.keys = std::move(text_.keys);
    return std::move(header_);
  }

 private:
  const std::string* get(std::string_view name) const {
    const auto found = text_.fields.find(name);
    return found == text_.fields.end() ? nullptr : &found->second;
  }
  const std::string& need(std::string_view name) const {
    const auto* value = get(name);
    if (!value)
      throw Error("the header has no `" + std::string(name) + "`", where_,
                  "the file is cut off or is not NRRD; export it again");
    return *value;
  }
  std::optional<std::vector<double>> per_axis(std::string_view name) const {
    const auto* text = get(name);
    if (!text) return std::nullopt;
    auto numbers = numbers_of<double>(*text);
    if (!numbers || numbers->size() != sizes_.size())
      throw Error("`" + std::string(name) + "` is " + in_quotes(*text), where_, "one number per axis is needed");
    return numbers;
  }

  void read_shape() {
    const auto dimension = number_of<int>(need("dimension"));
    if (!dimension || *dimension < 1 || *dimension > 16)
      throw Error("`dimension` is " + in_quotes(need("dimension")), where_, "1 to 3 axes are read");
    const auto sizes = numbers_of<std::int64_t>(need("sizes"));
    if (!sizes || static_cast<int>(sizes->size()) != *dimension)
      throw Error("`sizes` is " + in_quotes(need("sizes")), where_, "one whole number per axis is needed");
    sizes_ = *sizes;
    const auto type = nrrd_type(need("type"));
    if (!type)
      throw Error("voxels of type " + in_quotes(need("type")) + " cannot be read", where_,
                  "use uint8, uint16 or another scalar type");
    header_.voxel_type = *type;

    const auto space_axes = find_space_axes();
    RawGrid raw = get("spacedirections") ? directed_grid(space_axes) : spaced_grid(space_axes);
    raw.sizes.clear();
    for (std::size_t axis : space_axes) raw.sizes.push_back(sizes_[axis]);
    const double unit = millimetres_per(get("spaceunits") ? get("spaceunits") : get("units"));
    raw.spacing *= unit;
    raw.origin *= unit;
    header_.grid = checked_grid(raw, where_, header_.warnings);
  }

  // Returns the indices of the axes that span space, at most three. Throws Error when one of the remaining axes has
  // more than one sample.
  std::vector<std::size_t> find_space_axes() const {
    std::vector<std::string> kinds(sizes_.size(), "");
    if (const auto* text = get("kinds")) {
      const auto words = words_of(*text);
      if (words.size() != sizes_.size())
        throw Error("`kinds` is " + in_quotes(*text), where_, "one word per axis is needed");
      for (std::size_t i = 0; i < words.size(); ++i) kinds[i] = lower_case(words[i]);
    }
    std::vector<bool> in_space(sizes_.size(), true);
    for (std::size_t i = 0; i < sizes_.size(); ++i)
      if (!kinds[i].empty() && kinds[i] != "domain" && kinds[i] != "space" && kinds[i] != "none" && kinds[i] != "???")
        in_space[i] = false;
    if (const auto* text = get("spacedirections")) {
      const auto vectors = vectors_of(*text, space().dimension, "space directions", where_);
      if (vectors.size() != sizes_.size())
        throw Error("`space directions` is " + in_quotes(*text), where_, "one vector per axis is needed");
      for (std::size_t i = 0; i < vectors.size(); ++i) in_space[i] = in_space[i] && vectors[i].has_value();
    }
    std::vector<std::size_t> axes;
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
      if (in_space[i] && axes.size() < 3) axes.push_back(i);
      else if (sizes_[i] != 1)
        throw Error("the file holds " + std::to_string(sizes_[i]) + " values per voxel or volumes (axis " +
                        std::to_string(i + 1) + ")",
                    where_, "export one label per voxel: no colours, no time, no overlapping segments");
    }
    if (axes.empty()) throw Error("no axis of the file spans space", where_, "correct `kinds` or `space directions`");
    return axes;
  }

  Space space() const {
    if (const auto* name = get("space")) {
      const auto known = space_of(*name);
      if (!known) throw Error("unknown space " + in_quotes(*name), where_, "use left-posterior-superior, RAS or LAS");
      return *known;
    }
    Space plain;
    if (const auto* text = get("spacedimension")) {
      const auto number = number_of<int>(*text);
      if (!number || *number < 1 || *number > 8)
        throw Error("`space dimension` is " + in_quotes(*text), where_, "use 3");
      plain.dimension = *number;
    }
    return plain;
  }

  RawGrid directed_grid(const std::vector<std::size_t>& axes) const {
    const Space in = space();
    const auto vectors = vectors_of(*get("spacedirections"), in.dimension, "space directions", where_);
    glm::dmat3 columns(1);
    for (std::size_t i = 0; i < axes.size(); ++i) columns[static_cast<int>(i)] = *vectors[axes[i]] * in.to_lps;
    complete(columns, axes.size());
    glm::dvec3 origin(0);
    if (const auto* text = get("spaceorigin")) {
      const auto found = vectors_of(*text, in.dimension, "space origin", where_);
      if (found.size() != 1 || !found[0])
        throw Error("`space origin` is " + in_quotes(*text), where_, "write one vector like (0,0,0)");
      origin = *found[0] * in.to_lps;
    }
    return grid_from_columns({}, columns, origin);
  }

  // Completes the axes of a file with only one or two spatial axes. Each missing axis is 1 mm long and perpendicular to
  // the others.
  static void complete(glm::dmat3& columns, std::size_t count) {
    if (count == 2) {
      const glm::dvec3 normal = glm::cross(columns[0], columns[1]);
      const double length = glm::length(normal);
      columns[2] = length > 0 ? normal / length : glm::dvec3(0);
    } else if (count == 1) {
      const glm::dvec3 along = columns[0];
      const glm::dvec3 other = std::abs(along.x) < std::abs(along.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      const glm::dvec3 second = glm::cross(glm::cross(along, other), along);
      const double length = glm::length(second);
      columns[1] = length > 0 ? second / length : glm::dvec3(0);
      const glm::dvec3 third = glm::cross(along, columns[1]);
      columns[2] = glm::length(third) > 0 ? third / glm::length(third) : glm::dvec3(0);
    }
  }

  // Returns the grid of a file without `space directions`. The spacing comes from the field `spacings`, else from the
  // range between `axis mins` and `axis maxs`, else it is 1 mm.
  RawGrid spaced_grid(const std::vector<std::size_t>& axes) const {
    const auto spacings = per_axis("spacings"), lowest = per_axis("axismins"), highest = per_axis("axismaxs");
    std::vector<bool> node(sizes_.size(), false);
    if (const auto* text = get("centerings") ? get("centerings") : get("centers")) {
      const auto words = words_of(*text);
      for (std::size_t i = 0; i < std::min(words.size(), node.size()); ++i) node[i] = lower_case(words[i]) == "node";
    }
    RawGrid raw;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const std::size_t axis = axes[i];
      double spacing = 1;
      if (spacings) {
        spacing = (*spacings)[axis];
      } else if (lowest && highest) {
        const double range = (*highest)[axis] - (*lowest)[axis];
        const double steps = static_cast<double>(sizes_[axis]) - (node[axis] ? 1.0 : 0.0);
        if (std::isfinite(range) && steps > 0) spacing = range / steps;
      }
      raw.spacing[static_cast<int>(i)] = spacing;
      const double start = lowest ? (*lowest)[axis] : std::numeric_limits<double>::quiet_NaN();
      if (std::isfinite(start)) raw.origin[static_cast<int>(i)] = start + (node[axis] ? 0 : spacing / 2);
    }
    if (const auto* text = get("spaceorigin")) {
      const Space in = space();
      const auto found = vectors_of(*text, in.dimension, "space origin", where_);
      if (found.size() == 1 && found[0]) raw.origin = *found[0] * in.to_lps;
    }
    return raw;
  }

  void read_encoding() {
    const std::string name = lower_case(need("encoding"));
    if (name == "raw") header_.encoding = Encoding::Raw;
    else if (name == "gzip" || name == "gz") header_.encoding = Encoding::Deflate;
    else if (name == "bzip2" || name == "bz2") header_.encoding = Encoding::Bzip2;
    else if (name == "ascii" || name == "text" || name == "txt") header_.encoding = Encoding::Ascii;
    else if (name == "hex") header_.encoding = Encoding::Hex;
    else throw Error("unknown encoding " + in_quotes(name), where_, "use raw, gzip, bzip2, ascii or hex");

    const auto* endian = get("endian");
    if (endian && lower_case(*endian) != "little" && lower_case(*endian) != "big")
      throw Error("`endian` is " + in_quotes(*endian), where_, "use little or big");
    header_.big_endian = endian && lower_case(*endian) == "big";
    if (!endian && size_of(header_.voxel_type) > 1 && header_.encoding != Encoding::Ascii)
      header_.warnings.push_back("the header does not say which byte comes first: " + where_ +
                                 ": little endian is assumed");
  }

  std::int64_t skip(std::string_view name, std::string_view other, std::int64_t lowest) const {
    const auto* text = get(name) ? get(name) : get(other);
    if (!text) return 0;
    const auto number = number_of<std::int64_t>(*text);
    if (!number || *number < lowest || *number > (std::int64_t{1} << 50))
      throw Error("`" + std::string(name) + "` is " + in_quotes(*text), where_, "correct the header");
    return *number;
  }

  void read_data_place() {
    header_.line_skip = skip("lineskip", "lineskip", 0);
    const std::int64_t bytes = skip("byteskip", "byteskip", -1);
    const bool coded = header_.encoding == Encoding::Deflate || header_.encoding == Encoding::Bzip2;
    if (bytes < 0 && header_.encoding != Encoding::Raw)
      throw Error("`byte skip` is -1", where_, "only raw data may be counted from the file's end");
    (coded ? header_.decoded_skip : header_.byte_skip) = bytes;

    const auto* name = get("datafile");
    if (!name) {
      if (!text_.ended) throw Error("no empty line ends the header", where_, "the file is cut off; export it again");
      if (header_.byte_skip >= 0) header_.byte_skip += static_cast<std::int64_t>(text_.end);
      // Throws Error if `line skip` is set: data in the header's own file begin at byte_skip, which is already counted
      // from the end of the header.
      attached_line_skip();
      return;
    }
    const auto words = words_of(*name);
    if (words.empty()) throw Error("`data file` names no file", where_, "correct the header");
    if (lower_case(words[0]) == "list") {
      header_.data_names = text_.data_list;
      if (header_.data_names.empty())
        throw Error("`data file: LIST` lists no file", where_, "name one file per line below this line");
    } else if (name->find('%') != std::string::npos && words.size() >= 4) {
      const auto first = number_of<std::int64_t>(words[1]), last = number_of<std::int64_t>(words[2]),
                 step = number_of<std::int64_t>(words[3]);
      const auto names = first && last && step ? names_of_pattern(words[0], *first, *last, *step) : std::nullopt;
      if (!names) throw Error("`data file` is " + in_quotes(*name), where_, "write NAME%03d.raw FIRST LAST STEP");
      header_.data_names = *names;
    } else {
      header_.data_names.push_back(*name);
    }
  }

  void attached_line_skip() const {
    if (header_.line_skip > 0)
      throw Error("`line skip` is given, but the data are in the header's file", where_,
                  "use it only with a `data file`");
  }

  NrrdText text_;
  std::string where_;
  std::vector<std::int64_t> sizes_;
  VolumeHeader header_;
};
}  // namespace

std::string nrrd_escaped(std::string_view value) {
  std::string safe;
  for (const char c : value) {
    if (c == '\\') safe += "\\\\";
    else if (c == '\n') safe += "\\n";
    else if (c == '\r') safe += ' ';
    else safe += c;
  }
  return safe;
}

bool looks_like_nrrd_header(std::string_view bytes) {
  return bytes.size() >= 8 && bytes.substr(0, 7) == "NRRD000" && bytes[7] >= '1' && bytes[7] <= '5';
}

VolumeHeader parse_nrrd_header(std::string_view bytes, const std::string& where) {
  if (!looks_like_nrrd_header(bytes))
    throw Error("this is not an NRRD file", where, "it should begin with NRRD0001 to NRRD0005");
  return NrrdReader(bytes, where).read();
}

}  // namespace limber
