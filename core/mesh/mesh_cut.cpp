// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/mesh_cut.h"

#include <algorithm>

namespace limber {

Eigen::MatrixX3i faces_of(const Eigen::MatrixX4i& T) {
  const auto neighbours = neighbours_of(T);
  std::vector<std::array<int, 3>> faces;
  for (int t = 0; t < T.rows(); ++t)
    for (int i = 0; i < 4; ++i)
      if (neighbours[t][i] < t) faces.push_back({T(t, kTetFaces[i][0]), T(t, kTetFaces[i][1]), T(t, kTetFaces[i][2])});
  Eigen::MatrixX3i F(faces.size(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) F.row(f) << faces[f][0], faces[f][1], faces[f][2];
  return F;
}

std::vector<Segment> plane_cut(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F, const glm::dvec3& point,
                               const glm::dvec3& normal) {
  const Eigen::VectorXd height =
      (V.rowwise() - Eigen::RowVector3d(point.x, point.y, point.z)) * Eigen::Vector3d(normal.x, normal.y, normal.z);
  std::vector<Segment> lines;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    Segment line;
    int ends = 0;
    for (int i = 0; i < 3; ++i) {
      // Always interpolates an edge from its node with the smaller index, so that the lines of neighbouring faces end
      // at exactly the same point.
      const int a = std::min(F(f, i), F(f, (i + 1) % 3)), b = std::max(F(f, i), F(f, (i + 1) % 3));
      if ((height[a] < 0) == (height[b] < 0)) continue;
      const Eigen::RowVector3d p = V.row(a) + (V.row(b) - V.row(a)) * (height[a] / (height[a] - height[b]));
      line[ends++] = {p[0], p[1], p[2]};
    }
    if (ends == 2) lines.push_back(line);
  }
  return lines;
}

void keep_behind(std::vector<Segment>& lines, const glm::dvec3& point, const glm::dvec3& normal) {
  std::erase_if(lines, [&](Segment& line) {
    const double from = glm::dot(line[0] - point, normal), to = glm::dot(line[1] - point, normal);
    if (from > 0 && to > 0) return true;
    if (from > 0) line[0] = glm::mix(line[0], line[1], from / (from - to));
    else if (to > 0) line[1] = glm::mix(line[0], line[1], from / (from - to));
    return false;
  });
}

}  // namespace limber
