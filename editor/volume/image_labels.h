// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from the shown CT by thresholds (core/prepare/ct_labels.h).
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Opens the form with the thresholds. Its answer starts a job that replaces the open volume by one edit.
void ask_for_labels(Editor& editor);

}  // namespace limber::editor
