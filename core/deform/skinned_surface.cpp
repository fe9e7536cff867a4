// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/skinned_surface.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/mesh/surface.h"
#include "core/mesh/surface_points.h"
#include "core/skin/weight_at.h"

namespace limber {

namespace {

// The surface is where the blurred share of tissue has this value, at which the renderer's rays stop.
constexpr float kSurface = 98 / 255.0f;
constexpr int kLayersInside = 6;  // visible tissue is searched up to this many half-voxel steps inwards
constexpr std::int64_t kGrain = 4096;
// If there are more voxels, larger cells are used; each cell needs 8 bytes temporarily.
constexpr double kMostCells = 16e6;

// Blurs the cells' shares of tissue as the renderer does. Then adds a constant, so that the surface is at a share of
// 0.5.
//   voxels  number of voxels along an edge of a cell
void soften(Occupancy& body, float voxels) {
  const glm::ivec3 size = body.grid.size;
  const std::int64_t steps[] = {1, size.x, std::int64_t{size.x} * size.y};
  std::vector<float> from;
  for (int pass = 0; pass < 2; ++pass)
    for (int axis = 0; axis < 3; ++axis) {
      from = body.share;
      parallel_for(size.z, 4, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin * steps[2]; i < end * steps[2]; ++i) {
          const std::int64_t place = i / steps[axis] % size[axis];
          const float before = place > 0 ? from[i - steps[axis]] : 0,
                      after = place + 1 < size[axis] ? from[i + steps[axis]] : 0;
          body.share[i] = 0.25f * before + 0.5f * from[i] + 0.25f * after;
        }
      });
    }
  for (float& share : body.share) share += (0.5f - kSurface) / voxels;
}

// Returns the first visible label on a line that starts slightly outside the surface and runs inwards. Returns
// `otherwise` if the line meets no visible label.
Label label_inside(const LabelVolume& volume, const LabelSet& shown, const AffineTransform& to_voxel,
                   const glm::dvec3& place, const glm::dvec3& normal, Label otherwise) {
  const glm::dvec3 inward = -(to_voxel.linear * normal),
                   step = 0.5 * inward / std::max({std::abs(inward.x), std::abs(inward.y), std::abs(inward.z), 1e-9});
  glm::dvec3 at = to_voxel * place - step;
  for (int i = 0; i < kLayersInside; ++i, at += step)
    if (const Label label = volume.at_or_air(glm::ivec3(glm::floor(at + 0.5))); shown[label]) return label;
  return otherwise;
}

}  // namespace

SkinnedSurface skinned_surface(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                               const LabelSet& labels, std::int64_t vertices) {
  LabelSet shown = labels;
  shown[0] = 0;  // label 0 is air, which is never visible
  // The finest cells are single voxels unless these are too many. Coarser cells are made from the finest ones.
  const auto finest_of = [](const Grid& grid) { return std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z}); };
  const double edge = std::ceil(std::cbrt(double(volume.grid.voxel_count()) / kMostCells));
  Occupancy fine = occupancy_of(volume, shown, edge * finest_of(volume.grid));
  soften(fine, static_cast<float>(std::cbrt(double(volume.grid.voxel_count()) / double(fine.grid.voxel_count()))));
  TriangleMesh mesh = surface_of(fine);
  for (double coarser = 1; std::ssize(mesh.V) > vertices;) {
    // The number of vertices is proportional to the surface's area divided by the area of a cell face.
    coarser = std::max(coarser + 1, std::floor(coarser * std::sqrt(double(std::ssize(mesh.V)) / double(vertices))));
    mesh = surface_of(coarsened(fine, coarser * finest_of(fine.grid)));
  }

  SkinnedSurface surface;
  surface.V = mesh.V;
  for (const glm::ivec3& face : mesh.F) surface.F.emplace_back(face);
  surface.offsets.push_back(0);
  if (mesh.V.empty()) return surface;
  const std::vector<glm::dvec3> normals = vertex_normals(mesh);
  const std::vector<SkinAt> skin = skin_at(volume, tissue, weights, mesh.V);
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  surface.label.resize(mesh.V.size());
  for (std::size_t i = 0; i < mesh.V.size(); ++i) {
    surface.label[i] = label_inside(volume, shown, to_voxel, mesh.V[i], normals[i], skin[i].label);
    for (int k = 0; k < 4; ++k)
      if (skin[i].influence.weight[k])
        surface.influences.push_back({skin[i].influence.bone[k], skin[i].influence.weight[k] / double(kFullWeight)});
    surface.offsets.push_back(std::ssize(surface.influences));
  }
  return surface;
}

PosedSurface posed_surface(const std::shared_ptr<const SkinnedSurface>& at_rest,
                           const std::vector<RigidTransform>& posed_from_rest, Blend blend) {
  const SkinnedSurface& rest = *at_rest;
  const std::vector<SkinTransform> bones = skin_transforms(posed_from_rest);
  std::vector<glm::dvec3> posed(rest.V.size());
  parallel_for(std::ssize(rest.V), kGrain, [&](std::int64_t begin, std::int64_t end) {
    const std::size_t count = static_cast<std::size_t>(end - begin);
    blend_points(blend, bones, rest.influences, std::span(rest.offsets).subspan(begin, count + 1),
                 std::span(rest.V).subspan(begin, count), std::span(posed).subspan(begin, count));
  });

  PosedSurface surface{at_rest, {}, std::vector<glm::vec3>(posed.size(), glm::vec3(0))};
  surface.V.assign(posed.begin(), posed.end());
  for (const glm::u32vec3& f : rest.F) {
    const glm::vec3 area = glm::cross(surface.V[f.y] - surface.V[f.x], surface.V[f.z] - surface.V[f.x]);
    for (int corner = 0; corner < 3; ++corner) surface.N[f[corner]] += area;
  }
  for (glm::vec3& normal : surface.N) {
    const float length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::vec3(0, 0, 1);
  }
  return surface;
}

}  // namespace limber
