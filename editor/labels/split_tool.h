// SPDX-License-Identifier: AGPL-3.0-or-later
// A tool that splits the selected tissue by a cut. The user draws a straight line across the tissue with the left
// button; the cut is as wide as the line and goes along the line of sight through the whole body. The smaller part
// becomes a new tissue. Escape or the right button cancels the tool.
#pragma once

#include <memory>

namespace limber::editor {

class Modal;
struct Context;

std::unique_ptr<Modal> begin_split(Context& context);

}  // namespace limber::editor
