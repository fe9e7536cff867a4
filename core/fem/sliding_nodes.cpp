// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/sliding_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include <Eigen/Geometry>

#include "core/deform/box_bins.h"

namespace limber {

namespace {

// Cosine of the angle from a surface's normal within which another bone counts as in front of it.
constexpr double kInFront = 0.5;
// Distances, as multiples of the tets' edge length. A node slides if most soft voxels on bone near it are loose tissue.
// The nearest of these voxels must lie within kFurthest; those at most kDecides further away than the nearest one
// count. Where skin is thin, the mesh's bone ends below the voxels' bone (LatticeNetSettings).
constexpr double kDecides = 0.5, kFurthest = 2;
// For the distance field of a bone's surface, as multiples of the tets' edge length: the distance between samples, the
// distance over which the field is smoothed, and the margin around the sliding nodes.
constexpr double kSample = 0.25, kSmooth = 0.3, kMargin = 4;

glm::dvec3 vec_of(const Eigen::RowVector3d& p) { return {p[0], p[1], p[2]}; }

bool is_loose(TissueKind kind) {
  switch (kind) {
    case TissueKind::Skin:
    case TissueKind::Fat:
    case TissueKind::Connective:
    case TissueKind::Vessel:
    case TissueKind::Blood:
    case TissueKind::Nerve: return true;
    default: return false;
  }
}

// The surface between bone and soft tissue at each node: its area, and the normal out of the bone, times that area.
struct BoneFaces {
  std::vector<double> mm2;
  NodePositions normal;

  explicit BoneFaces(const TetMesh& mesh) : mm2(mesh.V.rows(), 0), normal(NodePositions::Zero(mesh.V.rows(), 3)) {
    const auto neighbours = neighbours_of(mesh);
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
      if (mesh.region[t] == TetMesh::kSoft) continue;
      for (int face = 0; face < 4; ++face) {
        const int next = neighbours[t][face];
        if (next < 0 || mesh.region[next] != TetMesh::kSoft) continue;
        std::array<Eigen::RowVector3d, 3> p;
        for (int i = 0; i < 3; ++i) p[i] = mesh.V.row(mesh.T(t, kTetFaces[face][i]));
        const Eigen::RowVector3d out = (p[1] - p[0]).cross(p[2] - p[0]) / 2;
        for (int i = 0; i < 3; ++i) {
          mm2[mesh.T(t, kTetFaces[face][i])] += out.norm() / 3;
          normal.row(mesh.T(t, kTetFaces[face][i])) += out / 3;
        }
      }
    }
  }
};

// Marks the nodes in front of which another bone lies within `reach` mm.
//   motion  of the bones; empty: at rest
void mark_faced(const TetMesh& mesh, const std::vector<int>& bone, const NodePositions& normal,
                const std::vector<RigidTransform>& motion, double reach, std::vector<std::uint8_t>& faced) {
  std::vector<int> nodes;
  std::vector<glm::dvec3> place;
  for (int v = 0; v < int(mesh.V.rows()); ++v) {
    if (bone[v] < 0) continue;
    nodes.push_back(v);
    const glm::dvec3 rest = vec_of(mesh.V.row(v));
    place.push_back(motion.empty() ? rest : motion[bone[v]] * rest);
  }
  const PointBins bins(place, reach);
  std::vector<int> near;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const int v = nodes[k];
    const double length = normal.row(v).norm();
    if (faced[v] || length == 0) continue;
    glm::dvec3 out = vec_of(normal.row(v)) / length;
    if (!motion.empty()) out = motion[bone[v]].rotation * out;
    bins.near(place[k], near);
    faced[v] = std::any_of(near.begin(), near.end(), [&](int n) {
      const glm::dvec3 to = place[n] - place[k];
      const double distance = glm::length(to);
      return bone[nodes[n]] != bone[v] && distance < reach && glm::dot(to, out) > kInFront * distance;
    });
  }
}

// Finds which soft tissue lies on the bones of a volume.
class TissueOnBone {
 public:
  TissueOnBone(const LabelVolume& volume, const TissueTable& tissues, double tet_mm)
      : volume_(volume),
        tet_mm_(tet_mm),
        bone_(65536, 0),
        loose_(65536, 0) {
    for (const Tissue& each : tissues.tissues) {
      bone_[each.label] = is_bone(each.kind);
      loose_[each.label] = is_loose(each.kind);
    }
  }

