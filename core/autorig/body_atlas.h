// SPDX-License-Identifier: AGPL-3.0-or-later
// What automatic rigging knows of bodies: the skin and the bones of the procedural samples as points on their surfaces,
// each with the rig bone that carries it. Points lie on the exact surfaces (the samples are signed distances), so they
// do not depend on any voxel size, and they are closer together on hands and feet.
#pragma once

#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct AtlasPoint {
  glm::dvec3 place{0}, normal{0};  // mm; the normal points out
  int bone = 0;                    // of the atlas's rig
};

struct BodyAtlas {
  Armature rig;
  std::vector<AtlasPoint> skin, bone;
};

enum class AtlasKind { Body, Arm, ArmWithShoulder, Leg, Hand };

// The limbs are right ones; an arm alone ends at its shoulder, a hand at its wrist, a leg at its hip.
BodyAtlas make_atlas(AtlasKind kind);

// Its mirror image across x = 0, with the same bone names.
BodyAtlas mirrored(const BodyAtlas& atlas);

}  // namespace limber
