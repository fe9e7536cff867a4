// SPDX-License-Identifier: AGPL-3.0-or-later
// The content of a figure: the picture of a 3D view or a slice, with its scale and the tissues that it shows.
#pragma once

#include "core/tissue/tissue_table.h"
#include "editor/figure/figure_layout.h"
#include "render/view.h"

namespace limber::editor {

// Returns the scene without the elements that figures omit: background, grid and marks of selected objects.
render::Scene figure_scene(render::Scene scene);
// Returns the factor for the widths of lines and joints (Scene::line_scale) in the picture of a figure. With this
// factor, the widths have the same ratio to the picture's height as on a screen. On the page, however, lines are at
// most as wide as on a screen, and at least wide enough to print.
float figure_line_scale(const FigureLayout& layout);

using CameraAt = std::function<render::Camera(const glm::ivec2& size)>;
using SliceCameraAt = std::function<render::SliceCamera(const glm::ivec2& size)>;

// Return the source of a figure that shows the 3D view (body_source) or a slice (slice_source). The legend lists the
// tissues in the order of their labels. It is empty if the colours show weights or a grey image. For a picture of more
// than a million pixels, tissues are counted in a smaller copy. The renderer must outlive the source.
//   camera  returns the camera for a picture of a given size in pixels
FigureSource body_source(render::Renderer& renderer, const render::Scene& scene, const CameraAt& camera,
                         const std::shared_ptr<const TissueTable>& tissues);
FigureSource slice_source(const render::Scene& scene, const SliceCameraAt& camera, render::SliceDisplay display,
                          const std::shared_ptr<const TissueTable>& tissues);

// Returns the labels that cover at least `pixels` pixels of a slice, in ascending order.
std::vector<Label> labels_of_slice(const render::Scene& scene, const render::SliceCamera& camera,
                                   const glm::ivec2& size, int pixels);

// Returns the size of a pixel at the centre of the camera's orbit, mm in the body.
double millimetres_per_pixel(const render::Camera& camera, const glm::ivec2& size);

}  // namespace limber::editor
