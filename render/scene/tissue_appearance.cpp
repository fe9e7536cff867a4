// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/tissue_appearance.h"

namespace limber::render {

bool stays_solid(TissueKind kind) {
  switch (kind) {
    case TissueKind::Cartilage:
    case TissueKind::Vessel:
    case TissueKind::Blood:
    case TissueKind::Nerve:
    case TissueKind::Brain:
    case TissueKind::Organ: return true;
    default: return is_bone(kind);
  }
}

LabelLooks looks_of(const TissueTable& tissues, const Visibility& visibility) {
  LabelLooks looks;
  if (tissues.tissues.empty()) return looks;
  looks.resize(size_t{tissues.tissues.back().label} + 1, LabelLook{.visible = false});
  for (const Tissue& tissue : tissues.tissues) {
    LabelLook& look = looks[tissue.label];
    look = {.colour = tissue.colour, .bone = stays_solid(tissue.kind)};
    if (const auto chosen = visibility.looks.find(tissue.label); chosen != visibility.looks.end()) {
      look.visible = chosen->second.visible;
      look.opacity = chosen->second.opacity;
    }
  }
  return looks;
}

}  // namespace limber::render
