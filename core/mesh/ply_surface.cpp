// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads PLY [Turk, The PLY polygon file format, 1994]. The header of a PLY file lists elements, each with a number of
// rows and with properties, which are numbers or lists of numbers. Only x, y and z of "vertex" and the list
// "vertex_indices" (or "vertex_index") of "face" are used; everything else is skipped.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "core/mesh/surface_formats.h"

namespace limber {

namespace {
static_assert(std::endian::native == std::endian::little, "bytes are reversed for big-endian files");

constexpr std::size_t kLongestHeader = 1 << 20;

enum class PlyType { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

std::optional<PlyType> ply_type(std::string_view word) {
  static constexpr std::string_view kNames[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                                   {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                                   {"float", "float32"}, {"double", "float64"}};
  for (int i = 0; i < 8; ++i)
    if (word == kNames[i][0] || word == kNames[i][1]) return static_cast<PlyType>(i);
  return std::nullopt;
}

std::size_t size_of(PlyType type) {
  static constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<int>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> count;  // type of the length of a list; none: the property is a single number
};

struct PlyElement {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyFormat { Ascii, LittleEndian, BigEndian };

class PlyReader {
 public:
  PlyReader(const std::string& bytes, SurfaceSoup& soup) : bytes_(bytes), rest_(bytes), soup_(soup) {}

  void read() {
    read_header();
    for (const PlyElement& element : elements_) read_element(element);
    if (vertices_ == 0) soup_.refuse("there are no vertices", "export the object as a surface of triangles");
    if (soup_.triangles().empty()) soup_.refuse("there are no faces", "export the object as a surface of triangles");
  }

 private:
  // ---- Reads the header of the file.

  void read_header() {
    std::string_view header = rest_.substr(0, kLongestHeader);
    std::uint64_t line_number = 0;
    soup_.place = [&line_number] { return ", line " + std::to_string(line_number); };
    std::optional<PlyFormat> format;
    for (bool ended = false; !ended;) {
      if (header.empty()) soup_.refuse("the header has no end", "copy the whole file again");
      ++line_number;
      const std::string_view line = take_line(header);
      std::string_view words = line;
      const std::string_view word = next_word(words);
      if (line_number == 1 && word != "ply") soup_.refuse("this is not a PLY file", "export it again");
      if (word == "format") format = format_of(next_word(words));
      else if (word == "element") add_element(words);
      else if (word == "property") add_property(words);
      else if (word == "end_header") ended = true;
      else if (!word.empty() && word != "comment" && word != "obj_info" && word != "ply")
        soup_.refuse(in_quotes(word) + " has no meaning in a header", "correct the file, or export it again");
    }
    if (!format) soup_.refuse("the header names no format", "correct the file, or export it again");
    soup_.place = [] { return std::string(); };
    format_ = *format;
    rest_.remove_prefix(std::min(kLongestHeader, rest_.size()) - header.size());
  }

  PlyFormat format_of(std::string_view word) const {
    if (word == "ascii") return PlyFormat::Ascii;
    if (word == "binary_little_endian") return PlyFormat::LittleEndian;
    if (word == "binary_big_endian") return PlyFormat::BigEndian;
    soup_.refuse(in_quotes(word) + " is not a format of PLY", "export the file as ascii, or as binary_little_endian");
  }

  void add_element(std::string_view words) {
    PlyElement& element = elements_.emplace_back();
    element.name = next_word(words);
    const auto rows = number_of<std::uint64_t>(next_word(words));
    if (element.name.empty() || !rows)
      soup_.refuse("an element does not have a name and a number of rows", "correct the file, or export it again");
    for (const PlyElement& other : elements_)
      if (&other != &element && other.name == element.name)
        soup_.refuse("the element " + in_quotes(element.name) + " occurs twice", "correct the file");
    element.rows = *rows;
  }

  void add_property(std::string_view words) {
    if (elements_.empty()) soup_.refuse("a property stands before any element", "correct the file");
    PlyProperty property;
    std::string_view type = next_word(words);
    if (type == "list") {
      property.count = type_of(next_word(words));
      if (*property.count >= PlyType::Float) soup_.refuse("a list's length is not a whole number", "correct the file");
      type = next_word(words);
    }
    property.type = type_of(type);
    property.name = next_word(words);
    elements_.back().properties.push_back(std::move(property));
  }

  PlyType type_of(std::string_view word) const {
    const auto type = ply_type(word);
    if (!type) soup_.refuse(in_quotes(word) + " is not a type of PLY", "correct the file, or export it again");
    return *type;
  }

  // ---- Reads the rows of the elements.

  void read_element(const PlyElement& element) {
    if (element.properties.empty()) return;  // rows without properties take no bytes, whatever their number
    std::uint64_t row = 0;
    const bool is_known = element.name == "vertex" || element.name == "face";
    const std::string name = is_known ? element.name : in_quotes(element.name);
    soup_.place = [this, &name, &row] { return ", " + name + " " + std::to_string(row + 1) + line_text(); };
    if (element.name == "vertex") {
      const std::vector<int> axes = axes_of(element);
      for (; row < element.rows; ++row) read_vertex(element, axes);
      vertices_ = element.rows;
    } else if (element.name == "face") {
      const int corners = corners_of(element);
      if (vertices_ == 0) soup_.refuse("there are no vertices before the faces", "export the file again");
      for (; row < element.rows; ++row) read_face(element, corners);
    } else {
      for (; row < element.rows; ++row)
        for (const PlyProperty& property : element.properties) skip(property);
    }
    soup_.place = [] { return std::string(); };
  }

  // Returns, for each property of a vertex, the axis (0, 1, 2: x, y, z) whose coordinate it holds; -1: no coordinate.
  std::vector<int> axes_of(const PlyElement& element) const {
    std::vector<int> axes;
    int found = 0;
    for (const PlyProperty& property : element.properties) {
      const bool is_axis = !property.count && (property.name == "x" || property.name == "y" || property.name == "z");
      axes.push_back(is_axis ? property.name[0] - 'x' : -1);
      if (is_axis) found |= 1 << axes.back();
    }
    if (found != 7) soup_.refuse("the vertices do not have x, y and z", "export the file again");
    return axes;
  }

  int corners_of(const PlyElement& element) const {
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      if (const PlyProperty& property = element.properties[i];
          property.count && (property.name == "vertex_indices" || property.name == "vertex_index"))
        return static_cast<int>(i);
    soup_.refuse("the faces have no list vertex_indices", "export the file again");
  }

  void read_vertex(const PlyElement& element, const std::vector<int>& axes) {
    glm::dvec3 p(0);
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (axes[i] >= 0) p[axes[i]] = number(element.properties[i].type);
      else skip(element.properties[i]);
    soup_.add_point(p);
  }

  void read_face(const PlyElement& element, int corners) {
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != corners) {
        skip(property);
        continue;
      }
      const std::uint64_t count = length(property);
      if (count < 3) soup_.refuse("a face has fewer than three corners", "correct the file, or export it again");
      soup_.check_triangles(count - 2);
      corners_.clear();
      for (std::uint64_t k = 0; k < count; ++k) corners_.push_back(corner(property.type));
      soup_.add_polygon(corners_);
    }
  }

  int corner(PlyType type) {
    const double index = number(type);
    if (!(index >= 0 && index < static_cast<double>(vertices_) && index == std::floor(index)))
      soup_.refuse("a face has a corner that is not a vertex", "correct the file, or export it again");
    return static_cast<int>(index);
  }

  std::uint64_t length(const PlyProperty& property) {
    const double count = number(*property.count);
    if (!(count >= 0 && count <= 4294967295.0 && count == std::floor(count)))
      soup_.refuse("a list's length is not a whole number", "correct the file, or export it again");
    return static_cast<std::uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.count ? length(property) : 1;
    if (format_ == PlyFormat::Ascii) {
      for (std::uint64_t k = 0; k < count; ++k) take_text();
    } else {
      take_bytes(count * size_of(property.type));
    }
  }

  double number(PlyType type) {
    if (format_ == PlyFormat::Ascii) {
      const std::string_view word = take_text();
      const auto value = number_of<double>(word);
      if (!value) soup_.refuse(in_quotes(word) + " was found where a number is needed", "correct the file");
      return *value;
    }
    char raw[8];
    const std::string_view bytes = take_bytes(size_of(type));
    if (format_ == PlyFormat::LittleEndian) std::copy(bytes.begin(), bytes.end(), raw);
    else std::reverse_copy(bytes.begin(), bytes.end(), raw);
    switch (type) {
      case PlyType::Int8: return from<std::int8_t>(raw);
      case PlyType::Uint8: return from<std::uint8_t>(raw);
      case PlyType::Int16: return from<std::int16_t>(raw);
      case PlyType::Uint16: return from<std::uint16_t>(raw);
      case PlyType::Int32: return from<std::int32_t>(raw);
      case PlyType::Uint32: return from<std::uint32_t>(raw);
      case PlyType::Float: return from<float>(raw);
      case PlyType::Double: return from<double>(raw);
    }
    return 0;
  }

  template <class Value>
  static double from(const char* raw) {
    Value value;
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }

  std::string_view take_text() {
    const std::string_view word = next_word(rest_);
    if (word.empty()) soup_.refuse("the file ends too early", "copy the whole file again");
    return word;
  }

  std::string_view take_bytes(std::uint64_t size) {
    if (size > rest_.size()) soup_.refuse("the file ends too early", "copy the whole file again");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  // Returns the line up to which an ASCII file has been read, for an error message.
  std::string line_text() const {
    if (format_ != PlyFormat::Ascii) return {};
    const std::string_view done = bytes_.substr(0, bytes_.size() - rest_.size());
    return " (line " + std::to_string(1 + std::count(done.begin(), done.end(), '\n')) + ")";
  }

  std::string_view bytes_, rest_;
  SurfaceSoup& soup_;
  PlyFormat format_ = PlyFormat::Ascii;
  std::vector<PlyElement> elements_;
  std::uint64_t vertices_ = 0;
  std::vector<int> corners_;  // corners of the face that is being read
};
}  // namespace

void read_ply(const std::string& bytes, SurfaceSoup& soup) { PlyReader(bytes, soup).read(); }

}  // namespace limber
