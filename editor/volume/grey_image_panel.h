// SPDX-License-Identifier: AGPL-3.0-or-later
// A grey image (CT, MR) that was opened or imported: three linked slices and a projection that turns, in a window of
// grey values. It is only looked at; the open project stays as it is.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/volume_io/grey_image.h"
#include "editor/context/editor.h"

namespace limber::editor {

struct ShownImage {
  std::shared_ptr<const GreyVolume> image;
  std::string name;    // of its file
  std::string doubt;   // why it is no label volume, "it has 300 values, and ..."
  std::string answer;  // the button that takes it as labels all the same; "" where its values cannot be labels
  std::function<void(Editor&)> as_labels;
};
void show_grey_image(Editor& editor, ShownImage shown);

}  // namespace limber::editor
