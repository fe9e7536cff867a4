// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads STL. A binary file consists of a header of 80 bytes, the number of triangles, and 50 bytes for each triangle:
// normal, three corners, and two bytes that have no meaning. An ASCII file starts with the word "solid"; the header of
// a binary file may start with it too. Normals are not read, since the order of the corners contains the same
// information.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "core/mesh/surface_formats.h"

namespace limber {

namespace {
constexpr std::size_t kHeader = 84, kFacet = 50;

std::uint32_t little_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

float float_at(const char* bytes) {
  const std::uint32_t bits = little_endian(bytes);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void read_binary_stl(const std::string& bytes, SurfaceSoup& soup) {
  if (bytes.size() < kHeader) soup.refuse("the file is too short for STL", "copy the whole file again");
  const std::uint64_t count = little_endian(bytes.data() + 80), room = (bytes.size() - kHeader) / kFacet;
  if (count > room)
    soup.refuse(
        "the header states " + std::to_string(count) + " triangles, but the file has only " + std::to_string(room),
        "copy the whole file again");
  soup.check_triangles(count);
  std::uint64_t t = 0;
  soup.place = [&t] { return ", triangle " + std::to_string(t + 1); };
  for (; t < count; ++t) {
    const char* corners = bytes.data() + kHeader + t * kFacet + 12;
    const int first = static_cast<int>(soup.points().size());
    for (int i = 0; i < 3; ++i, corners += 12)
      soup.add_point({float_at(corners), float_at(corners + 4), float_at(corners + 8)});
    soup.add_triangle({first, first + 1, first + 2});
  }
}

// Reads the statements of an ASCII file, one a line. Statements other than "vertex" are only checked for their order.
class AsciiStl {
 public:
  AsciiStl(const std::string& bytes, SurfaceSoup& soup) : rest_(bytes), soup_(soup) {
    soup_.place = [this] { return ", line " + std::to_string(line_); };
  }

  void read() {
    while (!rest_.empty()) {
      ++line_;
      const std::vector<std::string_view> words = words_of(take_line(rest_).substr(0, kLongestLine));
      if (!words.empty()) read_statement(words);
    }
    if (state_ != State::Outside || solids_ == 0)
      soup_.refuse("the file ends before \"endsolid\"", "copy the whole file again");
  }

 private:
  enum class State { Outside, Solid, Facet, Loop, AfterLoop };
  static constexpr std::size_t kLongestLine = 1000;

  void read_statement(const std::vector<std::string_view>& words) {
    const std::string word = lower_case(words[0].substr(0, 20));
    if (word == "vertex" && state_ == State::Loop) return add_vertex(words);
    if (word == "endloop" && state_ == State::Loop) return end_loop();
    static constexpr struct {
      const char* word;
      State before, after;
    } kSteps[] = {{"solid", State::Outside, State::Solid},
                  {"facet", State::Solid, State::Facet},
                  {"outer", State::Facet, State::Loop},
                  {"endfacet", State::AfterLoop, State::Solid},
                  {"endsolid", State::Solid, State::Outside}};
    for (const auto& step : kSteps)
      if (word == step.word && state_ == step.before) {
        solids_ += word == "solid";
        state_ = step.after;
        return;
      }
    soup_.refuse(in_quotes(words[0]) + " has no meaning here", "correct the file, or export it again");
  }

  void add_vertex(const std::vector<std::string_view>& words) {
    if (words.size() < 4) soup_.refuse("a vertex does not have three numbers", "correct the file, or export it again");
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const auto number = number_of<double>(words[axis + 1]);
      if (!number)
        soup_.refuse(in_quotes(words[axis + 1]) + " was found where a vertex needs a number", "correct the file");
      p[axis] = *number;
    }
    if (++corners_ > 3) soup_.refuse("a facet has more than three vertices", "export the surface again, as triangles");
    soup_.check_triangles(soup_.triangles().size() + 1);
    soup_.add_point(p);
  }

  void end_loop() {
    if (corners_ != 3) soup_.refuse("a facet has fewer than three vertices", "correct the file, or export it again");
    const int end = static_cast<int>(soup_.points().size());
    soup_.add_triangle({end - 3, end - 2, end - 1});
    corners_ = 0;
    state_ = State::AfterLoop;
  }

  std::string_view rest_;
  SurfaceSoup& soup_;
  State state_ = State::Outside;
  std::int64_t line_ = 0, solids_ = 0;
  int corners_ = 0;
};

bool is_ascii_stl(const std::string& bytes) {
  if (bytes.size() >= kHeader && bytes.size() == kHeader + kFacet * std::uint64_t{little_endian(bytes.data() + 80)})
    return false;
  const std::string_view start = trimmed(std::string_view(bytes).substr(0, 1000));
  return lower_case(start.substr(0, 5)) == "solid" && start.find('\0') == start.npos;
}
}  // namespace

void read_stl(const std::string& bytes, SurfaceSoup& soup) {
  if (is_ascii_stl(bytes)) AsciiStl(bytes, soup).read();
  else read_binary_stl(bytes, soup);
  soup.place = [] { return std::string(); };
}

}  // namespace limber
