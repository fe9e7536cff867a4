// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a label volume from the shown image by thresholds (core/prepare/ct_labels.h). A CT gives tissues by their
// density. An image whose values have no unit gives only the body and its skin.
#pragma once

namespace limber::editor {

struct Context;
struct Views;

// Opens the form with the thresholds. Its button starts a job that replaces the open volume as one edit.
void ask_for_labels(Context& context);
void ask_for_body(Context& context);

// Returns the id of the operator that makes labels from the shown image. The operator with thresholds in Hounsfield
// units is returned only if the image's values look like Hounsfield units.
const char* labels_operator(const Views& views);

}  // namespace limber::editor
