// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog that shows a file that may be a grey image (MR) or labels, and asks which it is. It shows three linked
// slices and a maximum intensity projection that can be turned. Level and width of the grey values can be set. The open
// project does not change.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/volume_io/grey_image.h"

namespace limber::editor {

struct Context;

struct ShownImage {
  std::shared_ptr<const GreyVolume> image;
  std::string name;    // the file's name
  std::string doubt;   // why the file is not clearly a label volume: "it has 300 values, and ..."
  std::string answer;  // label of the button that opens the file as labels
  std::function<void(Context&)> as_labels, as_image;
};
void show_grey_image(Context& context, ShownImage shown);

}  // namespace limber::editor
