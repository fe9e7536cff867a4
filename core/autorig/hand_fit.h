// SPDX-License-Identifier: AGPL-3.0-or-later
// Hands of a body that is being fitted: five fingers are much alike, so that a hand can come to lie one finger beside
// itself, or with its palm out.
#pragma once

#include "core/autorig/fit_target.h"

namespace limber {

// Every hand tried turned in its plane and about the forearm, then bent like the other one; what fits best is kept.
//   bone  may be null
void try_hands(Mannequin& mannequin, const FitTarget& target, const FitSurface* bone);

// Open hands of the size that the limbs have, turned about their forearms and drawn onto the skin with the forearm's
// own turn and all sizes free.
//   twist  radians, of the right hand; the left one's is the other way
Mannequin with_turned_hands(const Mannequin& mannequin, double twist, const FitTarget& target);

// How much of the fingers' skin lies where it should, 0 .. 1; 1 for a body without hands. Finger bones are thinner than
// many voxels are.
double hands_near(const Mannequin& mannequin, const FitTarget& target);

}  // namespace limber
