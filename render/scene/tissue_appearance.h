// SPDX-License-Identifier: AGPL-3.0-or-later
// How the tissues of a table are drawn, with what the user changed of it.
#pragma once

#include "core/project/document.h"
#include "core/tissue/tissue_table.h"
#include "render/scene/scene.h"

namespace limber::render {

// What stays solid in X-ray: bone and cartilage, vessels and nerves, organs; the rest is flesh around them.
bool stays_solid(TissueKind kind);

LabelLooks looks_of(const TissueTable& tissues, const Visibility& visibility = {});

}  // namespace limber::render
