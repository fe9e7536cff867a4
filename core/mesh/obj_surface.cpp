// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the vertices and faces of Wavefront OBJ. Texture coordinates, normals, groups, lines and all other statements
// are skipped.
#include <cmath>
#include <cstdint>

#include "core/mesh/surface_file.h"
#include "core/mesh/surface_formats.h"

namespace limber {

namespace {
class ObjReader {
 public:
  ObjReader(const std::string& bytes, SurfaceSoup& soup) : rest_(bytes), soup_(soup) {
    soup_.place = [this] { return ", line " + std::to_string(line_); };
  }

  void read() {
    while (!rest_.empty()) {
      std::string_view line = take_counted_line();
      if (line.ends_with('\\')) {
        joined_.clear();
        for (; line.ends_with('\\'); line = take_counted_line()) joined_.append(line.substr(0, line.size() - 1)) += ' ';
        line = joined_.append(line);
      }
      read_statement(line);
    }
    line_ = line_of_last_;
    if (last_ > static_cast<std::int64_t>(soup_.points().size()))
      soup_.refuse("a face names vertex " + std::to_string(last_) + ", which is not one of the " +
                       std::to_string(soup_.points().size()) + " vertices",
                   "copy the whole file again");
  }

 private:
  std::string_view take_counted_line() {
    ++line_;
    return take_line(rest_);
  }

  void read_statement(std::string_view line) {
    line = trimmed(line.substr(0, line.find('#')));
    if (line.size() < 2 || !is_blank(line[1])) return;
    if (line[0] == 'v') add_vertex(line.substr(2));
    if (line[0] == 'f') add_face(line.substr(2));
  }

  void add_vertex(std::string_view line) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const auto number = number_of<double>(next_word(line));
      if (!number || !std::isfinite(*number))
        soup_.refuse("a vertex does not have three finite numbers", "correct the file");
      p[axis] = *number;
    }
    soup_.add_point(p);
  }

  // OBJ numbers the vertices of a file from 1. Negative numbers count backwards: -1 is the last vertex so far.
  void add_face(std::string_view line) {
    const auto count = static_cast<std::int64_t>(soup_.points().size());
    constexpr std::int64_t kMost = 3 * kMostSurfaceTriangles;
    corners_.clear();
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      const auto vertex = number_of<std::int64_t>(word.substr(0, word.find('/')));
      if (!vertex || *vertex == 0 || *vertex < -count || *vertex > kMost)
        soup_.refuse(in_quotes(word) + " was found where a face needs a vertex number", "correct the file");
      if (*vertex > last_) last_ = *vertex, line_of_last_ = line_;
      corners_.push_back(static_cast<int>(*vertex > 0 ? *vertex - 1 : count + *vertex));
      soup_.check_triangles(corners_.size() - 1);  // stops at an endless face before it fills the memory
    }
    if (corners_.size() < 3) soup_.refuse("a face has fewer than three corners", "correct the file");
    soup_.add_polygon(corners_);
  }

  std::string_view rest_;
  SurfaceSoup& soup_;
  std::string joined_;        // a statement that backslashes continue over several lines, joined
  std::vector<int> corners_;  // corners of the face that is being read
  std::int64_t line_ = 0;
  std::int64_t last_ = 0, line_of_last_ = 0;  // the largest vertex number in a face, and the line in which it occurs
};
}  // namespace

void read_obj(const std::string& bytes, SurfaceSoup& soup) {
  ObjReader(bytes, soup).read();
  soup.place = [] { return std::string(); };
}

}  // namespace limber
