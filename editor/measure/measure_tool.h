// SPDX-License-Identifier: AGPL-3.0-or-later
// The tool that measures: clicks on the body in any view set the points of a distance or an angle. One click measures
// the girth of a limb, or the thickness of the tissue under the pointer.
#pragma once

#include <memory>

#include "core/measure/measurement.h"
#include "editor/context/modal_tool.h"

namespace limber::editor {

struct Context;

std::unique_ptr<Modal> begin_measuring(const Context& context, MeasureKind kind);
bool is_measuring(const Context& context);  // true while clicks set the points of a measurement

}  // namespace limber::editor
