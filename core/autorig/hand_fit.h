// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrects the hands of a body while it is fitted. Five fingers are much alike, so a hand can be fitted one finger off,
// or with its palm to the wrong side.
#pragma once

#include "core/autorig/fit_target.h"

namespace limber {

// Tries every hand rotated in its plane and about the forearm, and then bent like the other hand. Keeps the best fit.
//   bone  may be null
void try_hands(Mannequin& mannequin, const FitTarget& target, const FitSurface* bone);

// Returns the body with open hands in the scale of its limbs, rotated about the forearms and fitted to the skin; the
// forearms' rotations and all sizes are free in that fit.
//   twist  rotation of the right hand, radians; the left hand's is opposite
Mannequin with_turned_hands(const Mannequin& mannequin, double twist, const FitTarget& target);

// Returns the share of the fingers' skin points that lie near the volume's skin, [0, 1]; 1 for a body without hands. It
// uses skin since finger bones are thinner than many voxels.
double hands_near(const Mannequin& mannequin, const FitTarget& target);

}  // namespace limber
