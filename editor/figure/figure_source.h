// SPDX-License-Identifier: AGPL-3.0-or-later
// What a figure shows of a scene: a 3D view or a slice, with its scale and the tissues in it.
#pragma once

#include "core/tissue/tissue_table.h"
#include "editor/figure/figure_layout.h"
#include "render/view.h"

namespace limber::editor {

// Returns the scene as figures show it: without a background, a grid and marks of what is selected.
render::Scene figure_scene(render::Scene scene);
// Returns the factor on the widths of lines and joints (Scene::line_scale) for the picture of a figure. They are as
// wide relative to the picture as on a screen, but on the page neither invisibly thin nor wider than on a screen.
float figure_line_scale(const FigureLayout& layout);

using CameraAt = std::function<render::Camera(const glm::ivec2& size)>;
using SliceCameraAt = std::function<render::SliceCamera(const glm::ivec2& size)>;

// These functions return the source of a figure. The legend lists the tissues by label, and is empty where the colours
// are those of weights or of a grey image. It is that of a smaller picture where the figure's own has more than a
// million pixels. The renderer must outlive the source.
//   camera  for a picture of a given size in pixels
FigureSource body_source(render::Renderer& renderer, const render::Scene& scene, const CameraAt& camera,
                         const std::shared_ptr<const TissueTable>& tissues);
FigureSource slice_source(const render::Scene& scene, const SliceCameraAt& camera, render::SliceDisplay display,
                          const std::shared_ptr<const TissueTable>& tissues);

// Returns the labels that a slice shows on at least `pixels` of its pixels, in ascending order.
std::vector<Label> labels_of_slice(const render::Scene& scene, const render::SliceCamera& camera,
                                   const glm::ivec2& size, int pixels);

// Returns the size in the body of a pixel at the centre of the camera's orbit, mm.
double millimetres_per_pixel(const render::Camera& camera, const glm::ivec2& size);

}  // namespace limber::editor
