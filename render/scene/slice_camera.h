// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace limber::render {

enum class SliceAxis { Sagittal, Coronal, Axial };  // normal x, y, z of the world, by the grid axis nearest to it
enum class SliceDisplay { Labels, Outline };

// Where a slice is cut and what part of it is seen.
struct SliceCamera {
  SliceAxis axis = SliceAxis::Axial;
  glm::dvec3 centre{0};  // world point in the picture's middle; the slice goes through it
  double millimetres_per_pixel = 1;
};

// World axes of a slice picture: radiological convention (axial seen from the feet, the patient's right on the left).
struct SliceFrame {
  glm::dvec3 right, down, normal;
};
SliceFrame frame_of(SliceAxis axis);

}  // namespace limber::render
