// SPDX-License-Identifier: AGPL-3.0-or-later
// Shared by tests of pictures: a context with a renderer, bodies built in code, and rays traced on the CPU.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include <doctest/doctest.h>

#include "render/gl/egl_context.h"
#include "render/scene/tissue_appearance.h"
#include "render/view.h"

namespace limber::test {

struct Studio {
  explicit Studio(int largest_texture = 0) : renderer(largest_texture) {}
  render::HeadlessContext context;
  render::Renderer renderer;
};

inline Grid grid_of(const glm::ivec3& size, const glm::dvec3& spacing = glm::dvec3(1)) {
  return {.size = size, .spacing = spacing};
}

// Returns a volume in which `at` gives the label of each voxel for the voxel's centre in the world.
inline std::shared_ptr<const LabelVolume> painted(const Grid& grid, const std::function<Label(const glm::dvec3&)>& at) {
  auto volume = std::make_shared<LabelVolume>();
  volume->grid = grid;
  volume->voxels.resize(static_cast<size_t>(grid.voxel_count()));
  const AffineTransform to_world = world_from_voxel(grid);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) volume->at({x, y, z}) = at(to_world * glm::dvec3(x, y, z));
  return volume;
}

// Returns looks in which labels 1 to 3 are red, green and blue, and label 3 stays solid in X-ray.
inline std::shared_ptr<render::LabelLooks> plain_looks() {
  auto looks = std::make_shared<render::LabelLooks>(4);
  (*looks)[0].visible = false;
  (*looks)[1].colour = {0.9f, 0.1f, 0.1f};
  (*looks)[2].colour = {0.1f, 0.9f, 0.1f};
  (*looks)[3].colour = {0.1f, 0.1f, 0.9f};
  (*looks)[3].bone = true;
  return looks;
}

inline render::Scene scene_of(std::shared_ptr<const LabelVolume> volume,
                              std::shared_ptr<const render::LabelLooks> looks = plain_looks()) {
  render::Scene scene;
  scene.volume = std::move(volume);
  scene.looks = std::move(looks);
  scene.grid = false;
  scene.transparent_background = true;
  return scene;
}

inline render::Camera camera_of(const Grid& grid, render::Projection projection = render::Projection::Perspective,
                                render::StandardView side = render::StandardView::Front) {
  const AffineTransform to_world = world_from_voxel(grid);
  glm::dvec3 low(1e300), high(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p =
        to_world * glm::dvec3(corner & 1 ? grid.size.x : 0, corner & 2 ? grid.size.y : 0, corner & 4 ? grid.size.z : 0);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  render::Camera camera;
  camera.projection = projection;
  return framing(looking_from(side, camera), low, high, 1);
}

inline render::Image draw(render::View3D& view, const render::Scene& scene, const render::Camera& camera,
                          const glm::ivec2& size) {
  view.draw(scene, camera, size, 0, 1);
  return view.read();
}
inline render::Image picture_of(render::Renderer& renderer, const render::Scene& scene, const render::Camera& camera,
                                const glm::ivec2& size) {
  render::View3D view(renderer);
  return draw(view, scene, camera, size);
}

inline glm::ivec4 pixel_of(const render::Image& image, const glm::ivec2& at) {
  const std::uint8_t* p = image.rgba.data() + (size_t(at.y) * image.size.x + at.x) * 4;
  return {p[0], p[1], p[2], p[3]};
}
inline int covered(const render::Image& image) {
  int count = 0;
  for (size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] > 127;
  return count;
}

// The difference of two pictures of one size: the mean absolute difference over all channels (0 to 255), and the
// fraction of channels that differ by more than 8.
struct Difference {
  double mean = 0, share = 0;
};
inline Difference difference(const render::Image& a, const render::Image& b) {
  REQUIRE(a.rgba.size() == b.rgba.size());
  Difference result;
  for (size_t i = 0; i < a.rgba.size(); ++i) {
    const int d = std::abs(int(a.rgba[i]) - int(b.rgba[i]));
    result.mean += d;
    result.share += d > 8;
  }
  result.mean /= double(a.rgba.size());
  result.share /= double(a.rgba.size());
  return result;
}

// The first voxel along a ray whose label `seen` accepts. The ray advances by a fiftieth of a voxel per step.
struct CpuHit {
  glm::ivec3 voxel;
  glm::dvec3 point;
};
inline std::optional<CpuHit> follow(const LabelVolume& volume, const render::Ray& ray,
                                    const std::function<bool(Label)>& seen) {
  const AffineTransform to_voxel = voxel_from_world(volume.grid), to_world = world_from_voxel(volume.grid);
  const glm::dvec3 d = to_voxel.linear * ray.direction, unit = d / glm::length(d);
  const glm::dvec3 low(-0.5), high = glm::dvec3(volume.grid.size) - 0.5, origin = to_voxel * ray.origin;
  double start = -1e9, end = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(unit[axis]) < 1e-12) {
      if (origin[axis] < low[axis] || origin[axis] > high[axis]) return std::nullopt;
      continue;
    }
    const double a = (low[axis] - origin[axis]) / unit[axis], b = (high[axis] - origin[axis]) / unit[axis];
    start = std::max(start, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  for (double t = start; t < end; t += 0.02) {
    const glm::dvec3 p = origin + t * unit;
    const glm::ivec3 voxel(glm::floor(p + 0.5));
    const Label label = volume.at_or_air(voxel);
    if (label != 0 && seen(label)) return CpuHit{voxel, to_world * p};
  }
  return std::nullopt;
}

}  // namespace limber::test
