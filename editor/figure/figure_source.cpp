// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/figure/figure_source.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/deform/preview_map.h"

namespace limber::editor {

namespace {

// Height in pixels and resolution in dots per inch for which the renderer's line widths are designed. Lines on the
// page are at least one dot wide at kFinestLines dots per inch (a quarter of a point), the thinnest that print well.
constexpr double kScreenHeight = 700, kScreenResolution = 96, kFinestLines = 288;
// A tissue is listed in the legend if it covers at least this fraction of the picture. A smaller area cannot be
// recognized.
constexpr double kSmallestShare = 1.0 / 20000;
constexpr double kLegendPixels = 1e6;  // tissues for the legend are counted in a picture of at most this many pixels
constexpr int kRows = 16;              // number of a slice's rows that one parallel work block looks up

// Returns the size of the smaller picture in which the legend's tissues are counted, for a picture of the given size.
glm::ivec2 legend_size(const glm::ivec2& size) {
  const double shrink = std::min(1.0, std::sqrt(kLegendPixels / (double(size.x) * size.y)));
  return glm::max(glm::ivec2(glm::dvec2(size) * shrink), glm::ivec2(1));
}

int least_pixels(const glm::ivec2& size) { return std::max(1, static_cast<int>(kSmallestShare * size.x * size.y)); }

std::vector<LegendEntry> legend_of(const std::vector<Label>& labels, const render::Scene& scene,
                                   const TissueTable& tissues) {
  std::vector<LegendEntry> legend;
  for (const Label label : labels)
    if (const Tissue* tissue = tissues.find(label))
      legend.push_back({tissue->name.empty() ? "label " + std::to_string(label) : tissue->name,
                        label < scene.looks->size() ? (*scene.looks)[label].colour : tissue->colour});
  return legend;
}

}  // namespace

render::Scene figure_scene(render::Scene scene) {
  scene.transparent_background = true;
  scene.grid = false;
  scene.outlined.reset();
  return scene;
}

float figure_line_scale(const FigureLayout& layout) {
  const double dots = layout.options.dots_per_inch;
  return static_cast<float>(
      std::clamp(layout.picture_pixels.y / kScreenHeight, dots / kFinestLines, dots / kScreenResolution));
}

double millimetres_per_pixel(const render::Camera& camera, const glm::ivec2& size) {
  return 2 * camera.distance * std::tan(camera.field_of_view / 2) / size.y;
}

FigureSource body_source(render::Renderer& renderer, const render::Scene& scene, const CameraAt& camera,
                         const std::shared_ptr<const TissueTable>& tissues) {
  FigureSource source;
  source.legend = [&renderer, scene, camera, tissues](const glm::ivec2& whole) {
    if (scene.weights || !scene.volume) return std::vector<LegendEntry>{};
    const glm::ivec2 size = legend_size(whole);
    render::View3D view(renderer);
    view.draw(scene, camera(size), size, 0, 1);
    return legend_of(view.shown_labels(least_pixels(size)), scene, *tissues);
  };
  source.millimetres_per_pixel = [camera](const glm::ivec2& size) { return millimetres_per_pixel(camera(size), size); };
  source.at_focus = camera({1, 1}).projection == render::Projection::Perspective;
  return source;
}

FigureSource slice_source(const render::Scene& scene, const SliceCameraAt& camera, render::SliceDisplay display,
                          const std::shared_ptr<const TissueTable>& tissues) {
  FigureSource source;
  // If a grey image is shown without tissue colours over it, tissues are visible only as outlines. Without outlines,
  // the legend is empty.
  const bool hidden =
      scene.grey && scene.grey->image && scene.grey->tissues == 0 && display != render::SliceDisplay::Outline;
  source.legend = [scene, camera, tissues, hidden](const glm::ivec2& whole) {
    if (scene.weights || !scene.volume || hidden) return std::vector<LegendEntry>{};
    const glm::ivec2 size = legend_size(whole);
    return legend_of(labels_of_slice(scene, camera(size), size, least_pixels(size)), scene, *tissues);
  };
  source.millimetres_per_pixel = [camera](const glm::ivec2& size) { return camera(size).millimetres_per_pixel; };
  return source;
}

std::vector<Label> labels_of_slice(const render::Scene& scene, const render::SliceCamera& camera,
                                   const glm::ivec2& size, int pixels) {
  const render::SliceFrame frame = render::frame_of(camera.axis);
  const AffineTransform to_voxel = voxel_from_world(scene.volume->grid);
  std::vector<Label> shown(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  parallel_for(size.y, kRows, [&](std::int64_t begin, std::int64_t end) {
    auto label = shown.begin() + begin * size.x;
    for (int y = static_cast<int>(begin); y < end; ++y)
      for (int x = 0; x < size.x; ++x, ++label) {
        const glm::dvec3 world =
            camera.centre + camera.millimetres_per_pixel *
                                ((x + 0.5 - size.x / 2.0) * frame.right + (y + 0.5 - size.y / 2.0) * frame.down);
        std::optional<glm::dvec3> voxel = to_voxel * world;
        if (scene.pose) voxel = scene.pose->rest_at(*voxel);
        if (voxel) *label = scene.volume->at_or_air(glm::ivec3(glm::floor(*voxel + 0.5)));
      }
  });
  std::vector<int> counts(65536);
  for (const Label label : shown) ++counts[label];
  std::vector<Label> labels;
  for (std::size_t label = 1; label < counts.size(); ++label)
    if (counts[label] >= pixels && label < scene.looks->size() && (*scene.looks)[label].visible)
      labels.push_back(static_cast<Label>(label));
  return labels;
}

}  // namespace limber::editor
