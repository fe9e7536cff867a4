// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrects the hands of a body while the body is fitted. Five fingers are much alike, so a hand can be fitted with each
// finger in place of its neighbour, or with its palm to the wrong side.
#pragma once

#include "core/autorig/fit_target.h"

namespace limber {

// Fits every hand again after rotations in its plane and about its length, and then bent like the other hand. Keeps the
// best fit.
//   bone  may be null
void try_hands(Mannequin& mannequin, const FitTarget& target, const FitSurface* bone);

// Returns the body with open hands that have the scale of its arms and legs, rotated by `twist` and then fitted to the
// skin. In that fit the forearms may also rotate, and sizes may change.
//   twist  rotation of the right hand about its length, radians; the left hand gets the opposite rotation
Mannequin with_turned_hands(const Mannequin& mannequin, double twist, const FitTarget& target);

// Returns the share of the fingers' skin points that lie near the volume's skin, [0, 1]; 1 for a body without hands.
// Skin is used because finger bones are thinner than many voxels.
double hands_near(const Mannequin& mannequin, const FitTarget& target);

}  // namespace limber
