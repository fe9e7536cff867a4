// SPDX-License-Identifier: AGPL-3.0-or-later
// The camera of a 3D view, which orbits about a centre as on a turntable (as in Blender). World LPS, mm; z (superior)
// is up.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber::render {

enum class Projection { Perspective, Orthographic };

struct Camera {
  glm::dvec3 centre{0};                    // the point about which the camera orbits
  double distance = 1000;                  // distance from the eye to the centre, mm
  glm::dquat world_from_view{1, 0, 0, 0};  // orientation of the camera; view axes: x right, y up, z towards the eye
  double field_of_view = 0.6911;           // vertical angle of view, radians (50 mm lens, picture 36 mm high)
  Projection projection = Projection::Perspective;

  bool operator==(const Camera&) const = default;
};

// A view from one side of the body. Front shows the anterior side, with the patient's left on the right of the picture.
enum class StandardView { Front, Back, Left, Right, Top, Bottom };
Camera looking_from(StandardView side, const Camera& camera);

// Returns `camera` moved so that the box from `low` to `high` (world, mm) fills the picture.
//   aspect  width / height of the picture
Camera framing(const Camera& camera, const glm::dvec3& low, const glm::dvec3& high, double aspect);

glm::dvec3 eye_of(const Camera& camera);
glm::dmat4 view_from_world(const Camera& camera);
// Returns the projection matrix.
//   aspect          width / height of the picture
//   middle, radius  sphere that the depth range covers
glm::dmat4 clip_from_view(const Camera& camera, double aspect, const glm::dvec3& middle, double radius);

// The ray in the world through a point of the picture (pixels, y down, from the top left corner).
struct Ray {
  glm::dvec3 origin, direction;  // start of the ray, world, mm; direction, unit vector
};
Ray ray_through(const Camera& camera, const glm::dvec2& pixel, const glm::ivec2& size);
// Computes the pixel at which a world point appears (y down); returns false when the point lies behind the eye.
bool project(const Camera& camera, const glm::dvec3& point, const glm::ivec2& size, glm::dvec2& pixel);

// These functions return the camera after a motion of the mouse or a key, in pixels of a picture of the given size.
// orbited() turns the camera about its centre: a horizontal motion turns it about the world's z axis, a vertical motion
// about the view's x axis.
Camera orbited(const Camera& camera, const glm::dvec2& pixels);
Camera panned(const Camera& camera, const glm::dvec2& pixels, const glm::ivec2& size);
// Returns the camera with its distance to the centre multiplied by `factor`, and clamped to [1e-2, 1e6] mm.
Camera zoomed(const Camera& camera, double factor);
// Zooms about a pixel: the point that this pixel shows at the depth of the camera's centre stays at the pixel.
Camera zoomed(const Camera& camera, double factor, const glm::dvec2& pixel, const glm::ivec2& size);
// Turns the view about the eye, by the same angles as orbited(). The eye does not move, and the centre moves around
// it.
Camera looked_round(const Camera& camera, const glm::dvec2& pixels);

}  // namespace limber::render
