// SPDX-License-Identifier: AGPL-3.0-or-later
// The readers of surface files, one for each format, and the class that collects their triangles. surface_file.h
// describes the formats. Only surface_file.cpp and the readers include this header.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/file.h"
#include "core/base/text_parse.h"
#include "core/mesh/surface.h"

namespace limber {

// Collects the points and triangles of a file, at most kMostSurfaceTriangles triangles and three times as many points.
// A point may be added before it is known whether a triangle uses it, and several points may be at the same position.
class SurfaceSoup {
 public:
  explicit SurfaceSoup(std::string file) : file_(std::move(file)) {}

  // The part of the file that is being read, such as ", line 12", for error messages.
  std::function<std::string()> place = [] { return std::string(); };

  [[noreturn]] void refuse(const std::string& what, const std::string& what_to_do) const;

  void add_point(const glm::dvec3& p);            // adds a point, mm; throws Error if it is not finite or too far away
  void add_triangle(const glm::ivec3& f);         // adds a triangle of point indices; the points may be added later
  void add_polygon(std::span<const int> f);       // splits a polygon with three or more corners into a fan of triangles
  void check_triangles(std::size_t count) const;  // throws Error if `count` triangles are too many

  const std::vector<glm::dvec3>& points() const { return points_; }
  const std::vector<glm::ivec3>& triangles() const { return triangles_; }
  const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::vector<glm::dvec3> points_;
  std::vector<glm::ivec3> triangles_;
};

// Removes the next word from the front of `rest` and returns it. Returns an empty text if no word is left.
inline std::string_view next_word(std::string_view& rest) {
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  std::size_t end = 0;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end);
  return word;
}

// Each reader parses the bytes of a file and adds its triangles. At the end, every corner of a triangle must be the
// index of a point.
void read_stl(const std::string& bytes, SurfaceSoup& soup);
void read_obj(const std::string& bytes, SurfaceSoup& soup);
void read_ply(const std::string& bytes, SurfaceSoup& soup);
//   is_binary  true: a .glb file, false: a .gltf file
//   folder     folder in which files that a .gltf names are searched
void read_gltf(const std::string& bytes, bool is_binary, const Path& folder, SurfaceSoup& soup);

}  // namespace limber
