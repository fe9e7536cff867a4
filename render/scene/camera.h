// SPDX-License-Identifier: AGPL-3.0-or-later
// Where the body is seen from: a turntable round a centre, as in Blender. World LPS, mm; z (superior) is up.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber::render {

enum class Projection { Perspective, Orthographic };

struct Camera {
  glm::dvec3 centre{0};                    // what is turned about
  double distance = 1000;                  // from the eye to the centre, mm
  glm::dquat world_from_view{1, 0, 0, 0};  // view: x right, y up, z towards the eye
  double field_of_view = 0.6911;           // vertical, radians (50 mm lens of a 36 mm sensor at 3:2)
  Projection projection = Projection::Perspective;

  bool operator==(const Camera&) const = default;
};

// The eye looks from that side of the body: Front shows the anterior side, with the patient's left on the right.
enum class StandardView { Front, Back, Left, Right, Top, Bottom };
Camera looking_from(StandardView side, const Camera& camera);

// `camera` moved so that the box fills the picture.
Camera framing(const Camera& camera, const glm::dvec3& low, const glm::dvec3& high, double aspect);

glm::dvec3 eye_of(const Camera& camera);
glm::dmat4 view_from_world(const Camera& camera);
// `aspect` is width / height; depth range covers a ball of `radius` about `middle`.
glm::dmat4 clip_from_view(const Camera& camera, double aspect, const glm::dvec3& middle, double radius);

// A point of the picture (pixels, y down, from the top left corner) as a ray in the world.
struct Ray {
  glm::dvec3 origin, direction;  // unit direction
};
Ray ray_through(const Camera& camera, const glm::dvec2& pixel, const glm::ivec2& size);
// Where a world point appears (pixels, y down); nothing when it lies behind the eye.
bool project(const Camera& camera, const glm::dvec3& point, const glm::ivec2& size, glm::dvec2& pixel);

// Mouse and key moves, in pixels of a picture of that size.
Camera orbited(const Camera& camera,
               const glm::dvec2& pixels);  // turntable: x about the world's z, y about the view's x
Camera panned(const Camera& camera, const glm::dvec2& pixels, const glm::ivec2& size);
Camera zoomed(const Camera& camera, double factor);  // distance times factor, within [1e-2, 1e6] mm
// The same about a pixel: what is seen there, at the depth of the centre, stays there.
Camera zoomed(const Camera& camera, double factor, const glm::dvec2& pixel, const glm::ivec2& size);
// The eye stays, and looks elsewhere: pixels as in orbited(). The centre goes with it.
Camera looked_round(const Camera& camera, const glm::dvec2& pixels);

}  // namespace limber::render
