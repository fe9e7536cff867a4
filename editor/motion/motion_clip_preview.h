// SPDX-License-Identifier: AGPL-3.0-or-later
// A take as a stick figure, seen a little from the side: it plays while the pointer is on it, and a drag across it goes
// through its frames. It stays in the middle wherever it travels; a line tells the ground.
#pragma once

#include <memory>
#include <vector>

#include "core/motion/bvh.h"
#include "editor/context/editor.h"

namespace limber::editor {

class MotionPicture {
 public:
  explicit MotionPicture(std::shared_ptr<const Motion> motion);

  //   rate  frames in a second while it plays
  void draw(Editor& editor, const Rect& rect, bool z_up, double rate);
  int frame() const { return frame_; }

 private:
  // Of the frame, in LPS, the first joint above the middle of the ground.
  std::vector<glm::dvec3> places(int frame, bool z_up) const;
  void measure(bool z_up);
  void move_on(Editor& editor, const Rect& rect, double rate);

  std::shared_ptr<const Motion> motion_;
  std::vector<std::pair<int, int>> sticks_;  // places that are joined
  int frame_ = 0;
  double began_ = -1, began_at_ = 0;  // s and frame from which it plays; -1: it does not
  bool stays_ = false;                // where it was dragged to, until the pointer leaves
  int measured_ = -1;                 // for which axis
  double low_ = 0, high_ = 1, wide_ = 1;
};

}  // namespace limber::editor
