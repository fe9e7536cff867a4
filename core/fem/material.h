// SPDX-License-Identifier: AGPL-3.0-or-later
// Hyperelastic tissue, per tet (kPa, mm):
//   W = mu/2 (|F|^2 - 3) - mu ln J + lambda/2 (J - 1)^2,   J = det F > 0
// [the compressible neo-Hookean energy of Bonet & Wood 2008, with the volume term in J]. Its zero is rest, a rotation
// costs nothing, and no finite energy turns a tet inside out.
// Linear tets lock when lambda is large. So lambda is split: what a Poisson ratio of 0.4 has stays with each tet, the
// rest acts on the mean of J over a patch of tets (patch_form.h).
#pragma once

#include <algorithm>

namespace limber {

struct TetMaterial {
  double shear_modulus = 1;    // mu, kPa, above 0
  double poisson_ratio = 0.4;  // [0, 0.5)
  double filled = 1;  // above 0: volume of tissue by volume of tet, whose mean counts among others (patch_form.h)
};

inline double lame_lambda(double shear_modulus, double poisson_ratio) {
  return 2 * shear_modulus * poisson_ratio / (1 - 2 * poisson_ratio);
}

// The two parts of lambda.
inline double tet_bulk(const TetMaterial& m) { return lame_lambda(m.shear_modulus, std::min(m.poisson_ratio, 0.4)); }
inline double patch_bulk(const TetMaterial& m) { return lame_lambda(m.shear_modulus, m.poisson_ratio) - tet_bulk(m); }

}  // namespace limber
