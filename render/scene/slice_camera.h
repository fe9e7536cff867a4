// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace limber::render {

enum class SliceAxis { Sagittal, Coronal, Axial };  // the slice's normal is x, y or z of the world
enum class SliceDisplay { Labels, Outline };

// The position of a slice, and the region of the slice that the picture shows.
struct SliceCamera {
  SliceAxis axis = SliceAxis::Axial;
  glm::dvec3 centre{0};  // world point at the picture's centre, mm; the slice passes through it
  double millimetres_per_pixel = 1;
};

// World axes of a slice picture, by the radiological convention: axial slices are seen from the feet, with the
// patient's right on the left of the picture.
struct SliceFrame {
  glm::dvec3 right, down, normal;
};
SliceFrame frame_of(SliceAxis axis);

}  // namespace limber::render
