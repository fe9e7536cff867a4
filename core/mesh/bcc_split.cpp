// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/bcc_split.h"

#include <unordered_map>

#include "core/mesh/sample_lattice.h"

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;

class Splitter {
 public:
  explicit Splitter(const SampleLattice& lattice) : lattice_(lattice) {}

  TetMesh split() {
    glm::ivec3 p;
    for (p.z = 1; p.z + 1 < lattice_.size.z; ++p.z)
      for (p.y = 1; p.y + 1 < lattice_.size.y; ++p.y)
        for (p.x = 1; p.x + 1 < lattice_.size.x; ++p.x)
          if (lattice_.at(p) != kAir)
            for (int axis = 0; axis < 3; ++axis)
              for (const int side : {-1, 1}) split_face(p, axis, side);
    TetMesh mesh;
    mesh.V.resize(places_.size(), 3);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const glm::dvec3 world = lattice_.world_from_lattice * (places_[i] * lattice_.step);
      mesh.V.row(i) << world.x, world.y, world.z;
    }
    mesh.T.resize(tets_.size(), 4);
    const bool mirrored = glm::determinant(lattice_.world_from_lattice.linear) < 0;
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      if (mirrored) std::swap(tets_[i][2], tets_[i][3]);
      mesh.T.row(i) = tets_[i];
    }
    mesh.region = std::move(region_);
    return mesh;
  }

 private:
  void split_face(const glm::ivec3& p, int axis, int side) {
    glm::ivec3 across = p;
    across[axis] += side;
    const std::uint16_t region = lattice_.at(p);
    const bool shared = lattice_.at(across) == region;
    if (shared && side < 0) return;  // done from the other cell
    const int centre = node(2 * p), end = shared ? node(2 * across) : node(p + across);
    // Around the face, counter-clockwise seen along +axis.
    constexpr int kCorners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    int corner[4];
    for (int i = 0; i < 4; ++i) {
      glm::ivec3 twice = p + across;
      twice[(axis + 1) % 3] += kCorners[i][0];
      twice[(axis + 2) % 3] += kCorners[i][1];
      corner[i] = node(twice);
    }
    for (int i = 0; i < 4; ++i) {
      const int a = corner[i], b = corner[(i + 1) % 4];
      if (side > 0) tets_.push_back({centre, end, a, b});
      else tets_.push_back({centre, end, b, a});
      region_.push_back(region);
    }
  }

  // The node at half of a place given in half steps.
  int node(const glm::ivec3& twice) {
    const glm::ivec3 size = 2 * lattice_.size;
    const std::int64_t key = twice.x + std::int64_t{size.x} * (twice.y + std::int64_t{size.y} * twice.z);
    const auto [at, is_new] = nodes_.emplace(key, static_cast<int>(places_.size()));
    if (is_new) places_.push_back(glm::dvec3(twice) * 0.5);
    return at->second;
  }

  const SampleLattice& lattice_;
  std::unordered_map<std::int64_t, int> nodes_;
  std::vector<glm::dvec3> places_;  // steps
  std::vector<Eigen::RowVector4i> tets_;
  std::vector<std::uint16_t> region_;
};

}  // namespace

TetMesh bcc_split(const VoxelRegions& voxels, double spacing_mm) {
  if (voxels.tissue.size() == 0) return {};
  return Splitter(sample_regions(voxels, {.spacing_mm = spacing_mm}, SolidWhen::any)).split();
}

}  // namespace limber
