// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/obj_summary.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/base/error.h"

namespace limber {

namespace {
// Removes the first word from the line and returns this word. Returns an empty text if the line has no more words.
std::string_view take_word(std::string_view& line) {
  const size_t begin = line.find_first_not_of(" \t\v\f");
  if (begin == line.npos) return line = {};
  line.remove_prefix(begin);
  const std::string_view word = line.substr(0, line.find_first_of(" \t\v\f"));
  line.remove_prefix(word.size());
  return word;
}

template <class Number>
bool read_number(std::string_view word, Number& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && stop == word.data() + word.size();
}
}  // namespace

ObjSummary parse_obj_summary(const std::string& text, const std::string& where) {
  ObjSummary summary;
  std::int64_t line_number = 0, largest_corner = 0;
  auto refuse = [&](const char* what, const char* what_to_do) {
    throw Error(what, where + ", line " + std::to_string(line_number), what_to_do);
  };

  for (size_t begin = 0; begin < text.size();) {
    size_t end = text.find_first_of("\r\n", begin);
    if (end == text.npos) end = text.size();
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + (text.compare(end, 2, "\r\n") == 0 ? 2 : 1);
    ++line_number;

    const std::string_view word = take_word(line);
    if (word == "v") {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis)
        if (!read_number(take_word(line), p[axis]) || !std::isfinite(p[axis]))
          refuse("a vertex does not have three finite numbers", "correct the file");
      summary.lower = summary.vertices ? glm::min(summary.lower, p) : p;
      summary.upper = summary.vertices ? glm::max(summary.upper, p) : p;
      ++summary.vertices;
    } else if (word == "f") {
      int corners = 0;
      for (std::string_view corner = take_word(line); !corner.empty(); corner = take_word(line), ++corners) {
        std::int64_t vertex = 0;
        // The vertices of a file are numbered from 1. Negative numbers count backwards; -1 is the last vertex so far.
        if (!read_number(corner.substr(0, corner.find('/')), vertex) || vertex == 0 || vertex < -summary.vertices)
          refuse("a face has a corner that is not a vertex", "correct the file");
        largest_corner = std::max(largest_corner, vertex);
      }
      if (corners < 3) refuse("a face has fewer than three corners", "correct the file");
      ++summary.faces;
    } else if (word == "g" || word == "o") {
      ++summary.groups;
    }
  }
  if (summary.vertices == 0) throw Error("there are no vertices", where, "use a Wavefront OBJ file");
  if (largest_corner > summary.vertices)
    throw Error("a face names vertex " + std::to_string(largest_corner) + ", which is not one of the " +
                    std::to_string(summary.vertices) + " vertices",
                where, "copy the whole file again");
  return summary;
}

ObjSummary read_obj_summary(const Path& path) { return parse_obj_summary(read_file(path), path.string()); }

}  // namespace limber
