// SPDX-License-Identifier: AGPL-3.0-or-later
// Determines how each tissue of a table is drawn, from its kind, its colour and the user's changes.
#pragma once

#include "core/project/document.h"
#include "core/tissue/tissue_table.h"
#include "render/scene/scene.h"

namespace limber::render {

// Returns true if a tissue is drawn solid in X-ray: bone, cartilage, vessels, nerves and organs, but not the flesh
// around them.
bool stays_solid(TissueKind kind);

LabelLooks looks_of(const TissueTable& tissues, const Visibility& visibility = {});

}  // namespace limber::render
