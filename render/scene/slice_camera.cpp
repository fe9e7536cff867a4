// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/slice_camera.h"

namespace limber::render {

SliceFrame frame_of(SliceAxis axis) {
  switch (axis) {
    case SliceAxis::Sagittal: return {{0, 1, 0}, {0, 0, -1}, {1, 0, 0}};
    case SliceAxis::Coronal: return {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    case SliceAxis::Axial: break;
  }
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

}  // namespace limber::render
