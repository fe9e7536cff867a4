// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "editor/seams/seam_view.h"

namespace limber::editor {

namespace {

// A rectangle of voxel faces in a plane perpendicular to the grid axis `axis`. All coordinates are indices of voxel
// corners: voxel v reaches from corner v to corner v + 1. plane: the plane's coordinate along `axis`.
struct Rectangle {
  int axis, plane;
  glm::ivec2 low, high;  // corners of the rectangle; x: along axis (axis + 1) % 3; y: along axis (axis + 2) % 3
};

glm::ivec3 corner_of(const Rectangle& r, bool second, bool third) {
  glm::ivec3 corner;
  corner[r.axis] = r.plane;
  corner[(r.axis + 1) % 3] = second ? r.high.x : r.low.x;
  corner[(r.axis + 2) % 3] = third ? r.high.y : r.low.y;
  return corner;
}

// The voxel faces of a seam that lie in one grid plane (see Rectangle), grouped by row. The key is the row's coordinate
// along the grid axis (axis + 2) % 3; the value lists the coordinates of the row's faces along (axis + 1) % 3.
using Plane = std::map<int, std::vector<int>>;

std::vector<std::pair<int, int>> runs_of(std::vector<int> places) {
  std::sort(places.begin(), places.end());
  std::vector<std::pair<int, int>> runs;
  for (const int place : places)
    if (!runs.empty() && runs.back().second == place) ++runs.back().second;
    else runs.push_back({place, place + 1});
  return runs;
}

// Merges the voxel faces of one plane into rectangles. A rectangle consists of runs of consecutive faces that begin and
// end at the same coordinates in neighbouring rows.
void merge(int axis, int plane, const Plane& rows, std::vector<Rectangle>& rectangles) {
  std::map<std::pair<int, int>, int> open;  // rectangles that may still grow; key: begin and end of the run, value: row
  const auto close = [&](const std::pair<int, int>& run, int begin, int end) {
    rectangles.push_back({axis, plane, {run.first, begin}, {run.second, end}});
  };
  int last = 0;
  for (const auto& [row, places] : rows) {
    std::map<std::pair<int, int>, int> next;
    for (const auto& run : runs_of(places)) {
      const auto before = row == last + 1 ? open.find(run) : open.end();
      next[run] = before == open.end() ? row : before->second;
    }
    for (const auto& [run, begin] : open)
      if (row != last + 1 || !next.contains(run) || next[run] != begin) close(run, begin, last + 1);
    open = std::move(next);
    last = row;
  }
  for (const auto& [run, begin] : open) close(run, begin, last + 1);
}

// Collects the rim of a sheet of voxel faces, which consists of the voxel edges that belong to an odd number of the
// sheet's faces. Edges on the same grid line are stored together.
class Rims {
 public:
  void add(const glm::ivec3& lower, int axis) {
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    glm::ivec3 corner = lower;
    ++corner[axis];
    glm::ivec3 beyond_u = corner, beyond_w = corner;
    ++beyond_u[u];
    ++beyond_w[w];
    for (const auto& [at, along] : {std::pair(corner, u), {beyond_w, u}, {corner, w}, {beyond_u, w}}) toggle(at, along);
  }

  // Calls `body` for each straight run of consecutive rim edges, with the voxel corners at its two ends.
  template <class Body>
  void for_each(const Body& body) const {
    for (const auto& [line, places] : lines_) {
      const auto& [along, a, b] = line;
      std::vector<int> odd;
      for (const auto& [place, is_odd] : places)
        if (is_odd) odd.push_back(place);
      for (const auto& [begin, end] : runs_of(std::move(odd))) {
        glm::ivec3 from;
        from[(along + 1) % 3] = a;
        from[(along + 2) % 3] = b;
        from[along] = begin;
        glm::ivec3 to = from;
        to[along] = end;
        body(from, to);
      }
    }
  }

 private:
  void toggle(const glm::ivec3& at, int along) {
    bool& is_odd = lines_[{along, at[(along + 1) % 3], at[(along + 2) % 3]}][at[along]];
    is_odd = !is_odd;
  }

  std::map<std::tuple<int, int, int>, std::map<int, bool>> lines_;
};

}  // namespace

SeamSheet sheet_of(const Seams& seams, const Grid& grid) {
  std::map<std::pair<int, int>, Plane> planes;  // key: axis perpendicular to the plane, its coordinate on this axis
  Rims rims;
  seams.for_each([&](const glm::ivec3& lower, int axis) {
    planes[{axis, lower[axis] + 1}][lower[(axis + 2) % 3]].push_back(lower[(axis + 1) % 3]);
    rims.add(lower, axis);
  });
  std::vector<Rectangle> rectangles;
  for (const auto& [plane, rows] : planes) merge(plane.first, plane.second, rows, rectangles);
  const AffineTransform world = world_from_voxel(grid);
  const auto point = [&](const glm::ivec3& corner) { return world * (glm::dvec3(corner) - 0.5); };
  SeamSheet sheet;
  for (const Rectangle& r : rectangles)
    sheet.rectangles.push_back({point(corner_of(r, false, false)), point(corner_of(r, true, false)),
                                point(corner_of(r, true, true)), point(corner_of(r, false, true))});
  rims.for_each([&](const glm::ivec3& from, const glm::ivec3& to) { sheet.rims.push_back({point(from), point(to)}); });
  return sheet;
}

}  // namespace limber::editor