  // Returns whether most of the tissue on the bone near a place is loose.
  bool is_loose_at(const glm::dvec3& world) const {
    const glm::dvec3 at = voxel_from_world(volume_.grid) * world, spacing = volume_.grid.spacing;
    const glm::ivec3 middle(glm::floor(at + 0.5)), reach(glm::ceil(kFurthest * tet_mm_ / spacing));
    std::vector<std::pair<double, bool>> seen;  // (distance of a soft voxel on bone, whether it is loose)
    for (int z = -reach.z; z <= reach.z; ++z)
      for (int y = -reach.y; y <= reach.y; ++y)
        for (int x = -reach.x; x <= reach.x; ++x) {
          const glm::ivec3 v = middle + glm::ivec3(x, y, z);
          const Label label = volume_.at_or_air(v);
          if (label == 0 || bone_[label]) continue;
          const double mm = glm::length((glm::dvec3(v) - at) * spacing);
          if (mm <= kFurthest * tet_mm_ && is_on_bone(v)) seen.push_back({mm, loose_[label] != 0});
        }
    if (seen.empty()) return false;
    const double limit = std::min_element(seen.begin(), seen.end())->first + kDecides * tet_mm_;
    std::int64_t loose = 0, all = 0;
    for (const auto& [mm, is] : seen)
      if (mm <= limit) loose += is, ++all;
    return 2 * loose > all;
  }

 private:
  bool is_on_bone(const glm::ivec3& v) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        glm::ivec3 next = v;
        next[axis] += side;
        if (bone_[volume_.at_or_air(next)]) return true;
      }
    return false;
  }

  const LabelVolume& volume_;
  double tet_mm_;
  LabelSet bone_, loose_;
};

}  // namespace

std::vector<std::uint8_t> sliding_nodes(const LabelVolume& volume, const TissueTable& tissues, const TetMesh& mesh,
                                        const std::vector<int>& bone, const SlidingSettings& settings) {
  std::vector<std::uint8_t> slides(mesh.V.rows(), 0);
  if (settings.near.empty()) return slides;
  const BoneFaces faces(mesh);
  std::vector<std::uint8_t> faced(mesh.V.rows(), 0);
  mark_faced(mesh, bone, faces.normal, {}, settings.joint_mm, faced);
  for (const auto& motion : settings.motions) mark_faced(mesh, bone, faces.normal, motion, settings.closing_mm, faced);
  const Eigen::MatrixX3i boundary = boundary_of(mesh);
  for (const int v : boundary.reshaped()) faced[v] = 1;
  const TissueOnBone tissue(volume, tissues, settings.tet_mm);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    if (bone[v] < 0 || faced[v] || faces.mm2[v] == 0) continue;
    const glm::dvec3 place = vec_of(mesh.V.row(v));
    const bool is_near = std::any_of(settings.near.begin(), settings.near.end(),
                                     [&](const auto& each) { return glm::distance(each.joint, place) < each.mm; });
    slides[v] = is_near && tissue.is_loose_at(place);
  }
  return slides;
}

void let_slide(FemModel& model, const std::vector<std::uint8_t>& slides, double tet_mm) {
  TetMesh& mesh = model.mesh;
  const auto nodes = int(mesh.V.rows());
  const BoneFaces faces(mesh);
  std::vector<int> copy(nodes, -1), sliding;
  for (int v = 0; v < nodes; ++v)
    if (slides[v]) copy[v] = nodes + int(sliding.size()), sliding.push_back(v);
  if (sliding.empty()) return;

  std::vector<std::uint16_t> region(nodes, TetMesh::kSoft);  // bone region of the tets at each node; kSoft: none
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (int& v : mesh.T.row(t)) {
      if (mesh.region[t] != TetMesh::kSoft) region[v] = mesh.region[t];
      else if (copy[v] >= 0) v = copy[v];
    }
  mesh.V.conservativeResize(nodes + std::ssize(sliding), 3);
  mesh.copy_of.resize(mesh.V.rows());
  for (int v = 0; v < nodes; ++v) mesh.copy_of[v] = v;
  std::map<std::uint16_t, std::vector<int>> by_bone;
  for (const int v : sliding) {
    const int bone = TetMesh::bone_of(region[v]);
    mesh.V.row(copy[v]) = mesh.V.row(v);
    mesh.copy_of[copy[v]] = v;
    model.held_by.push_back(-1);
    model.influences.push_back({{bone, 1.0}});
    model.sliding.push_back({copy[v], bone, faces.mm2[v]});
    by_bone[region[v]].push_back(v);
  }
  for (const auto& [of, around] : by_bone) {
    const auto bone = std::size_t(TetMesh::bone_of(of));
    model.bone_surface.resize(std::max(model.bone_surface.size(), bone + 1));
    model.bone_surface[bone] =
        std::make_shared<const DistanceField>(mesh, of, around, kMargin * tet_mm, kSample * tet_mm, kSmooth * tet_mm);
  }
}

}  // namespace limber
