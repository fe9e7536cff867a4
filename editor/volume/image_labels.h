// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from the shown image by thresholds (core/prepare/ct_labels.h). A CT gives tissues by their
// density. An image whose values have no unit gives only the body and its skin.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Opens the form with the thresholds. Its button starts a job that replaces the open volume as one edit.
void ask_for_labels(Editor& editor);
void ask_for_body(Editor& editor);

// Returns the id of the operator that makes labels from the shown image. The operator with thresholds in Hounsfield
// units is returned only if the image's values look like Hounsfield units.
const char* labels_operator(const Editor& editor);

}  // namespace limber::editor
