// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigs that the editor lays into the volume: found by itself, as a job and one edit, or a template scaled to the
// tissue.
#pragma once

#include <string>

#include "core/autorig/auto_rig.h"
#include "editor/context/editor.h"

namespace limber::editor {

// What stand for laying a skeleton by itself and for a joint's axis.
inline constexpr char kAutoFitIcon[] = "\uf0d0";
inline constexpr char kFitAxisIcon[] = "\uf140";

// Both ask first. Both need a volume.
void ask_auto_fit(Editor& editor);
void ask_template(Editor& editor);

// Lays a template ("arm"), the one that suits best (""), or the rig that is there already ("rig").
void start_auto_fit(Editor& editor, const std::string& which);

// After a rig came in of whose bones only that share of the length is in tissue: asks whether it shall be fitted.
void offer_fit(Editor& editor, const std::string& file, double inside);

// Tells how a fit came out; the console lists every joint with how it was found, the least sure last.
void show_fit(Editor& editor, const AutoFit& fitted);

}  // namespace limber::editor
