// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_file.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/mesh/surface_formats.h"

namespace limber {

namespace {
// A triangle whose height is below this share of its longest side counts as having no area: its normal cannot be
// computed.
constexpr double kLeastHeight = 1e-12;

struct PointKey {
  glm::dvec3 p;
  int index;
};

bool comes_before(const PointKey& a, const PointKey& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.p[axis] != b.p[axis]) return a.p[axis] < b.p[axis];
  return a.index < b.index;
}

// Returns for each point the first point at the same position. Uses sorting and not hashing, because no choice of
// points makes sorting slow.
std::vector<int> first_equal(const std::vector<glm::dvec3>& points) {
  std::vector<PointKey> keys;
  keys.reserve(points.size());
  for (const glm::dvec3& p : points) keys.push_back({p, static_cast<int>(keys.size())});
  std::sort(keys.begin(), keys.end(), comes_before);
  std::vector<int> first(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    first[keys[i].index] = i > 0 && keys[i].p == keys[i - 1].p ? first[keys[i - 1].index] : keys[i].index;
  return first;
}

bool has_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  return glm::length(glm::cross(b - a, c - a)) > kLeastHeight * longest * longest;
}

TriangleMesh merged(const SurfaceSoup& soup) {
  const std::vector<glm::dvec3>& points = soup.points();
  const std::vector<int> first = first_equal(points);
  std::vector<int> vertex(points.size(), -1);
  TriangleMesh mesh;
  for (const glm::ivec3& f : soup.triangles()) {
    if (!has_area(points[f.x], points[f.y], points[f.z])) continue;
    glm::ivec3& triangle = mesh.F.emplace_back();
    for (int i = 0; i < 3; ++i) {
      int& number = vertex[first[f[i]]];
      if (number < 0) {
        number = static_cast<int>(mesh.V.size());
        mesh.V.push_back(points[f[i]]);
      }
      triangle[i] = number;
    }
  }
  return mesh;
}
}  // namespace

void SurfaceSoup::refuse(const std::string& what, const std::string& what_to_do) const {
  throw Error(what, file_ + place(), what_to_do);
}

void SurfaceSoup::add_point(const glm::dvec3& p) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(p[axis]) <= kFarthestSurfacePoint))
      refuse(std::isfinite(p[axis]) ? "a point is more than a kilometre from the origin" : "a point is not finite",
             "export the object near the origin and in its true size: in millimetres, or glTF in metres");
  if (points_.size() >= 3 * kMostSurfaceTriangles)
    refuse("the surface has more than " + std::to_string(3 * kMostSurfaceTriangles) + " points",
           "simplify the surface in the program that made it");
  points_.push_back(p);
}

void SurfaceSoup::check_triangles(std::size_t count) const {
  if (count > kMostSurfaceTriangles)
    refuse("the surface has more than " + std::to_string(kMostSurfaceTriangles) + " triangles",
           "simplify the surface in the program that made it");
}

void SurfaceSoup::add_triangle(const glm::ivec3& f) {
  check_triangles(triangles_.size() + 1);
  triangles_.push_back(f);
}

void SurfaceSoup::add_polygon(std::span<const int> f) {
  for (std::size_t i = 2; i < f.size(); ++i) add_triangle({f[0], f[i - 1], f[i]});
}

TriangleMesh parse_surface(const std::string& bytes, const Path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (bytes.starts_with("version https://git-lfs"))
    throw Error("this is a Git LFS pointer, not the surface", path.string(), "fetch the file with git lfs pull");
  SurfaceSoup soup(path.string());
  if (extension == ".stl") read_stl(bytes, soup);
  else if (extension == ".obj") read_obj(bytes, soup);
  else if (extension == ".ply") read_ply(bytes, soup);
  else if (extension == ".glb" || extension == ".gltf") read_gltf(bytes, extension == ".glb", path.parent_path(), soup);
  else
    throw Error("surfaces cannot be read from a file with this extension", path.string(),
                std::string("use a file that ends in ") + kSurfaceFileEndings);
  TriangleMesh mesh = merged(soup);
  if (mesh.F.empty())
    throw Error("the file has no triangle with an area", path.string(), "export the object as a surface of triangles");
  return mesh;
}

TriangleMesh read_surface(const Path& path) { return parse_surface(read_file(path, kMostSurfaceBytes), path); }

}  // namespace limber
