// SPDX-License-Identifier: AGPL-3.0-or-later
// Places a rig in the volume in one of two ways: an automatic fit that runs as a job and commits one edit, or a
// template that is scaled to the tissue.
#pragma once

#include <string>

#include "core/autorig/auto_rig.h"

namespace limber::editor {

class Messages;
struct Context;

// Icons of the two operators that fit a skeleton and fit the axis of a joint.
inline constexpr char kAutoFitIcon[] = "\uf0d0";
inline constexpr char kFitAxisIcon[] = "\uf140";

// ask_auto_fit() opens a dialog that starts the automatic fit of a skeleton. ask_template() opens a dialog that places
// a template skeleton in the tissue. A volume must be open.
void ask_auto_fit(Context& context);
void ask_template(Context& context);

// Starts the job that fits a skeleton. `which` is a template's name such as "arm", "" for the template that suits the
// volume best, or "rig" for the document's own rig.
void start_auto_fit(Context& context, const std::string& which);

// Asks the user whether an imported rig should be fitted to the volume.
//   file    name of the imported file
//   inside  fraction of the total bone length that lies in tissue, [0, 1]
void offer_fit(Context& context, const std::string& file, double inside);

// Shows a message with the result of a fit. The console lists how each joint was found, the least certain joint last.
void show_fit(Messages& messages, const AutoFit& fitted);

}  // namespace limber::editor
