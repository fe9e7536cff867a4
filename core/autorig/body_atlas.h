// SPDX-License-Identifier: AGPL-3.0-or-later
// The bodies of known shape (atlases) to which automatic rigging compares a volume: the skin and the bones of the
// procedural phantoms as points on their surfaces, each with the rig bone with which it moves. The points are on the
// exact surfaces (the phantoms are signed distance functions), so they do not depend on any voxel size. The points are
// denser on hands and feet.
#pragma once

#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct AtlasPoint {
  glm::dvec3 place{0}, normal{0};  // position in mm, and unit outward normal
  int bone = 0;                    // index in the atlas's rig of the bone with which the point moves
};

struct BodyAtlas {
  Armature rig;
  std::vector<AtlasPoint> skin, bone;
};

enum class AtlasKind { Body, Arm, ArmWithShoulder, Leg, Hand };

// Makes the atlas of a whole body or of a single right limb. An arm alone ends at the shoulder, a hand at the wrist, a
// leg at the hip.
BodyAtlas make_atlas(AtlasKind kind);

// Returns the atlas mirrored at x = 0, with the same bone names.
BodyAtlas mirrored(const BodyAtlas& atlas);

}  // namespace limber
