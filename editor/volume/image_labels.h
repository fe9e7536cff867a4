// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from the shown image by thresholds (core/prepare/ct_labels.h): of a CT tissues by their density,
// of an image whose values have no unit the body and its skin.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Opens the form with the thresholds. Its answer starts a job that replaces the open volume by one edit.
void ask_for_labels(Editor& editor);
void ask_for_body(Editor& editor);

// Returns the id of the operator that makes labels of the shown image: thresholds in Hounsfield units only for an image
// whose values look like them.
const char* labels_operator(const Editor& editor);

}  // namespace limber::editor
