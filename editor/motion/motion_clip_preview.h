// SPDX-License-Identifier: AGPL-3.0-or-later
// A preview that draws a motion as a stick figure, seen from the front, a little from the side and from above. The
// motion plays while the pointer is over the preview; dragging scrubs through the frames. The figure stays in the
// middle even if the motion walks away. A line marks the ground.
#pragma once

#include <memory>
#include <vector>

#include "core/motion/bvh.h"

namespace limber::editor {

struct Context;
struct Rect;

class MotionPicture {
 public:
  explicit MotionPicture(std::shared_ptr<const Motion> motion);

  // Draws the preview in `rect`.
  //   z_up  whether the z axis of the motion's file points up; false: its y axis does
  //   rate  frames per second at which the motion plays
  void draw(Context& context, const Rect& rect, bool z_up, double rate);
  int frame() const { return frame_; }

 private:
  // Returns the positions of all joints, then of all end sites, at a frame: z points up, in the file's unit, shifted
  // horizontally so that the first joint has x = y = 0.
  std::vector<glm::dvec3> places(int frame, bool z_up) const;
  void measure(bool z_up);
  void move_on(Context& context, const Rect& rect, double rate);

  std::shared_ptr<const Motion> motion_;
  std::vector<std::pair<int, int>> sticks_;  // the figure's lines, each as two indices into places()
  int frame_ = 0;
  double began_ = -1, began_at_ = 0;  // time (s) and frame at which playing began; began_ -1: not playing
  bool stays_ = false;                // true after scrubbing: the motion does not play until the pointer leaves
  int measured_ = -1;                 // value of z_up with which low_, high_ and wide_ were computed; -1: not computed
  double low_ = 0, high_ = 1, wide_ = 1;
};

}  // namespace limber::editor
